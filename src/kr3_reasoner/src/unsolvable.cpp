#include "unsolvable.hpp"

#include <algorithm>
#include <set>
#include <unordered_set>

#include "formula_rules.hpp"
#include "ground_fluents.hpp"
#include "relaxed_reach.hpp"

namespace kr3::reasoner
{

namespace
{

const char* const kAsking = "asking why there is no plan";

/// The parts of a goal all of which have to hold.
void flatten(const Formula& goal, std::vector<Formula>& conjuncts)
{
  if (goal.kind != Formula::Kind::kAnd)
  {
    conjuncts.push_back(goal);
    return;
  }
  for (const Formula& operand : goal.operands)
  {
    flatten(operand, conjuncts);
  }
}

/// Whether some state that satisfies these constraints satisfies these formulas.
bool isPossible(const Description& description, const std::vector<Formula>& conjuncts)
{
  Solver solver({"1", "--warn=none"});
  const Encoding encoding(description);
  solver.add("base", {}, encoding.signature() + Encoding::anyState());
  solver.add("state", {"_t"}, encoding.state());
  Formula goal;
  goal.kind = Formula::Kind::kAnd;
  goal.operands = conjuncts;
  std::string rules = ":- not wanted(n).\n";
  rules += conjuncts.empty() ? "wanted(n).\n" : formulaRules(goal, description, "wanted(n)");
  solver.add("goal", {"n"}, rules);
  solver.ground({{"base", {}}, {"state", {0}}, {"goal", {0}}});
  return solver.control().solve().get().is_satisfiable();
}

/// Leaves out, one after the other, what is not needed for `is_impossible`.
template <typename Item, typename Test>
void minimize(std::vector<Item>& items, const Test& is_impossible)
{
  for (std::size_t i = 0; i < items.size();)
  {
    const Item item = items[i];
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
    if (!is_impossible())
    {
      items.insert(items.begin() + static_cast<std::ptrdiff_t>(i), item);
      ++i;
    }
  }
}

std::string joined(const std::vector<Formula>& formulas, const Description& description)
{
  std::string text;
  for (const Formula& formula : formulas)
  {
    text += (text.empty() ? "" : " and ") + toString(formula, description);
  }
  return text;
}

/// A state constraint as it would be written.
std::string textOf(const StateConstraint& constraint, const Description& description)
{
  Description alone;
  alone.sorts = description.sorts;
  alone.fluents = description.fluents;
  const std::string without = toString(alone);
  alone.constraints = {constraint};
  std::string text = toString(alone).substr(without.size());
  const std::size_t end = text.find_last_not_of(" \n.");
  text.erase(end == std::string::npos ? 0 : end + 1);
  const std::size_t start = text.find_last_of('\n');
  text = start == std::string::npos ? text : text.substr(start + 1);
  text.erase(0, text.find_first_not_of(' '));
  return text;
}

std::string whyImpossible(const Description& whole, std::vector<Formula> conjuncts,
                          const SearchLimit& limit)
{
  Description description = whole;
  const auto is_impossible = [&] {
    limit.check(kAsking);
    return !isPossible(description, conjuncts);
  };
  minimize(conjuncts, is_impossible);
  minimize(description.constraints, is_impossible);
  if (conjuncts.empty())
  {
    return "no state satisfies the state constraints";
  }
  std::string text = "no state of the domain satisfies the goal: " + joined(conjuncts, whole) +
                     (conjuncts.size() > 1 ? " exclude each other" : " never holds");
  const char* separator = " because of the state constraint ";
  for (const StateConstraint& constraint : description.constraints)
  {
    text += separator + ("'" + textOf(constraint, whole)) + "'";
    if (constraint.position.line > 0)
    {
      text +=
          " (" + constraint.position.file + ":" + std::to_string(constraint.position.line) + ")";
    }
    separator = " and ";
  }
  return text;
}

}  // namespace

std::string whyUnsolvable(const PlanningProblem& problem, const Formula& goal, int max_horizon,
                          const std::string& unverified, const SearchLimit& limit)
{
  std::vector<Formula> conjuncts;
  flatten(goal, conjuncts);
  limit.check(kAsking);
  if (!isPossible(problem.description, conjuncts))
  {
    return whyImpossible(problem.description, conjuncts, limit);
  }
  const RelaxedReach reach(problem);
  for (const Formula& conjunct : conjuncts)
  {
    if (const auto why = reach.whyUnreachable(conjunct))
    {
      return *why;
    }
  }
  return "no plan of at most " + std::to_string(max_horizon) + " steps reaches the goal " +
         toString(goal, problem.description) + (unverified.empty() ? "" : "; " + unverified);
}

}  // namespace kr3::reasoner
