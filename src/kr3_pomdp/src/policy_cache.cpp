#include "kr3_pomdp/policy_cache.hpp"

#include <cstdint>
#include <cstdio>
#include <iterator>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

/// FNV-1a over the text, then mixed; `seed` gives independent halves.
std::uint64_t hash64(const std::string& text, std::uint64_t seed)
{
  std::uint64_t hash = 0xcbf29ce484222325ULL ^ seed;
  for (const char c : text)
  {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  hash ^= hash >> 33;
  hash *= 0xff51afd7ed558ccdULL;
  hash ^= hash >> 33;
  return hash;
}

}  // namespace

std::string contentHash(const std::string& text)
{
  char digits[33];
  std::snprintf(digits, sizeof(digits), "%016llx%016llx",
                static_cast<unsigned long long>(hash64(text, 0)),
                static_cast<unsigned long long>(hash64(text, 0x9e3779b97f4a7c15ULL)));
  return digits;
}

PolicyCache::PolicyCache(std::size_t max_bytes) : max_bytes_(max_bytes)
{
  if (max_bytes == 0)
  {
    throw InvalidArgument("a cache of 0 bytes, expected more");
  }
}

std::shared_ptr<const SolvedModel> PolicyCache::find(const std::string& id)
{
  const auto found = index_.find(id);
  if (found == index_.end())
  {
    return nullptr;
  }
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->solved;
}

void PolicyCache::put(const std::string& id, SolvedModel solved)
{
  const std::size_t bytes = sizeof(SolvedModel) + id.size() + solved.key.size() +
                            solved.model.sizeInBytes() + solved.result.policy.sizeInBytes();
  if (bytes > max_bytes_)
  {
    throw ResourceExhausted("a policy of " + std::to_string(bytes) + " bytes, the cache holds " +
                            std::to_string(max_bytes_));
  }
  if (const auto found = index_.find(id); found != index_.end())
  {
    erase(found->second);
  }
  while (bytes_ + bytes > max_bytes_)
  {
    erase(std::prev(entries_.end()));
  }
  entries_.push_front({id, bytes, std::make_shared<const SolvedModel>(std::move(solved))});
  index_[id] = entries_.begin();
  bytes_ += bytes;
}

void PolicyCache::erase(std::list<Entry>::iterator entry)
{
  bytes_ -= entry->bytes;
  index_.erase(entry->id);
  entries_.erase(entry);
}

}  // namespace kr3::pomdp
