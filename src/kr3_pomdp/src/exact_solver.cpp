#include "kr3_pomdp/exact_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "domination.hpp"
#include "kr3_pomdp/start_value.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A vector that is nowhere better than the others by this part of the values is left out.
constexpr double kNegligible = 1e-12;
/// Likewise by this part of how far the values move in one iteration.
constexpr double kPrunedPart = 0.05;

/// A vector, its plan's first action, and a belief at which it was the best of its set.
struct PlanVector
{
  std::size_t action;
  std::vector<double> values;
  std::vector<double> witness;
};

using PlanSet = std::vector<PlanVector>;

double dot(const std::vector<double>& a, const std::vector<double>& b)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    sum += a[i] * b[i];
  }
  return sum;
}

bool isNowhereBelow(const std::vector<double>& upper, const std::vector<double>& lower)
{
  return std::equal(upper.begin(), upper.end(), lower.begin(), std::greater_equal<>());
}

/// One run of value iteration.
class ValueIteration
{
public:
  ValueIteration(const Model& model, const ExactLimits& limits)
    : model_(&model), limits_(&limits), start_(Clock::now())
  {
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      for (std::size_t s = 0; s < model.numStates(); ++s)
      {
        scale_ = std::max(scale_, std::abs(model.reward(a, s)));
      }
    }
    if (limits.horizon == 0)
    {
      scale_ /= 1.0 - model.discount();
    }
    negligible_ = kNegligible * scale_;
  }

  ExactSolution overHorizon()
  {
    ExactSolution result{{}, 0.0, limits_->horizon};
    PlanSet values{{0, std::vector<double>(model_->numStates(), 0.0), {}}};
    for (std::size_t step = 0; step < limits_->horizon; ++step)
    {
      values = backedUp(values);
      result.error = loss_ + model_->discount() * result.error;
      result.stages.push_back(policyOf(values));
    }
    return result;
  }

  ExactSolution forEver()
  {
    const double rest = 1.0 / (1.0 - model_->discount());
    PlanSet values = blindPlans();
    double residual = scale_;
    for (std::size_t iteration = 1;; ++iteration)
    {
      // Far from the end it would be wasted work to keep plans for less than the values still move.
      negligible_ = std::max(kNegligible * scale_,
                             kPrunedPart * std::max(residual, limits_->precision / rest) /
                                 static_cast<double>(2 * model_->numObservations() + 1));
      PlanSet next = backedUp(values);
      residual = 0.0;
      const std::vector<const double*> before = pointers(values);
      for (const PlanVector& plan : next)
      {
        checkTime();
        residual = std::max(residual, marginOver(plan.values, before).upper);
      }
      values = std::move(next);
      const double error = rest * (model_->discount() * residual + loss_);
      if (error <= limits_->precision)
      {
        return {{policyOf(values)}, error, iteration};
      }
    }
  }

