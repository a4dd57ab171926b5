#include "kr3_refinement/sensitivity.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/policy.hpp>

#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

std::string number(double value, int digits)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

/// What a plan earns where the belief is true; it must give no mass to states that the plan was not
/// made for.
double valueOf(const pomdp::AlphaVector& plan, const pomdp::Belief& belief)
{
  double value = 0.0;
  for (std::size_t i = 0; i < plan.values.size(); ++i)
  {
    value += plan.values[i] * belief[plan.states.empty() ? i : plan.states[i]];
  }
  return value;
}

/// The plan that a policy follows from a model's initial belief on.
pomdp::AlphaVector planFor(const pomdp::Model& model, const pomdp::Policy& policy)
{
  const pomdp::Belief& start = model.initialBelief();
  const double best = policy.valueAt(start);
  std::vector<pomdp::AlphaVector> plans = policy.alphaVectors();
  const auto covers = [&](const pomdp::AlphaVector& plan) {
    double mass = plan.states.empty() ? 1.0 : 0.0;
    for (const std::uint32_t state : plan.states)
    {
      mass += start[state];
    }
    return mass > 1.0 - 1e-9;
  };
  return *std::min_element(plans.begin(), plans.end(), [&](const auto& a, const auto& b) {
    const auto loss = [&](const pomdp::AlphaVector& plan) {
      return covers(plan) ? best - valueOf(plan, start) : std::numeric_limits<double>::infinity();
    };
    return loss(a) < loss(b);
  });
}

/// The task from other beliefs about one fluent.
class Variation
{
public:
  Variation(const PomdpTask& task, std::size_t fluent, const SensitivityOptions& options)
    : task_(task)
    , fluent_(fluent)
    , options_(options)
    , nominal_(planFor(task.model(), pomdp::solve(task.model(), options.limits).policy))
  {
    for (std::size_t state = 0; state < task.boundaryState(); ++state)
    {
      const double probability = task.model().initialBelief()[state];
      mass_[valueIn(state)] += probability;
    }
  }

  /// Mass of each value in the task, without those that have none.
  [[nodiscard]] const Distribution& mass() const { return mass_; }

  [[nodiscard]] double inside() const
  {
    double total = 0.0;
    for (const auto& [value, probability] : mass_)
    {
      total += value == kElsewhere ? 0.0 : probability;
    }
    return total;
  }

  /// @param value  that is certain inside the zoom; empty: spread as in the task
  [[nodiscard]] SensitivityPoint at(double probability, const std::string& value) const
  {
    const auto certain = mass_.find(value);
    const double own_inside = certain == mass_.end() ? inside() : certain->second;
    std::vector<double> belief = task_.model().initialBelief().probabilities();
    for (std::size_t state = 0; state < task_.boundaryState(); ++state)
    {
      const std::string& own = valueIn(state);
      const bool counts = value.empty() || own == value;
      if (own == kElsewhere)
      {
        belief[state] *= probability < 1.0 ? (1.0 - probability) / mass_.at(kElsewhere) : 0.0;
      }
      else
      {
        belief[state] *= counts ? probability / own_inside : 0.0;
      }
    }
    const pomdp::Model model = task_.model().withInitialBelief(pomdp::Belief(std::move(belief)));
    const pomdp::SolveResult solved = pomdp::solve(model, options_.limits);
    return {value,
            probability,
            solved.lower,
            solved.upper,
            solved.policy.actionAt(model.initialBelief()),
            valueOf(nominal_, model.initialBelief())};
  }

  /// Narrows down where the first action becomes one of another kind.
  [[nodiscard]] FirstActionChange change(SensitivityPoint below, SensitivityPoint above) const
  {
    for (int i = 0; i < options_.bisections; ++i)
    {
      SensitivityPoint between = at((below.probability + above.probability) / 2.0, "");
      (sameKind(below, between) ? below : above) = std::move(between);
    }
    return {below.probability, above.probability, below.first_action, above.first_action};
  }

