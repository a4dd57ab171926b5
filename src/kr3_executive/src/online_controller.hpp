#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baseline_cache.hpp"
#include "controller.hpp"
#include "flat_model.hpp"
#include "kr3_executive/method.hpp"
#include "search_order.hpp"
#include "test_plan.hpp"

namespace kr3::executive
{

/// POMDP-1 on floors too large to solve ahead: plans from the present belief. Above the threshold
/// it acts as if the likeliest state were true; below it goes and looks where that is expected to
/// end the search soonest (orderOfTests). It ends when ending now is worth more than searching on:
/// p success + (1 - p) wrong_finish, where the goal holds with probability p, against success less
/// the expected seconds.
class OnlineController : public Controller
{
public:
  /// @param threshold  belief in one state above which it is acted on
  /// @param options    `online_prospects` bounds the work for each action
  OnlineController(const DomainBelief& start, const reasoner::Formula& goal, double threshold,
                   const BaselineOptions& options, const std::shared_ptr<BaselineCache>& cache);

  std::optional<std::size_t> next(const DomainBelief& belief,
                                  const std::atomic<bool>& cancel) override;
  [[nodiscard]] std::string description() const override;

private:
  [[nodiscard]] std::optional<SearchChoice> searchOrder(const Hypotheses& now);

  reasoner::Formula goal_;
  Objective objective_;
  double threshold_;
  SearchOrderOptions order_options_;
  std::vector<std::uint32_t> order_;  ///< hidden values as they were last to be tested
  std::shared_ptr<TestPlan> plan_;
  std::size_t num_actions_;
  std::size_t num_hypotheses_;
};

}  // namespace kr3::executive
