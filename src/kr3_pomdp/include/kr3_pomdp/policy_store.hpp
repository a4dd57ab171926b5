#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "kr3_pomdp/kept_belief.hpp"
#include "kr3_pomdp/solved_model.hpp"

namespace kr3::pomdp
{

/// A policy in a store.
struct StoredPolicy
{
  std::string id;
  std::shared_ptr<const SolvedModel> solved;
  std::size_t num_beliefs;
  std::size_t bytes;
  double age_s;   ///< since it was put
  double idle_s;  ///< since it was used
};

/// A belief in a store.
struct StoredBelief
{
  std::string id;
  std::string policy_id;
  std::shared_ptr<KeptBelief> belief;
  double age_s;
  double idle_s;
};

struct StoreStatistics
{
  std::size_t num_policies;
  std::size_t num_beliefs;
  std::size_t bytes;
  std::uint64_t evicted_policies;  ///< since the store was made
  std::uint64_t evicted_beliefs;
};

/// Policies and beliefs by id, within bounds of memory and of number.
///
/// When memory runs out, policies without beliefs go first, the one used longest ago before others;
/// then policies in use, with their beliefs. When there are too many beliefs, the one used longest
/// ago goes. Using a belief uses its policy. What goes while it is in use elsewhere lives until
/// that ends. Ids that are gone are remembered for a while, so that NotFound says why.
///
/// Thread-safe; no call waits for more than a look-up of another, nor for memory to be freed.
class PolicyStore
{
public:
  struct Limits
  {
    std::size_t max_bytes = std::size_t{512} << 20U;  ///< > 0
    std::size_t max_beliefs = 1000;                   ///< > 0
  };
  /// @param prefix  of the ids of beliefs, such that those of another store differ
  /// @throws InvalidArgument  a limit of 0
  explicit PolicyStore(const Limits& limits, std::string prefix = "belief");

  /// Adds a policy, or replaces the one with the same content; beliefs on that keep what they have.
  /// @return its id: its content hash; a cancelled run has an id of its own that ends in
  /// "-preempted"
  /// @throws ResourceExhausted  it alone is larger than the bound; nothing was changed
  std::string put(std::shared_ptr<const SolvedModel> solved);

  /// @throws NotFound  none (any more)
  [[nodiscard]] std::shared_ptr<const SolvedModel> policy(const std::string& id);
  [[nodiscard]] StoredPolicy info(const std::string& id);

  /// The most precise policy that answers a request, see answers().
  [[nodiscard]] std::optional<StoredPolicy> find(const ModelText& text, const SolverLimits& wanted);
  /// A model that was read already; null when there is none.
  [[nodiscard]] std::shared_ptr<const NamedModel> findModel(const ModelText& text);
  /// Used last first.
  [[nodiscard]] std::vector<StoredPolicy> policies() const;
  /// @return how many beliefs went with it
  /// @throws NotFound  none (any more)
  std::size_t release(const std::string& id);

  /// @throws NotFound           no such policy (any more)
  /// @throws InvalidArgument    a belief of another size
  /// @throws ResourceExhausted  the belief and its policy are larger than the bound
  [[nodiscard]] StoredBelief create(const std::string& policy_id, const Belief& belief);
  /// @throws NotFound  none (any more)
  [[nodiscard]] StoredBelief belief(const std::string& id);
  /// Counts its memory anew, after a change; others may go.
  void resized(const std::string& id);
  /// @throws NotFound  none (any more)
  void erase(const std::string& id);
  /// Used last first.
  /// @param policy_id  empty = on any policy
  [[nodiscard]] std::vector<StoredBelief> beliefs(const std::string& policy_id) const;

  [[nodiscard]] StoreStatistics statistics() const;
  [[nodiscard]] const Limits& limits() const { return limits_; }

private:
  using Clock = std::chrono::steady_clock;
  struct PolicyEntry
  {
    std::string id;
    std::string text_hash;
    std::shared_ptr<const SolvedModel> solved;
    std::size_t bytes;
    std::size_t num_beliefs;
    Clock::time_point put;
    Clock::time_point used;
  };
  struct BeliefEntry
  {
    std::string id;
    std::string policy_id;
    std::shared_ptr<KeptBelief> belief;
    std::size_t bytes;
    Clock::time_point created;
    Clock::time_point used;
  };
  using Policies = std::list<PolicyEntry>;
  using Beliefs = std::list<BeliefEntry>;
  /// What was taken out under the mutex, to be freed after it.
  struct Removed
  {
    Policies policies;
    Beliefs beliefs;
  };

  // All with the mutex held.
  Policies::iterator find(const std::string& id);
  Beliefs::iterator findBelief(const std::string& id);
  void touch(Policies::iterator entry);
  std::size_t remove(Policies::iterator entry, const std::string& why, Removed& removed);
  void remove(Beliefs::iterator entry, const std::string& why, Removed& removed);
  void makeRoom(std::size_t bytes, const std::string& keep_policy, const std::string& keep_belief,
                Removed& removed);
  void noteGone(const std::string& id, const std::string& why);
  [[noreturn]] void failGone(const std::string& kind, const std::string& id) const;
  [[nodiscard]] StoredPolicy described(const PolicyEntry& entry) const;
  [[nodiscard]] static StoredBelief described(const BeliefEntry& entry);

  const Limits limits_;
  const std::string prefix_;
  mutable std::mutex mutex_;  // guards what follows
  std::size_t bytes_ = 0;
  std::uint64_t num_created_ = 0;    // beliefs
  std::uint64_t num_preempted_ = 0;  // policies of cancelled runs
  std::uint64_t evicted_policies_ = 0;
  std::uint64_t evicted_beliefs_ = 0;
  Policies policies_;  // used last first
  Beliefs beliefs_;    // used last first
  std::unordered_map<std::string, Policies::iterator> policy_index_;
  std::unordered_map<std::string, Beliefs::iterator> belief_index_;
  std::unordered_multimap<std::string, std::string> ids_of_text_;  // by the hash of a model's text
  std::deque<std::string> gone_order_;
  std::unordered_map<std::string, std::string> gone_;  // why
};

}  // namespace kr3::pomdp
