#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "kr3_executive/model_fingerprint.hpp"

namespace kr3::executive
{

struct ContentCacheStats
{
  std::uint64_t hits = 0;
  std::uint64_t misses = 0;
  std::uint64_t evictions = 0;
  std::size_t entries = 0;  ///< now
  std::size_t bytes = 0;    ///< of these, roughly

  /// Part of the questions that were answered from the cache, [0, 1]; 0 without questions.
  [[nodiscard]] double hitRate() const
  {
    const std::uint64_t all = hits + misses;
    return all == 0 ? 0.0 : static_cast<double>(hits) / static_cast<double>(all);
  }
};

/// Values by the content of everything that they depend on, of which 128 bits stand for the whole
/// (Fingerprint). The value of a key must be a function of that content alone: then it does not
/// matter who computed it, when two threads compute it at once, or whether it was forgotten.
///
/// Thread-safe. What is found lives as long as somebody holds it.
template <typename Value>
class ContentCache
{
public:
  /// @param max_bytes  of all values, as keep() is told; the least recently used go first
  explicit ContentCache(std::size_t max_bytes = kDefaultBytes)
    : max_bytes_of_part_(std::max<std::size_t>(max_bytes / kParts, 1))
  {
  }

  /// Null when there is none. Counts as a hit or a miss.
  [[nodiscard]] std::shared_ptr<const Value> find(const Fingerprint& key)
  {
    Part& part = partOf(key);
    const std::lock_guard<std::mutex> lock(part.mutex);
    const auto found = part.by_key.find(key);
    if (found == part.by_key.end())
    {
      ++part.stats.misses;
      return nullptr;
    }
    ++part.stats.hits;
    part.entries.splice(part.entries.begin(), part.entries, found->second);
    return found->second->value;
  }

  /// What another thread kept meanwhile stays.
  /// @param bytes  of the value, roughly
  /// @return the value that is kept
  std::shared_ptr<const Value> keep(const Fingerprint& key, Value value, std::size_t bytes)
  {
    auto shared = std::make_shared<const Value>(std::move(value));
    Part& part = partOf(key);
    const std::lock_guard<std::mutex> lock(part.mutex);
    const auto [known, added] = part.by_key.emplace(key, part.entries.end());
    if (!added)
      return known->second->value;
    part.entries.push_front({key, shared, bytes + kOverhead});
    known->second = part.entries.begin();
    part.stats.bytes += bytes + kOverhead;
    while (part.stats.bytes > max_bytes_of_part_ && part.entries.size() > 1)
    {
      part.stats.bytes -= part.entries.back().bytes;
      part.by_key.erase(part.entries.back().key);
      part.entries.pop_back();
      ++part.stats.evictions;
    }
    return shared;
  }

  [[nodiscard]] ContentCacheStats stats() const
  {
    ContentCacheStats all;
    for (const Part& part : parts_)
    {
      const std::lock_guard<std::mutex> lock(part.mutex);
      all.hits += part.stats.hits;
      all.misses += part.stats.misses;
      all.evictions += part.stats.evictions;
      all.entries += part.entries.size();
      all.bytes += part.stats.bytes;
    }
    return all;
  }

private:
  static constexpr std::size_t kParts = 16;  // each with a lock of its own
  static constexpr std::size_t kOverhead = 128;
  static constexpr std::size_t kDefaultBytes = 128U << 20U;

  struct Entry
  {
    Fingerprint key;
    std::shared_ptr<const Value> value;
    std::size_t bytes = 0;
  };
  struct Part
  {
    mutable std::mutex mutex;
    std::list<Entry> entries;  // the most recently used first
    std::unordered_map<Fingerprint, typename std::list<Entry>::iterator> by_key;
    ContentCacheStats stats;
  };

  Part& partOf(const Fingerprint& key) { return parts_[key.high % kParts]; }

  std::size_t max_bytes_of_part_;
  std::array<Part, kParts> parts_;
};

}  // namespace kr3::executive
