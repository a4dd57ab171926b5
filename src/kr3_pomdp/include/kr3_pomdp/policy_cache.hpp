#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// A model with its solution.
struct SolvedModel
{
  std::string key;  ///< everything the solution depends on, as text
  Model model;
  SolveResult result;
};

/// Hash of a text, 128 bits as 32 hexadecimal digits; the same on every machine. Not cryptographic.
[[nodiscard]] std::string contentHash(const std::string& text);

/// Solved models by id, within a bound of memory: the one used longest ago goes first.
///
/// Entries are shared, so that one in use outlives its eviction. Not thread-safe.
class PolicyCache
{
public:
  /// @param max_bytes  greater than 0
  explicit PolicyCache(std::size_t max_bytes);

  /// The entry, which becomes the one used last; null when there is none (any more).
  [[nodiscard]] std::shared_ptr<const SolvedModel> find(const std::string& id);

  /// Adds or replaces an entry, and evicts others until all fits.
  /// @throws ResourceExhausted  the entry alone is larger than the bound; nothing was changed
  void put(const std::string& id, SolvedModel solved);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] std::size_t sizeInBytes() const { return bytes_; }
  [[nodiscard]] std::size_t maxBytes() const { return max_bytes_; }

private:
  struct Entry
  {
    std::string id;
    std::size_t bytes;
    std::shared_ptr<const SolvedModel> solved;
  };
  void erase(std::list<Entry>::iterator entry);

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // used last first
  std::unordered_map<std::string, std::list<Entry>::iterator> index_;
};

}  // namespace kr3::pomdp
