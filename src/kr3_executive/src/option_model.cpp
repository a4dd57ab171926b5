#include "option_model.hpp"

#include <algorithm>
#include <random>

#include <kr3_pomdp/simulation.hpp>

namespace kr3::executive
{
namespace
{

constexpr std::size_t kMaxSteps = 60;  // of a simulated run
constexpr std::size_t kMaxDraws = 200;
constexpr double kLeastDetection = 0.05;
constexpr double kLeastSeconds = 1.0;
/// Odds that grow by this factor make an action seem possible: the least that Jeffreys (1961) calls
/// substantial evidence. What it really says comes by Bayes' rule, into the exact belief.
constexpr double kTelling = 3.0;
constexpr double kLeastDoubt = 1e-9;

/// Sums of efforts, and how many.
class Total
{
public:
  void add(const OptionEffort& effort)
  {
    seconds_ += effort.seconds;
    steps_ += effort.steps;
    ++count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] OptionEffort meanOr(const OptionEffort& prior) const
  {
    if (count_ == 0)
      return prior;
    const auto n = static_cast<double>(count_);
    return {std::max(kLeastSeconds, seconds_ / n), std::max(1.0, steps_ / n)};
  }

private:
  double seconds_ = 0.0;
  double steps_ = 0.0;
  std::size_t count_ = 0;
};

struct Run
{
  bool possible = false;
  bool success = false;
  OptionEffort taken;
  bool seemed_possible = false;
  OptionEffort until_known;  ///< that it seemed possible; else as `taken`
};

double oddsOfPossible(const refinement::PomdpTask& task, const pomdp::Belief& belief)
{
  const double hopeless = std::clamp(task.hopelessProbability(belief), kLeastDoubt, 1.0);
  return (1.0 - hopeless) / hopeless;
}

Run simulatedRun(const LowLevelTask& begun, PolicyServer& policies, const std::string& policy,
                 double threshold, bool possible, std::mt19937_64& random)
{
  const auto& task = begun.pomdp();
  Run run;
  std::size_t truth = pomdp::sampleState(begun.belief(), random);
  for (std::size_t draw = 0; draw < kMaxDraws && task.isHopeless(truth) == possible; ++draw)
    truth = pomdp::sampleState(begun.belief(), random);
  run.possible = !task.isHopeless(truth);
  run.taken = {0.0, 0.0};
  pomdp::Belief belief = begun.belief();
  const double prior_odds = oddsOfPossible(task, belief);
  while (run.taken.steps < static_cast<double>(kMaxSteps))
  {
    if (!run.seemed_possible && oddsOfPossible(task, belief) >= kTelling * prior_odds)
    {
      run.seemed_possible = true;
      run.until_known = run.taken;
    }
    if (task.successProbability(belief) > threshold)
      break;
    const std::size_t chosen = policies.actionAt(policy, belief);
    if (chosen == task.finishAction())
      break;
    run.taken.seconds -= task.model().reward(chosen, truth);
    run.taken.steps += 1.0;
    const auto sampled = pomdp::sampleStep(task.model(), truth, chosen, random);
    truth = sampled.next_state;
    belief = pomdp::updated(task.model(), belief, chosen, sampled.observation).posterior;
  }
  run.success = task.isSuccess(truth);
  if (!run.seemed_possible)
    run.until_known = run.taken;
  return run;
}

double shareOr(double prior, std::size_t part, std::size_t whole)
{
  return whole == 0 ? prior : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

OptionModel simulatedOption(const LowLevelTask& begun, PolicyServer& policies,
                            const std::string& policy, const OptionTrials& trials,
                            const OptionModel& prior)
{
  std::mt19937_64 random(trials.seed);
  Total success;
  Total failure;
  Total look_possible;
  Total look_impossible;
  std::size_t detected = 0;
  std::size_t alarms = 0;
  for (std::size_t i = 0; i < trials.samples; ++i)
  {
    const Run run = simulatedRun(begun, policies, policy, trials.threshold, i % 2 == 1, random);
    if (run.possible && run.success)
      success.add(run.taken);
    else if (!run.possible)
      failure.add(run.taken);
    (run.possible ? look_possible : look_impossible).add(run.until_known);
    (run.possible ? detected : alarms) += run.seemed_possible ? 1 : 0;
  }
  OptionModel model = prior;
  const std::size_t possible = look_possible.count();
  model.success = success.meanOr(prior.success);
  model.failure = failure.meanOr(model.success);
  model.detection = std::max(kLeastDetection, shareOr(1.0, success.count(), possible));
  model.look.where_possible = look_possible.meanOr(model.success);
  model.look.where_impossible = look_impossible.meanOr(model.failure);
  model.look.detection = std::max(kLeastDetection, shareOr(1.0, detected, possible));
  model.look.false_alarm = shareOr(0.0, alarms, look_impossible.count());
  return model;
}

}  // namespace kr3::executive
