#include "kr3_executive/policy_cache.hpp"

#include <chrono>
#include <cstring>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

#include <kr3_common/error.hpp>

#include "policy_file.hpp"

namespace kr3::executive
{
namespace
{

/// How soon a waiting thread sees that it was cancelled.
constexpr std::chrono::milliseconds kCancelPeriod{20};

/// All bits count.
std::uint64_t bitsOf(double number)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

std::size_t sizeOf(const CachedPolicy& policy)
{
  return sizeof(CachedPolicy) + policy.policy.sizeInBytes();
}

}  // namespace

PolicyCache::PolicyCache(PolicyCacheOptions options) : options_(std::move(options))
{
  if (options_.directory.empty())
    return;
  std::error_code error;
  std::filesystem::create_directories(options_.directory, error);
  if (error || !std::filesystem::is_directory(options_.directory))
    throw Unavailable("cannot make the directory '" + options_.directory + "' for policies");
}

PolicyCache::Key PolicyCache::keyOf(const pomdp::Model& model, const SolveBudget& budget)
{
  Fingerprinter fingerprinter;
  for (const Fingerprint& part : {fingerprintOf(model), startFingerprintOf(model)})
  {
    fingerprinter.add(part.high);
    fingerprinter.add(part.low);
  }
  fingerprinter.add(bitsOf(budget.precision));
  fingerprinter.add(bitsOf(budget.time_s));
  fingerprinter.add(budget.max_backups);
  return fingerprinter.result();
}

PolicyCache::Found PolicyCache::findOrSolve(const Key& key, const pomdp::Model& model,
                                            const Solve& solve, const std::atomic<bool>& cancel)
{
  std::unique_lock<std::mutex> lock(mutex_);
  while (true)
  {
    const auto found = by_key_.find(key);
    if (found == by_key_.end())
      break;
    if (found->second->policy)
    {
      ++stats_.hits;
      entries_.splice(entries_.begin(), entries_, found->second);
      return {found->second->policy, true};
    }
    if (cancel)
      throw Cancelled("waiting for a policy was cancelled");
    solved_.wait_for(lock, kCancelPeriod);
  }
  const auto entry = entries_.insert(entries_.begin(), Entry{key, nullptr, 0});
  by_key_.emplace(key, entry);
  lock.unlock();

  std::shared_ptr<const CachedPolicy> policy;
  bool from_disk = false;
  try
  {
    policy = read(key, model);
    from_disk = policy != nullptr;
    if (!from_disk)
      policy = std::make_shared<const CachedPolicy>(solve());
  }
  catch (...)
  {
    lock.lock();
    forget(entry);
    solved_.notify_all();
    throw;
  }
  if (!from_disk)
    write(key, *policy);
  lock.lock();
  ++(from_disk ? stats_.disk_hits : stats_.misses);
  stats_.solve_cpu_s += from_disk ? 0.0 : policy->cpu_s;
  keep(entry, policy);
  solved_.notify_all();
  return {policy, from_disk};
}

std::shared_ptr<const CachedPolicy> PolicyCache::find(const Key& key)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = by_key_.find(key);
  if (found == by_key_.end())
    return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->policy;
}

void PolicyCache::keep(Entries::iterator entry, std::shared_ptr<const CachedPolicy> policy)
{
  entry->bytes = sizeOf(*policy);
  entry->policy = std::move(policy);
  entries_.splice(entries_.begin(), entries_, entry);
  stats_.bytes += entry->bytes;
  ++stats_.policies;
  for (auto last = entries_.end(); stats_.bytes > options_.max_bytes && stats_.policies > 1;)
  {
    --last;
    if (!last->policy)
      continue;
    stats_.bytes -= last->bytes;
    --stats_.policies;
    ++stats_.evictions;
    const auto evicted = last++;
    forget(evicted);
  }
}

void PolicyCache::forget(Entries::iterator entry)
{
  by_key_.erase(entry->key);
  entries_.erase(entry);
}

PolicyCacheStats PolicyCache::stats() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return stats_;
}

std::string PolicyCache::pathOf(const Key& key) const
{
  return (std::filesystem::path(options_.directory) / (toString(key) + ".policy")).string();
}

std::shared_ptr<const CachedPolicy> PolicyCache::read(const Key& key,
                                                      const pomdp::Model& model) const
{
  std::error_code error;
  if (options_.directory.empty() || !std::filesystem::exists(pathOf(key), error))
    return nullptr;
  try
  {
    auto policy = std::make_shared<const CachedPolicy>(readPolicyFile(pathOf(key), key));
    if (policy->policy.numStates() == model.numStates() &&
        policy->policy.maxAction() < model.numActions())
      return policy;
    warn("'" + pathOf(key) + "' holds a policy for a model of another size");
  }
  catch (const Error& damaged)
  {
    warn(damaged.what());
  }
  return nullptr;
}

void PolicyCache::write(const Key& key, const CachedPolicy& policy) const
{
  if (options_.directory.empty())
    return;
  try
  {
    writePolicyFile(pathOf(key), key, policy);
  }
  catch (const Error& error)
  {
    warn(error.what());
  }
}

void PolicyCache::warn(const std::string& text) const
{
  if (options_.warn)
    options_.warn(text);
}

}  // namespace kr3::executive
