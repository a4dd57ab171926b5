#include "minimal_explanations.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "solved_history.hpp"

namespace kr3::reasoner
{

namespace
{

using Records = std::vector<CheckedRecord>;

constexpr std::size_t kMaxExplanations = 200;  // of a part, and put together

/// How a part may be explained, the others being explained in one way.
PartExplanations partExplanations(const HistoryProgram& program, const Records& records,
                                  int current_step, const Optimum& optimum, std::size_t part)
{
  const std::vector<Clingo::Symbol>& one = optimum.explanation;
  PartExplanations found;
  found.price = optimum.price.parts[part];
  std::vector<Clingo::Symbol> settled;
  SettledAssumptions open;
  for (const auto& [what, value] : *optimum.settled)
  {
    if (optimum.price.partOf(what) == part)
    {
      open.emplace(what, value);
      if (value == kTrueLiteral)
      {
        settled.push_back(what);
      }
    }
    else if (std::binary_search(one.begin(), one.end(), what))
    {
      open.emplace(what, kTrueLiteral);
    }
  }
  const auto is_open = [](const auto& item) { return item.second == PartialEvaluator::kOpen; };
  if (found.price.sum() == 0 || std::none_of(open.begin(), open.end(), is_open))
  {
    std::sort(settled.begin(), settled.end());
    found.alternatives.push_back(std::move(settled));
    return found;
  }
  Optimum of_part = optimum;
  of_part.settled = std::move(open);
  SolvedHistory solved(program, records, current_step, of_part,
                       {"0", "--project=project", "--warn=none"});
  std::vector<SolverLiteral> literals;
  for (const AssumedLiteral& assumption : solved.history->assumptions())
  {
    if (optimum.price.partOf(assumption.what) == part)
    {
      literals.push_back(assumption.literal);
    }
  }
  solved.forEachModel(literals, [&](const Clingo::Model& model) {
    found.complete = found.alternatives.size() < kMaxExplanations;
    if (found.complete)
    {
      std::vector<Clingo::Symbol> assumed = assumedIn(model, *solved.history);
      assumed.erase(
          std::remove_if(
              assumed.begin(), assumed.end(),
              [&](const Clingo::Symbol& what) { return optimum.price.partOf(what) != part; }),
          assumed.end());
      found.alternatives.push_back(std::move(assumed));
    }
    return found.complete;
  });
  std::sort(found.alternatives.begin(), found.alternatives.end());
  return found;
}

/// One alternative of each part, in all ways or in the first kMaxExplanations of them; and whether
/// there are no more.
std::pair<std::vector<std::vector<Clingo::Symbol>>, bool> putTogether(
    const std::vector<PartExplanations>& parts)
{
  std::vector<std::vector<Clingo::Symbol>> wholes = {{}};
  bool complete = true;
  for (const PartExplanations& part : parts)
  {
    complete = complete && part.complete;
    std::vector<std::vector<Clingo::Symbol>> longer;
    for (const auto& whole : wholes)
    {
      for (const auto& alternative : part.alternatives)
      {
        if (longer.size() == kMaxExplanations)
        {
          complete = false;
          break;
        }
        longer.push_back(whole);
        longer.back().insert(longer.back().end(), alternative.begin(), alternative.end());
      }
    }
    wholes = std::move(longer);
  }
  for (auto& whole : wholes)
  {
    std::sort(whole.begin(), whole.end());
  }
  std::sort(wholes.begin(), wholes.end());
  return {std::move(wholes), complete};
}

}  // namespace

MinimalExplanations explanationsOf(const HistoryProgram& program, const Records& records,
                                   int current_step, const Optimum& optimum)
{
  MinimalExplanations found;
  if (optimum.price.total().sum() == 0)
  {
    found.wholes = {{}};
    return found;
  }
  for (std::size_t i = 0; i < optimum.price.parts.size(); ++i)
  {
    PartExplanations part = partExplanations(program, records, current_step, optimum, i);
    if (part.price.sum() > 0)
    {
      found.parts.push_back(std::move(part));
    }
  }
  std::tie(found.wholes, found.complete) = putTogether(found.parts);
  return found;
}

}  // namespace kr3::reasoner
