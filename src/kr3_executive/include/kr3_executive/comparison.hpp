#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_executive/abstract_mission.hpp"

namespace kr3::executive
{

/// A mean or share with its 95 % confidence interval.
struct Estimate
{
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Share of successes, by Wilson's score interval. @throws InvalidArgument  no trials
[[nodiscard]] Estimate shareOf(std::uint64_t successes, std::uint64_t trials);
/// Mean with 1.96 standard errors on either side. @throws InvalidArgument  no values
[[nodiscard]] Estimate meanOf(const std::vector<double>& values);

/// The same trials by one method: same truths, same seeds.
struct MethodTrials
{
  Method method = Method::kPa;
  std::vector<TrialResult> results;
  double wall_s = 0.0;  ///< of all
};

/// A seed for what is drawn outside of the world, so that it is independent of the world's own
/// draws, which begin with `seed`.
[[nodiscard]] std::uint64_t drawnApart(std::uint64_t seed);

/// What is true in the world in a trial: each valued fluent of the goal that the scenario leaves
/// open takes one of its values, drawn with the seed.
[[nodiscard]] std::vector<std::string> drawnTruths(const AbstractMissions& missions,
                                                   const std::string& goal, std::uint64_t seed);

/// A table: success, false declarations, actions and simulated seconds of each method, and the mean
/// difference of the seconds to those of the first method, pair by pair.
/// @throws InvalidArgument  methods with different numbers of trials, or none
void printComparison(std::ostream& out, const std::vector<MethodTrials>& methods);

}  // namespace kr3::executive
