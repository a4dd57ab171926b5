#include "relevant_planner.hpp"

#include <algorithm>
#include <ctime>
#include <memory>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "models.hpp"
#include "planner.hpp"

namespace kr3::reasoner
{

namespace
{

using Clock = std::chrono::steady_clock;

std::string conflictText(const HistoryProgram& program, const std::vector<CheckedRecord>& records,
                         std::size_t num_facts, int current_step)
{
  std::string text = "the history is inconsistent: ";
  const char* separator = "";
  for (const std::size_t i : minimalConflict(program, records, current_step))
  {
    if (i < num_facts)
    {
      continue;  // known from records that are no longer kept
    }
    text += separator + toString(records[i].record);
    separator = "; ";
  }
  return text;
}

}  // namespace

void checkPlanOptions(const PlanOptions& options)
{
  if (options.max_horizon < 1)
  {
    throw InvalidArgument("found max_horizon " + std::to_string(options.max_horizon) +
                          ", expected at least 1");
  }
  if (options.max_plans < 1)
  {
    throw InvalidArgument("found max_plans " + std::to_string(options.max_plans) +
                          ", expected at least 1");
  }
  if (!(options.extra_share >= 0.0 && options.extra_share <= 1.0))
  {
    throw InvalidArgument("found extra_share " + std::to_string(options.extra_share) +
                          ", expected one in [0, 1]");
  }
}

/// A slice with its history explained; without an optimum the history is inconsistent.
struct RelevantPlanner::Explained
{
  Explained(Slice part, const SearchLimit& limit)
    : slice(std::move(part)), program(slice.domain->program().beginningAt(slice.beginning))
  {
    slice.domain->limitTo(limit);
  }

  Slice slice;
  HistoryProgram program;
  std::optional<Optimum> optimum;
  std::unique_ptr<Consequences> consequences;
  std::string conflict;
};

RelevantPlanner::RelevantPlanner(DomainKnowledge& whole, const std::vector<CheckedRecord>& records,
                                 int current_step, const Formula& goal,
                                 std::shared_ptr<const Beginning> beginning)
  : records_(records)
  , current_step_(current_step)
  , options_(whole.options())
  , goal_(goal)
  , slicer_(whole, records, current_step, goal, std::move(beginning))
{
}

RelevantPlanner::Explained RelevantPlanner::explain(Slice slice, const Explained* rest,
                                                    const SearchLimit& limit) const
{
  Explained explained(std::move(slice), limit);
  ExplanationStart start;
  start.uncertain = std::any_of(records_.begin(), records_.end(), [](const CheckedRecord& checked) {
    return !checked.isAction() && checked.record.confidence < 1.0;
  });
  const auto optimumOf = [&](const Explained& part) {
    return findOptimum(part.program, part.slice.records, current_step_, options_.diagnose_exogenous,
                       start);
  };
  for (;;)
  {
    explained.optimum = optimumOf(explained);
    if (!explained.optimum)
    {
      explained.conflict = conflictText(explained.program, explained.slice.records,
                                        explained.slice.num_facts, current_step_);
      return explained;
    }
    start.level = explained.optimum->level;
    if (!rest)
    {
      break;
    }
    const std::optional<Optimum> other = optimumOf(*rest);
    if (!other)
    {
      explained.optimum.reset();
      explained.conflict =
          conflictText(rest->program, rest->slice.records, rest->slice.num_facts, current_step_);
      return explained;
    }
    if (other->level == start.level)
    {
      break;
    }
    start.level = other->level;
  }
  explained.consequences =
      std::make_unique<Consequences>(explained.slice.domain->description(), explained.program,
                                     explained.slice.records, current_step_, *explained.optimum);
  return explained;
}

/// Whether a relevant fluent can have a value that stands for others like it.
bool RelevantPlanner::mayBeSpare(const Explained& explained) const
{
  const Description& description = explained.slice.domain->description();
  const std::set<std::string> spares(explained.slice.spares.begin(), explained.slice.spares.end());
  return std::any_of(explained.slice.relevant.begin(), explained.slice.relevant.end(),
                     [&](Literal literal) {
    const FluentDeclaration& fluent = *description.findFluent(literal.atom.name);
    if (!fluent.value_sort)
    {
      return false;
    }
    const auto& values = description.findSort(*fluent.value_sort)->elements;
    return std::any_of(values.begin(), values.end(), [&](const std::string& value) {
      literal.value.name = value;
      return spares.count(value) > 0 && explained.consequences->inSome(literal, current_step_);
    });
  });
}

PlanResult RelevantPlanner::plan(const PlanOptions& options, const std::atomic<bool>* cancel) const
{
  const std::clock_t start = std::clock();
  const Clock::time_point deadline = Clock::now() + options.time_limit;
  const auto finish = [&](PlanResult result, const Slice& slice, int widened) {
    result.considered = slice.size;
    result.whole = slicer_.wholeSize();
    result.widened = widened;
    result.cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    return result;
  };
  // The plans of a hypothesis that only differ in constants that are alike are wanted too, and so
  // is the cheapest plan of any length.
  const bool alike_matters = options.all || options.preference == PlanPreference::kCheapest;
  int horizon = alike_matters ? options.max_horizon : std::min(kFirstHorizon, options.max_horizon);
  bool leave_out = !options.all;
  const SearchLimit limit{deadline, cancel};
  std::optional<Explained> rest;
  if (std::optional<Slice> slice = slicer_.forRest())
  {
    rest.emplace(std::move(*slice), limit);
  }
  for (int widened = 0;; ++widened)
  {
    const Explained explained =
        explain(slicer_.forGoal(leave_out ? std::optional<int>(horizon) : std::nullopt,
                                options.extra_share),
                rest ? &*rest : nullptr, limit);
    const Slice& slice = explained.slice;
    if (!explained.optimum)
    {
      PlanResult result;
      result.reason = explained.conflict;
      return finish(std::move(result), slice, widened);
    }
    if (!slice.spares.empty() && mayBeSpare(explained))
    {
      leave_out = false;
      continue;
    }
    PlanOptions limited = options;
    limited.max_horizon = slice.spares.empty() ? options.max_horizon : horizon;
    limited.time_limit =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    const Planner planner(*slice.domain, explained.program, slice.records, current_step_,
                          *explained.optimum, *explained.consequences);
    PlanResult result = planner.plan(goal_, limited, cancel);
    if (result.goal_entailed || result.covers_all || limited.max_horizon == options.max_horizon)
    {
      return finish(std::move(result), slice, widened);
    }
    horizon = options.max_horizon;
  }
}

}  // namespace kr3::reasoner
