#pragma once

#include <memory>
#include <string>

#include "baseline_cache.hpp"
#include "controller.hpp"
#include "kr3_executive/method.hpp"
#include "test_plan.hpp"

namespace kr3::executive
{

/// A policy for a flat model. Where the server solves in process, the solver begins with
/// searchPolicy().
/// @param tests      of the model's task, goal and start
/// @param threshold  as of searchPolicy()
[[nodiscard]] SolvedPolicy solvedFlat(const FlatModel& model, TestPlan& tests,
                                      const DomainBelief& start, double threshold,
                                      const BaselineOptions& options, PolicyServer& policies,
                                      const std::atomic<bool>& cancel);

/// POMDP-1: the whole domain as one POMDP that is solved ahead. The policy is asked at the exact
/// belief before each action.
class FlatController : public Controller
{
public:
  /// @throws ResourceExhausted  the model is larger than BaselineOptions::max_rows
  /// @param threshold  belief in one state above which the first policy acts on it
  FlatController(const DomainBelief& start, const reasoner::Formula& goal, double threshold,
                 PolicyServer& policies, const BaselineOptions& options,
                 std::shared_ptr<BaselineCache> cache, const std::atomic<bool>& cancel);

  std::optional<std::size_t> next(const DomainBelief& belief,
                                  const std::atomic<bool>& cancel) override;
  [[nodiscard]] std::string description() const override;
  /// What is not known of the policy's value at the start, as a part of the difference between
  /// success and a wrong end.
  [[nodiscard]] double relativeGap() const;

private:
  void plan(const DomainBelief& start, const std::atomic<bool>& cancel);
  [[nodiscard]] SolvedPolicy solve(const FlatModel& model, const DomainBelief& start,
                                   const std::atomic<bool>& cancel);

  reasoner::Formula goal_;
  double threshold_;
  PolicyServer& policies_;
  BaselineOptions options_;
  std::shared_ptr<BaselineCache> cache_;
  std::shared_ptr<FlatPlan> plan_;
};

}  // namespace kr3::executive
