#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "baseline_cache.hpp"
#include "controller.hpp"
#include "flat_model.hpp"
#include "search_order.hpp"
#include "shortest_route.hpp"

namespace kr3::executive
{

/// Ways through a domain for each state, as if the state were known: to where its hidden values can
/// be looked at, and to the goal. Kept between missions.
class TestPlan
{
public:
  /// @param hidden  fluents that the start belief leaves open, by number; those that some action
  ///                senses without changing them count as hidden
  TestPlan(refinement::DomainTask& task, reasoner::Formula goal, std::vector<std::size_t> hidden);

  /// Its last step is an action that tells whether a hidden fluent has the value that it has in the
  /// state, without changing it.
  const std::optional<Route>& testFrom(refinement::StateId state);
  const std::optional<Route>& goalFrom(refinement::StateId state);
  /// Probability that the route's last step says so, in the state that it leads to.
  [[nodiscard]] double detection(const Route& test) const;

  /// The state with the open values of `hidden_from` and all others of `state`.
  [[nodiscard]] std::optional<refinement::StateId> combined(refinement::StateId state,
                                                            refinement::StateId hidden_from);

  /// Where a fluent is open that is known only as the outcome of actions (the robot's own place):
  /// the cheapest action that tells it, among those about what is likely.
  [[nodiscard]] std::optional<std::size_t> orienting(const DomainBelief& belief,
                                                     refinement::StateId likeliest);

private:
  using Allowed = std::vector<std::size_t>;

  [[nodiscard]] Allowed actionsAbout(refinement::StateId state) const;
  [[nodiscard]] std::optional<Route> route(refinement::StateId state, bool to_test);
  [[nodiscard]] std::optional<Route> route(refinement::StateId state, bool to_test,
                                           const Allowed& actions);
  [[nodiscard]] bool tests(std::size_t action, refinement::StateId state) const;
  [[nodiscard]] std::optional<RouteStep> likeliest(refinement::StateId state, std::size_t action);

  refinement::DomainTask& task_;
  reasoner::Formula goal_;
  std::vector<std::size_t> hidden_;
  std::set<std::string> always_;  ///< constants that every state's routes may use
  std::unordered_map<refinement::StateId, std::optional<Route>> tests_;
  std::unordered_map<refinement::StateId, std::optional<Route>> goals_;
  std::unordered_map<std::uint64_t, std::optional<refinement::StateId>> combined_;
};

/// POMDP-1 on floors too large to solve ahead: plans from the present belief. Above the threshold
/// it acts as if the likeliest state were true; below it goes and looks where that is expected to
/// end the search soonest (firstToTest). It ends when ending now is worth more than searching on:
/// p success + (1 - p) wrong_finish, where the goal holds with probability p, against success less
/// the expected seconds.
class OnlineController : public Controller
{
public:
  /// @param threshold  belief in one state above which it is acted on
  OnlineController(const DomainBelief& start, const reasoner::Formula& goal, double threshold,
                   std::shared_ptr<BaselineCache> cache);

  std::optional<std::size_t> next(const DomainBelief& belief,
                                  const std::atomic<bool>& cancel) override;
  [[nodiscard]] std::string description() const override;

private:
  reasoner::Formula goal_;
  Objective objective_;
  double threshold_;
  std::shared_ptr<TestPlan> plan_;
  std::size_t num_actions_;
  std::size_t num_hypotheses_;
};

}  // namespace kr3::executive
