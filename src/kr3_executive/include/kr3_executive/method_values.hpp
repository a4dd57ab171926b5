#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/comparison.hpp"

/// What methods earn, in the units of the generated model of the whole domain, beside what that
/// model's solver proves.
namespace kr3::executive
{

struct ValueOptions
{
  /// Nothing: the true state is drawn from what the history says without defaults, as POMDP-1
  /// believes; else from what POMDP-2 believes with this probability of the defaults.
  std::optional<double> default_probability;
  std::uint64_t trials = 1000;
  std::uint64_t first_seed = 1;
  /// Of the solver that gives the bounds.
  SolveBudget reference{0.05, 0.0, 50000};
  /// Of the model that it solves: actions times states.
  std::size_t max_rows = 400000;
  /// Method by method.
  AbstractMissionConfig mission;
};

/// What one method earned in each trial.
struct MethodValue
{
  std::string name;
  std::vector<double> discounted;    ///< rewards of the flat model, with its discount
  std::vector<double> undiscounted;  ///< the same without
  std::uint64_t wrong = 0;           ///< trials that declared a goal which was not true
  std::uint64_t silent = 0;          ///< trials that did not declare the goal
  /// Of each trial: its low-level actions with what they told, and how it ended.
  std::vector<std::string> courses;
};

struct ValueTable
{
  std::size_t num_states = 0;   ///< of the flat model
  std::size_t num_actions = 0;  ///< with `finish`
  double discount = 1.0;
  double lower = 0.0;  ///< the optimum at the start is no less
  double upper = 0.0;  ///< and no more
  std::uint64_t backups = 0;
  double cpu_s = 0.0;  ///< of the solver
  /// The first is the policy that earns `lower`, under the name "reference".
  std::vector<MethodValue> methods;
};

/// The same trials (true states, seeds) by each method in the abstract simulator.
///
/// A mission earns the negative seconds of each low-level action and at its end what `finish` earns
/// in the true state: objectiveFor() of the domain. One that ends without declaring the goal earns
/// what `finish` does where the goal does not hold.
///
/// @param directory  of the domain, with a scenario
/// @throws ResourceExhausted  the flat model is larger than `max_rows`
[[nodiscard]] ValueTable methodValues(const std::string& directory,
                                      const std::vector<Method>& methods,
                                      const ValueOptions& options);

/// The mean of one less the mean of the other, trial by trial.
/// @throws InvalidArgument  other numbers of trials
[[nodiscard]] Estimate pairedDifference(const std::vector<double>& a, const std::vector<double>& b);

/// The row of the greatest discounted mean: the best known value.
[[nodiscard]] const MethodValue& bestOf(const ValueTable& table);

/// Whether a method's mean is at most 5 % below the best known one, or at most 1.
[[nodiscard]] bool isNearBest(const ValueTable& table, const MethodValue& method);

void print(std::ostream& out, const ValueTable& table);

/// What the methods did in the first trials in which any of them acted otherwise than the first.
void printDifferences(std::ostream& out, const ValueTable& table, std::size_t trials);

}  // namespace kr3::executive
