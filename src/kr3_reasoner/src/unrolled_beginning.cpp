#include <algorithm>

#include "unrolled_history.hpp"

// The first state of a history that was progressed.
namespace kr3::reasoner
{

namespace
{

constexpr SolverLiteral kOpen = PartialEvaluator::kOpen;

}  // namespace

bool UnrolledHistory::agrees(const BeginningComponent& component,
                             const std::vector<std::size_t>& explanation) const
{
  for (std::size_t i = 0; i < component.assumptions.size(); ++i)
  {
    const SolverLiteral known = settled(component.assumptions[i].what);
    const bool assumed = std::binary_search(explanation.begin(), explanation.end(), i);
    if (assumed ? known == kFalseLiteral : known == kTrueLiteral)
    {
      return false;
    }
  }
  return true;
}

/// One row is chosen, and one of its explanations. What that assumes is paid for as any assumption.
void UnrolledHistory::addComponent(const BeginningComponent& component, StateLiterals& known,
                                   RuleSink& sink)
{
  struct Case
  {
    const BeginningRow* row;
    const std::vector<std::size_t>* explanation;
  };
  std::vector<Case> cases;
  for (const BeginningRow& row : component.rows)
  {
    for (const std::vector<std::size_t>& explanation : row.explanations)
    {
      if (agrees(component, explanation))
      {
        cases.push_back({&row, &explanation});
      }
    }
  }
  if (cases.empty())
  {
    sink.contradiction();
    return;
  }
  std::vector<SolverLiteral> chosen;
  for (std::size_t i = 0; i < cases.size(); ++i)
  {
    chosen.push_back(cases.size() == 1 ? kTrueLiteral : sink.newChoice());
  }
  if (cases.size() > 1)
  {
    sink.atLeastOne(chosen);
    sink.atMostOne(chosen);
  }
  for (std::size_t f = 0; f < component.fluents.size(); ++f)
  {
    const OpenFluent& fluent = component.fluents[f];
    const int number = dynamics_.fluentNumber(toSymbol(fluent.atom));
    std::vector<RuleSink::Body> having(fluent.values.size());
    for (std::size_t i = 0; i < cases.size(); ++i)
    {
      having[cases[i].row->values[f]].push_back(chosen[i]);
    }
    const auto first = dynamics_.firstValue(static_cast<std::size_t>(number));
    const auto& values = dynamics_.fluents()[static_cast<std::size_t>(number)].values;
    std::fill_n(known.begin() + static_cast<std::ptrdiff_t>(first), values.size(), kFalseLiteral);
    for (std::size_t v = 0; v < fluent.values.size(); ++v)
    {
      if (!having[v].empty())  // else it may be a value that a slice has left out
      {
        const int index = dynamics_.valueIndex(number, fluent.values[v]);
        known[static_cast<std::size_t>(index)] = sink.disjunction(having[v]);
      }
    }
  }
  std::vector<RuleSink::Body> assuming(component.assumptions.size());
  for (std::size_t i = 0; i < cases.size(); ++i)
  {
    for (const std::size_t assumed : *cases[i].explanation)
    {
      assuming[assumed].push_back(chosen[i]);
    }
  }
  for (std::size_t i = 0; i < assuming.size(); ++i)
  {
    const SolverLiteral literal = sink.disjunction(assuming[i]);
    if (literal != kFalseLiteral)
    {
      const CarriedAssumption& assumption = component.assumptions[i];
      assumptions_.push_back(
          {assumption.what, literal, assumption.price, assumption.is_retraction});
    }
  }
}

void UnrolledHistory::addBeginning(const Records& records, RuleSink& sink)
{
  const Beginning& beginning = *program_.beginning();
  const BeginningLevel& level = beginning.level(mode_.assumable);
  if (!level.consistent)
  {
    sink.contradiction();
  }
  StateLiterals known(dynamics_.numValues(), kOpen);
  const auto settle = [&](const Literal& literal) {
    const int number = dynamics_.fluentNumber(toSymbol(literal.atom));
    const int index = number < 0 ? -1 : dynamics_.valueIndex(number, literal.value.name);
    if (index < 0)
    {
      return;
    }
    const auto fluent = static_cast<std::size_t>(number);
    const auto begin = known.begin() + static_cast<std::ptrdiff_t>(dynamics_.firstValue(fluent));
    const auto end = begin + static_cast<std::ptrdiff_t>(dynamics_.fluents()[fluent].values.size());
    const bool open = std::all_of(begin, end, [](SolverLiteral value) { return value == kOpen; });
    if (open && dynamics_.fluents()[fluent].kind != FluentKind::kDefined && literal.equal)
    {
      std::fill(begin, end, kFalseLiteral);
      known[static_cast<std::size_t>(index)] = kTrueLiteral;
    }
  };
  for (const Literal& fact : beginning.facts)
  {
    settle(fact);
  }
  for (const BeginningComponent& component : level.components)
  {
    addComponent(component, known, sink);
  }
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    const bool certain = holds_[i] == kTrueLiteral && !records[i].isAction();
    if (certain && records[i].record.step == first_step_)
    {
      settle(records[i].literal);
    }
  }
  states_.push_back(dynamics_.initialState(known, sink));
}

}  // namespace kr3::reasoner
