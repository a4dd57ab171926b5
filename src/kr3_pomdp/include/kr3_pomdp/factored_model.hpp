#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// A variable of a factored model.
struct Variable
{
  std::string name;
  std::vector<std::string> values;
};

/// A variable of the state.
struct StateVariable : Variable
{
  bool observed = false;  ///< whether the robot sees it before each action, the first included
};

enum class VariableRole : std::uint8_t
{
  kPrevious,  ///< of the state before the action
  kAction,
  kCurrent,  ///< of the state after it
  kObservation,
};

/// A variable in a factor: the index counts among those of its role.
struct VariableRef
{
  VariableRole role;
  std::size_t index;
};

[[nodiscard]] inline bool operator==(const VariableRef& a, const VariableRef& b)
{
  return a.role == b.role && a.index == b.index;
}

/// A function of some variables.
struct Factor
{
  std::vector<VariableRef> parents;
  std::vector<VariableRef> of;  ///< what it gives the probabilities of; none for a reward
  /// Row-major over the values of `parents`, then `of`; the last variable changes fastest.
  std::vector<double> values;
};

/// A POMDP in factors, a dynamic Bayesian network: products of the probabilities of its variables,
/// sums of rewards. Variables that the robot sees make it a mixed-observability model.
///
/// Source: Ong, Png, Hsu and Lee (2010); Boutilier and Poole (1996).
struct FactoredModel
{
  std::vector<StateVariable> state;
  std::vector<Variable> actions;       ///< one of each is chosen at a time
  std::vector<Variable> observations;  ///< one of each is made at a time
  double discount = 1.0;
  std::vector<Factor> initial;      ///< of kPrevious, given kPrevious
  std::vector<Factor> transitions;  ///< of kCurrent, given kPrevious, kAction and kCurrent
  std::vector<Factor> observing;    ///< of kObservation, given kAction, kCurrent, kObservation
  std::vector<Factor> rewards;      ///< given anything

  [[nodiscard]] const Variable& variable(const VariableRef& ref) const;
  /// Product of the numbers of values of a factor's variables.
  /// @throws ResourceExhausted  above 2^27
  [[nodiscard]] std::size_t sizeOf(const Factor& factor) const;

  /// The flat model: a state is a value of each state variable, named by them joined with commas;
  /// actions and observations likewise. An observation names the seen state variables too, so that
  /// their values are certain after each action; before the first they are the initial labels.
  ///
  /// @param sum_tolerance  how far from 1 the probabilities given one combination of parents may
  ///                       sum; they are normalised
  /// @throws InvalidArgument    a factor of the wrong shape, with an entry that is no probability
  ///                            or a sum that is off, a variable without a factor or with two, or
  ///                            a circle among kCurrent variables; ResourceExhausted  more than
  ///                            2^24 states, 2^31 entries or 2^31 terms of expected rewards
  [[nodiscard]] Model flattened(double sum_tolerance = 1e-6) const;
};

}  // namespace kr3::pomdp
