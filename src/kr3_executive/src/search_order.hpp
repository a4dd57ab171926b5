#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include <kr3_refinement/state_space.hpp>

namespace kr3::executive
{

/// The states of a belief as hypotheses, numbered.
struct Hypotheses
{
  std::vector<refinement::StateId> states;
  std::vector<double> probability;
  std::size_t likeliest = 0;

  [[nodiscard]] refinement::StateId likeliestState() const { return states[likeliest]; }
  [[nodiscard]] double highest() const { return probability[likeliest]; }
};

/// @param belief  not empty
[[nodiscard]] Hypotheses hypothesesOf(const std::map<refinement::StateId, double>& belief);

/// What testing one hypothesis takes, from where the robot then is.
struct Prospect
{
  double test_s = 0.0;     ///< to get there and look
  double rest_s = 0.0;     ///< from there to the goal, if it is true
  double detection = 1.0;  ///< probability that looking shows it, if it is true
  std::size_t end = 0;     ///< where the robot is afterwards, for further prospects
};

/// @param from  where the robot is
/// @return nothing when the hypothesis cannot be tested or the goal cannot be reached under it
using ProspectOf = std::function<std::optional<Prospect>(std::size_t from, std::size_t hypothesis)>;

struct SearchOrderOptions
{
  /// Hypotheses that are tried as the first one; the others follow greedily.
  std::size_t candidates = 8;
  /// Counted work: after so many prospects nothing further is tried. The greedy order is made
  /// whatever it takes.
  std::uint64_t max_prospects = 200000;
};

struct SearchChoice
{
  std::vector<std::size_t> order;  ///< hypotheses, that to test first in front; not empty
  double expected_s = 0.0;         ///< to the goal, looking on until it is reached
  std::uint64_t prospects = 0;     ///< work done
};

/// In which order to test hypotheses.
///
/// The greedy order takes next what has the greatest detection probability per second, the rule
/// that is optimal where the way there costs the same from everywhere. One step of rollout tries
/// each of the best candidates first, the others after it by the greedy rule. The order of the
/// least expected seconds to the goal is then improved by reversing parts of it and by moving
/// single tests, until nothing helps or the work is used up. Looking fails as often as it does, and
/// what is left then counts like another round.
///
/// @param probability  of each hypothesis
/// @param known        an order found before, tried as well; hypotheses may be missing or too many
/// @return nothing when none can be tested
/// Sources: Black (1965), the index of the discrete search problem; Bertsekas and Castañón (1999),
/// rollout of such heuristics; Croes (1958) and Or (1976), the two moves.
[[nodiscard]] std::optional<SearchChoice> orderOfTests(const std::vector<double>& probability,
                                                       std::size_t from, const ProspectOf& prospect,
                                                       const SearchOrderOptions& options,
                                                       const std::vector<std::size_t>& known = {});

}  // namespace kr3::executive
