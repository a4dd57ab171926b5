#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kr3_pomdp/belief.hpp"

namespace kr3::pomdp
{

/// One non-zero entry of a sparse row.
struct SparseEntry
{
  std::uint32_t index;
  double probability;
};

/// A read-only view of a sparse row, by ascending index. Valid as long as the model it came from.
class SparseRow
{
public:
  SparseRow(const SparseEntry* first, const SparseEntry* last) : first_(first), last_(last) {}
  [[nodiscard]] const SparseEntry* begin() const { return first_; }
  [[nodiscard]] const SparseEntry* end() const { return last_; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(last_ - first_); }

private:
  const SparseEntry* first_;
  const SparseEntry* last_;
};

/// Sparse rows in one block (compressed rows).
class SparseRows
{
public:
  SparseRows() : starts_{0} {}
  /// Appends a row; entries are sorted by index and have no duplicates.
  void append(const std::vector<SparseEntry>& row);
  [[nodiscard]] SparseRow row(std::size_t i) const
  {
    return {entries_.data() + starts_[i], entries_.data() + starts_[i + 1]};
  }
  [[nodiscard]] std::size_t numRows() const { return starts_.size() - 1; }
  [[nodiscard]] std::size_t numEntries() const { return entries_.size(); }

private:
  std::vector<SparseEntry> entries_;
  std::vector<std::size_t> starts_;
};

/// Sparse rows of which equal ones are kept once: most actions leave most of a state as it is, so
/// that models of many states have few different rows.
class SharedRows
{
public:
  [[nodiscard]] SparseRow row(std::size_t i) const { return distinct_.row(numbers_[i]); }
  [[nodiscard]] std::size_t numRows() const { return numbers_.size(); }
  [[nodiscard]] std::size_t sizeInBytes() const;

private:
  friend class SharedRowsBuilder;
  SparseRows distinct_;
  std::vector<std::uint32_t> numbers_;
};

/// Collects SharedRows row by row.
class SharedRowsBuilder
{
public:
  /// Appends a row; entries are sorted by index and have no duplicates.
  void append(const std::vector<SparseEntry>& row);
  void reserve(std::size_t num_rows) { rows_.numbers_.reserve(num_rows); }
  /// The rows; the builder is empty afterwards.
  [[nodiscard]] SharedRows take();

private:
  /// The slot of an equal row, or the empty one where it belongs.
  [[nodiscard]] std::size_t slotOf(const std::vector<SparseEntry>& row, std::uint64_t hash) const;
  void grow();

  SharedRows rows_;
  // Open addressing, a power of two: the upper half of a row's hash, its number + 1 (0: empty).
  std::vector<std::uint64_t> slots_;
};

/// The names of one kind of thing in a model; each has an index from 0.
class NameTable
{
public:
  /// @throws InvalidArgument  a duplicate or empty name
  NameTable(const std::string& kind, std::vector<std::string> names);
  [[nodiscard]] std::size_t size() const { return names_.size(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const std::string& operator[](std::size_t i) const { return names_.at(i); }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

private:
  std::vector<std::string> names_;
  std::vector<std::uint32_t> by_name_;  // indices, sorted by name
};

/// A belief that the robot may start with, and how likely it is.
struct InitialOutcome
{
  double probability;
  Belief belief;
};

/// All that a model is made of, see Model.
struct ModelParts
{
  std::vector<std::string> states;
  std::vector<std::string> actions;
  std::vector<std::string> observations;
  double discount = 1.0;
  std::vector<double> initial_belief;         ///< shape [num_states]
  std::vector<std::uint32_t> initial_labels;  ///< shape [num_states] or empty
  SharedRows transitions;                     ///< row: action * num_states + state
  SharedRows observation_rows;                ///< row: action * num_states + next state
  std::vector<double> rewards;                ///< row-major, shape [num_actions, num_states]
};

/// A flat, sparse POMDP. An immutable value, built by ModelBuilder or FactoredModel.
///
/// Invariant: every row of T and O sums to 1 within 1e-9 (after normalisation), all numbers are
/// finite, the discount is in (0, 1], there is at least one state, action and observation.
class Model
{
public:
  /// @throws InvalidArgument  a name, shape or row is wrong; the message names it
  explicit Model(ModelParts parts);

  [[nodiscard]] std::size_t numStates() const { return states_.size(); }
  [[nodiscard]] std::size_t numActions() const { return actions_.size(); }
  [[nodiscard]] std::size_t numObservations() const { return observations_.size(); }

  [[nodiscard]] const std::string& stateName(std::size_t state) const { return states_[state]; }
  [[nodiscard]] const std::string& actionName(std::size_t action) const { return actions_[action]; }
  [[nodiscard]] const std::string& observationName(std::size_t observation) const
  {
    return observations_[observation];
  }
  [[nodiscard]] std::optional<std::size_t> findState(std::string_view name) const
  {
    return states_.find(name);
  }
  [[nodiscard]] std::optional<std::size_t> findAction(std::string_view name) const
  {
    return actions_.find(name);
  }
  [[nodiscard]] std::optional<std::size_t> findObservation(std::string_view name) const
  {
    return observations_.find(name);
  }

  [[nodiscard]] double discount() const { return discount_; }
  [[nodiscard]] const Belief& initialBelief() const { return initial_belief_; }

  /// What the robot sees before its first action: the label of the true state, shape [num_states].
  /// Empty when it sees nothing.
  [[nodiscard]] const std::vector<std::uint32_t>& initialLabels() const { return initial_labels_; }

  /// The beliefs that the robot may have before its first action, by what it sees, in the order of
  /// labels; one without labels. Probabilities sum to 1.
  [[nodiscard]] std::vector<InitialOutcome> initialOutcomes() const;

  /// T(s' | s, a): index is s'.
  [[nodiscard]] SparseRow transitions(std::size_t action, std::size_t state) const
  {
    return transitions_.row(action * numStates() + state);
  }
  /// O(o | a, s'): index is o.
  [[nodiscard]] SparseRow observations(std::size_t action, std::size_t next_state) const
  {
    return observation_rows_.row(action * numStates() + next_state);
  }
  /// R(a, s): the expected immediate reward.
  [[nodiscard]] double reward(std::size_t action, std::size_t state) const
  {
    return rewards_[action * numStates() + state];
  }
  /// R(a, .), shape [num_states].
  [[nodiscard]] const double* rewards(std::size_t action) const
  {
    return rewards_.data() + action * numStates();
  }

  /// Memory held, roughly.
  [[nodiscard]] std::size_t sizeInBytes() const;

  /// The same model started elsewhere; the robot sees nothing before its first action.
  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] Model withInitialBelief(Belief belief) const;

  /// The same model with other sensors.
  /// @param rows  row: action * num_states + next state
  /// @throws InvalidArgument  a name, shape or row is wrong; the message names it
  [[nodiscard]] Model withObservations(std::vector<std::string> names, SharedRows rows) const;

private:
  /// @throws InvalidArgument  O has another shape, or a row that does not sum to 1
  void checkObservations() const;

  NameTable states_;
  NameTable actions_;
  NameTable observations_;
  double discount_;
  Belief initial_belief_;
  std::vector<std::uint32_t> initial_labels_;
  SharedRows transitions_;
  SharedRows observation_rows_;
  std::vector<double> rewards_;
};

}  // namespace kr3::pomdp
