#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include <kr3_pomdp/model.hpp>
#include <kr3_pomdp/policy.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/model_fingerprint.hpp"

namespace kr3::executive
{

/// A policy and what is known of it.
struct CachedPolicy
{
  pomdp::Policy policy;
  double lower = 0.0;  ///< at the start for which it was solved
  double upper = 0.0;
  std::uint64_t backups = 0;
  double cpu_s = 0.0;  ///< that solving took
};

struct PolicyCacheStats
{
  std::uint64_t hits = 0;       ///< in memory; those that waited for another thread included
  std::uint64_t disk_hits = 0;  ///< read from the directory
  std::uint64_t misses = 0;     ///< solved
  std::uint64_t evictions = 0;
  std::size_t policies = 0;  ///< in memory now
  std::size_t bytes = 0;     ///< of these, roughly
  double solve_cpu_s = 0.0;  ///< that the misses took

  /// Part of the requests that needed no solving, [0, 1]; 0 without requests.
  [[nodiscard]] double hitRate() const
  {
    const std::uint64_t all = hits + disk_hits + misses;
    return all == 0 ? 0.0 : static_cast<double>(hits + disk_hits) / static_cast<double>(all);
  }
};

struct PolicyCacheOptions
{
  /// Policies in memory; the least recently used go first. At least one is kept.
  std::size_t max_bytes = 512U << 20U;
  /// Where policies are kept from run to run; empty: nowhere. Made when it is missing.
  std::string directory;
  /// Told what is wrong with a file, which then counts as missing; may be empty. Called from the
  /// thread that asked.
  std::function<void(const std::string&)> warn;
};

/// Policies by the content of their models: by numbers, not by names, so that the same task in
/// another room, or with another object, finds them. States, actions and observations are told by
/// index: generated models number them by the order of the declarations and of the map.
///
/// A policy is found for the same numbers (fingerprintOf), start, and budget. Its
/// validity does not depend on the start, but what a limited search finds does: were a policy for
/// one start given for another, what a robot does would depend on what was asked before, and
/// trials in several threads would not repeat. With counted work the policy is a function of the
/// key alone. The 128 bits of the key stand for the content, which is not compared again: no
/// one makes contents that meet on purpose, and a million of them meet by chance once in 1e26.
///
/// Thread-safe. Threads that ask for the same policy at the same time solve it once.
class PolicyCache
{
public:
  using Key = Fingerprint;
  using Solve = std::function<CachedPolicy()>;

  /// @throws Unavailable  the directory cannot be made
  explicit PolicyCache(PolicyCacheOptions options = {});

  [[nodiscard]] static Key keyOf(const pomdp::Model& model, const SolveBudget& budget);

  struct Found
  {
    std::shared_ptr<const CachedPolicy> policy;  ///< never null
    bool cached = false;                         ///< it was not solved by this call
  };

  /// The policy of a key; what `solve` returns when there is none yet. When `solve` throws,
  /// nothing is kept, and others who wait for the same policy solve it themselves.
  /// @param cancel  may be set from another thread while this one waits for another's solution
  /// @throws Cancelled  it was; whatever `solve` throws
  [[nodiscard]] Found findOrSolve(const Key& key, const pomdp::Model& model, const Solve& solve,
                                  const std::atomic<bool>& cancel);

  /// A policy that is in memory, else null. Counts as used, not as a hit.
  [[nodiscard]] std::shared_ptr<const CachedPolicy> find(const Key& key);

  [[nodiscard]] PolicyCacheStats stats() const;

private:
  struct Entry
  {
    Key key;
    std::shared_ptr<const CachedPolicy> policy;  // null while it is being solved
    std::size_t bytes = 0;
  };
  using Entries = std::list<Entry>;  // the most recently used first

  /// With the mutex held.
  void keep(Entries::iterator entry, std::shared_ptr<const CachedPolicy> policy);
  void forget(Entries::iterator entry);
  [[nodiscard]] std::string pathOf(const Key& key) const;
  [[nodiscard]] std::shared_ptr<const CachedPolicy> read(const Key& key,
                                                         const pomdp::Model& model) const;
  void write(const Key& key, const CachedPolicy& policy) const;
  void warn(const std::string& text) const;

  PolicyCacheOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable solved_;
  Entries entries_;
  std::unordered_map<Key, Entries::iterator> by_key_;
  PolicyCacheStats stats_;
};

}  // namespace kr3::executive
