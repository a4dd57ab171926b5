#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "kr3_pomdp/belief.hpp"
#include "kr3_pomdp/policy.hpp"
#include "kr3_pomdp/solved_model.hpp"

namespace kr3::pomdp
{

/// The entries of a belief above 0, by ascending state.
[[nodiscard]] std::vector<SparseEntry> sparse(const Belief& belief);

/// @throws InvalidArgument  states that are out of order or range, or entries that make no belief
[[nodiscard]] Belief dense(const std::vector<SparseEntry>& entries, std::size_t num_states);

/// The index of an action (observation, state) by its name.
/// @throws InvalidArgument  there is none; the message names the nearest
[[nodiscard]] std::size_t actionNamed(const Model& model, const std::string& name);
[[nodiscard]] std::size_t observationNamed(const Model& model, const std::string& name);
[[nodiscard]] std::size_t stateNamed(const Model& model, const std::string& name);

/// What the robot believes at the start.
///
/// @param first_look  a state that looks like the true one; needed where the robot sees part of the
///                    state before its first action, else empty
/// @throws InvalidArgument     no such state, or none given where one is needed
/// @throws FailedPrecondition  what is seen there is impossible at the start
[[nodiscard]] Belief initialBelief(const Model& model, const std::string& first_look);

/// A belief that is kept for a client and follows what its robot does and sees.
///
/// Thread-safe: each change happens as a whole.
class KeptBelief
{
public:
  /// @param solved  not null
  /// @throws InvalidArgument  a belief of another size than the model
  KeptBelief(std::shared_ptr<const SolvedModel> solved, const Belief& belief);

  /// How it is at one time.
  struct Snapshot
  {
    Belief belief;
    std::uint64_t version;  ///< 1 at first, one more with each change
  };
  struct Advanced
  {
    Snapshot now;
    double probability;  ///< of the observation
  };

  [[nodiscard]] const SolvedModel& solved() const { return *solved_; }
  [[nodiscard]] std::shared_ptr<const SolvedModel> sharedSolved() const { return solved_; }
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::uint64_t version() const;
  [[nodiscard]] std::size_t numNonzero() const;
  /// Memory held, roughly, without the policy.
  [[nodiscard]] std::size_t sizeInBytes() const;

  /// The exact update after doing `action` and observing `observation`.
  ///
  /// @param version  that the belief must have; 0 = any
  /// @throws InvalidArgument     unknown name
  /// @throws FailedPrecondition  another version, or an observation that is impossible here; the
  ///                             belief stays as it was
  Advanced advance(const std::string& action, const std::string& observation,
                   std::uint64_t version);

  /// @throws InvalidArgument  a belief of another size than the model
  Snapshot reset(const Belief& belief);

private:
  Snapshot set(const Belief& belief);  // with the mutex held

  const std::shared_ptr<const SolvedModel> solved_;
  mutable std::mutex mutex_;  // guards what follows
  std::vector<SparseEntry> entries_;
  std::uint64_t version_ = 1;
};

/// What a policy does at a belief; none for a model without a policy.
/// @throws InvalidArgument  a belief of another size than the model
[[nodiscard]] std::optional<Policy::Choice> choiceAt(const SolvedModel& solved,
                                                     const Belief& belief);

}  // namespace kr3::pomdp