  /// Cells that nothing tells apart may take each other's place, so only the action's name counts.
  [[nodiscard]] bool sameKind(const SensitivityPoint& one, const SensitivityPoint& other) const
  {
    return task_.actionSymbol(one.first_action) == task_.actionSymbol(other.first_action);
  }

private:
  [[nodiscard]] const std::string& valueIn(std::size_t state) const
  {
    const auto value = static_cast<std::size_t>(task_.physicalState(state)[fluent_]);
    return task_.fluents()[fluent_].values[value];
  }

  const PomdpTask& task_;
  std::size_t fluent_;
  const SensitivityOptions& options_;
  pomdp::AlphaVector nominal_;
  Distribution mass_;
};

void addRows(const std::vector<SensitivityPoint>& points, const PomdpTask& task, std::string& text)
{
  for (const SensitivityPoint& point : points)
  {
    text += "  " + (point.start.empty() ? number(point.probability, 3) : point.start) + "  " +
            number(point.lower, 2) + " .. " + number(point.upper, 2) + "  " +
            number(point.nominal_policy, 2) + "  " + task.actionText(point.first_action) + "\n";
  }
}

}  // namespace

SensitivityReport sensitivity(const PomdpTask& task, const std::string& fluent,
                              const SensitivityOptions& options)
{
  const std::string name = normalised(fluent);
  const auto found =
      std::find_if(task.fluents().begin(), task.fluents().end(),
                   [&](const reasoner::GroundFluent& candidate) { return candidate.name == name; });
  if (found == task.fluents().end())
  {
    throw NotFound("the task has no fluent '" + fluent + "'");
  }
  const bool good_masses = std::all_of(options.masses.begin(), options.masses.end(),
                                       [](double mass) { return mass >= 0.0 && mass <= 1.0; });
  if (!good_masses || options.bisections < 0)
  {
    throw InvalidArgument("sensitivity: expected masses in [0, 1] and bisections from 0 on");
  }
  const Variation variation(task, static_cast<std::size_t>(found - task.fluents().begin()),
                            options);
  SensitivityReport report{name, variation.inside(), {}, {}, {}};
  std::vector<std::string> values;
  for (const auto& [value, probability] : variation.mass())
  {
    if (probability > 0.0 && value != kElsewhere)
    {
      values.push_back(value);
    }
  }
  const auto elsewhere = variation.mass().find(kElsewhere);
  const bool has_elsewhere = elsewhere != variation.mass().end() && elsewhere->second > 0.0;
  if (values.size() + (has_elsewhere ? 1U : 0U) < 2)
  {
    throw FailedPrecondition("'" + name + "' is known at the start, so nothing rests on a belief");
  }
  std::vector<double> masses = options.masses;
  std::sort(masses.begin(), masses.end());
  for (const double mass : has_elsewhere && !values.empty() ? masses : std::vector<double>{})
  {
    report.by_mass.push_back(variation.at(mass, ""));
  }
  for (std::size_t i = 1; i < report.by_mass.size(); ++i)
  {
    if (!variation.sameKind(report.by_mass[i - 1], report.by_mass[i]))
    {
      report.changes.push_back(variation.change(report.by_mass[i - 1], report.by_mass[i]));
    }
  }
  for (const std::string& value : values)
  {
    report.by_value.push_back(variation.at(report.nominal, value));
  }
  return report;
}

std::string SensitivityReport::text(const PomdpTask& task) const
{
  std::string text = "Sensitivity to the start: " + fluent + " is inside the zoom with " +
                     number(nominal, 3) + "\n";
  const std::string columns =
      "  value (bounds)  policy for the start as given (at least)  first action\n";
  if (!by_mass.empty())
  {
    text += " inside" + columns;
    addRows(by_mass, task, text);
    for (const FirstActionChange& change : changes)
    {
      text += "  between " + number(change.below, 3) + " and " + number(change.above, 3) + ": " +
              task.actionText(change.from) + " becomes " + task.actionText(change.to) + "\n";
    }
    text += changes.empty() ? "  the first action stays of one kind\n" : "";
  }
  text += " all of it at" + columns;
  addRows(by_value, task, text);
  return text;
}

}  // namespace kr3::refinement