private:
  using Clock = std::chrono::steady_clock;

  void checkTime() const
  {
    if (limits_->time_s > 0.0 &&
        std::chrono::duration<double>(Clock::now() - start_).count() > limits_->time_s)
    {
      throw DeadlineExceeded("the exact solution takes more than " +
                             std::to_string(limits_->time_s) + " s");
    }
  }

  static std::vector<const double*> pointers(const PlanSet& plans)
  {
    std::vector<const double*> result;
    for (const PlanVector& plan : plans)
    {
      result.push_back(plan.values.data());
    }
    return result;
  }

  [[nodiscard]] Policy policyOf(const PlanSet& plans) const
  {
    std::vector<AlphaVector> vectors;
    for (const PlanVector& plan : plans)
    {
      vectors.push_back({plan.action, {}, plan.values});
    }
    return Policy(model_->numStates(), vectors);
  }

  /// One action for ever, for each action; from below, so that a backup of them is nowhere below.
  PlanSet blindPlans() const
  {
    PlanSet plans;
    for (std::size_t a = 0; a < model_->numActions(); ++a)
    {
      const double* rewards = model_->rewards(a);
      const double least = *std::min_element(rewards, rewards + model_->numStates());
      std::vector<double> values(model_->numStates(), least / (1.0 - model_->discount()));
      for (double change = scale_; change > kNegligible * scale_;)
      {
        checkTime();
        std::vector<double> next(values.size());
        change = 0.0;
        for (std::size_t s = 0; s < values.size(); ++s)
        {
          double sum = 0.0;
          for (const SparseEntry& to : model_->transitions(a, s))
          {
            sum += to.probability * values[to.index];
          }
          next[s] = std::max(values[s], rewards[s] + model_->discount() * sum);
          change = std::max(change, next[s] - values[s]);
        }
        values = std::move(next);
      }
      plans.push_back({a, std::move(values), {}});
    }
    return plans;
  }

  /// The value function with one more step to go; `loss_` says how far below it is at most.
  PlanSet backedUp(const PlanSet& values)
  {
    PlanSet all;
    double greatest_loss = 0.0;
    for (std::size_t a = 0; a < model_->numActions(); ++a)
    {
      loss_ = 0.0;
      PlanSet of_action{{a, {model_->rewards(a), model_->rewards(a) + model_->numStates()}, {}}};
      std::vector<PlanSet> parts;
      for (std::size_t o = 0; o < model_->numObservations(); ++o)
      {
        parts.push_back(pruned(projected(values, a, o)));
      }
      std::stable_sort(parts.begin(), parts.end(), [](const PlanSet& left, const PlanSet& right) {
        return left.size() < right.size();
      });
      for (const PlanSet& part : parts)
      {
        of_action = pruned(crossSum(of_action, part));
      }
      std::move(of_action.begin(), of_action.end(), std::back_inserter(all));
      greatest_loss = std::max(greatest_loss, loss_);
    }
    loss_ = greatest_loss;
    return pruned(std::move(all));
  }

  /// The plans weighted with the chance of `o`: g sum_s' T(s' | s, a) O(o | a, s') alpha(s').
  [[nodiscard]] PlanSet projected(const PlanSet& values, std::size_t a, std::size_t o) const
  {
    std::vector<double> chances(model_->numStates(), 0.0);
    for (std::size_t s = 0; s < chances.size(); ++s)
    {
      for (const SparseEntry& seen : model_->observations(a, s))
      {
        chances[s] += seen.index == o ? seen.probability : 0.0;
      }
    }
    PlanSet result;
    for (const PlanVector& plan : values)
    {
      std::vector<double> projection(chances.size(), 0.0);
      for (std::size_t s = 0; s < chances.size(); ++s)
      {
        for (const SparseEntry& next : model_->transitions(a, s))
        {
          projection[s] += next.probability * chances[next.index] * plan.values[next.index];
        }
        projection[s] *= model_->discount();
      }
      result.push_back({a, std::move(projection), {}});
    }
    return result;
  }

  PlanSet crossSum(const PlanSet& left, const PlanSet& right) const
  {
    checkSize(left.size() * right.size());
    PlanSet sums;
    sums.reserve(left.size() * right.size());
    for (const PlanVector& i : left)
    {
      for (const PlanVector& k : right)
      {
        PlanVector sum = i;
        for (std::size_t s = 0; s < sum.values.size(); ++s)
        {
          sum.values[s] += k.values[s];
        }
        sums.push_back(std::move(sum));
      }
    }
    return sums;
  }

  void checkSize(std::size_t size) const
  {
    if (size > limits_->max_vectors)
    {
      throw ResourceExhausted("the exact solution needs " + std::to_string(size) +
                              " vectors, expected at most " + std::to_string(limits_->max_vectors));
    }
  }

  /// The plans that are best at some belief.
  /// Source: Lark's algorithm, in Cassandra, Littman and Zhang (1997), Fig. 1.
  PlanSet pruned(PlanSet plans)
  {
    checkSize(plans.size());
    plans = withoutDominated(std::move(plans));
    PlanSet kept;
    const auto keepBestAt = [&](std::vector<double> belief) {
      const std::size_t best = bestAt(plans, belief);
      plans[best].witness = std::move(belief);
      kept.push_back(std::move(plans[best]));
      plans.erase(plans.begin() + static_cast<std::ptrdiff_t>(best));
    };
    for (std::size_t s = 0; s < model_->numStates() && !plans.empty(); ++s)
    {
      double greatest = -kInfinity;
      for (const PlanVector& plan : kept)
      {
        greatest = std::max(greatest, plan.values[s]);
      }
      std::vector<double> corner(model_->numStates(), 0.0);
      corner[s] = 1.0;
      if (plans[bestAt(plans, corner)].values[s] > greatest + negligible_)
      {
        keepBestAt(std::move(corner));
      }
    }
    double loss = 0.0;
    while (!plans.empty())
    {
      checkTime();
      Margin margin = marginOver(plans.back().values, pointers(kept), negligible_);
      if (margin.lower > negligible_)
      {
        keepBestAt(std::move(margin.belief));
      }
      else
      {
        loss = std::max(loss, margin.upper);
        plans.pop_back();
      }
    }
    loss_ += loss;
    return kept;
  }

  static PlanSet withoutDominated(PlanSet plans)
  {
    PlanSet kept;
    for (PlanVector& plan : plans)
    {
      const auto covers = [&plan](const PlanVector& other) {
        return isNowhereBelow(other.values, plan.values);
      };
      if (std::none_of(kept.begin(), kept.end(), covers))
      {
        kept.erase(std::remove_if(
                       kept.begin(), kept.end(),
                       [&plan](const PlanVector& other) {
          return isNowhereBelow(plan.values, other.values);
                       }),
                   kept.end());
        kept.push_back(std::move(plan));
      }
    }
    return kept;
  }

  /// Of those that are equally good there the one that is greater in the first state in which they
  /// differ: it is the best one nearby.
  [[nodiscard]] std::size_t bestAt(const PlanSet& plans, const std::vector<double>& belief) const
  {
    std::size_t best = 0;
    double best_value = dot(plans.front().values, belief);
    for (std::size_t i = 1; i < plans.size(); ++i)
    {
      const double value = dot(plans[i].values, belief);
      const double difference = value - best_value;
      if (difference > kNegligible * scale_ ||
          (difference > -kNegligible * scale_ && plans[i].values > plans[best].values))
      {
        best = i;
        best_value = value;
      }
    }
    return best;
  }

  const Model* model_;
  const ExactLimits* limits_;
  Clock::time_point start_;
  double scale_ = 1e-300;    // of the values
  double negligible_ = 0.0;  // a vector that is nowhere better by more is left out
  double loss_ = 0.0;        // what pruning loses at most
};

}  // namespace

double startValue(const Model& model, const ExactSolution& solution)
{
  return startValue(model, solution.stages.back());
}

ExactSolution solveExactly(const Model& model, const ExactLimits& limits)
{
  if (!std::isfinite(limits.precision) || limits.precision <= 0.0 ||
      !std::isfinite(limits.time_s) || limits.time_s < 0.0)
  {
    throw InvalidArgument("precision " + std::to_string(limits.precision) + " and time " +
                          std::to_string(limits.time_s) +
                          " s, expected both finite, the first > 0 and the second >= 0");
  }
  if (limits.horizon == 0 && model.discount() >= 1.0)
  {
    throw InvalidArgument("discount 1 without a horizon, expected a discount below 1 or a horizon");
  }
  ValueIteration iteration(model, limits);
  return limits.horizon > 0 ? iteration.overHorizon() : iteration.forEver();
}

}  // namespace kr3::pomdp
