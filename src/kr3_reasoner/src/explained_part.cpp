#include "explained_part.hpp"

#include <algorithm>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

/// A fluent whose rules can never apply is false by its definition, which can be cited: a rule that
/// never applies stands for them.
void keepDefinitions(const Description& whole, Description& part)
{
  const auto ruleFor = [](const std::string& fluent, const Description& description) {
    return std::find_if(
        description.constraints.begin(), description.constraints.end(),
        [&](const StateConstraint& rule) { return rule.head && rule.head->atom.name == fluent; });
  };
  for (const FluentDeclaration& fluent : part.fluents)
  {
    const auto rule = ruleFor(fluent.name, whole);
    if (fluent.kind != FluentKind::kDefined || rule == whole.constraints.end() ||
        ruleFor(fluent.name, part) != part.constraints.end())
    {
      continue;
    }
    StateConstraint never;
    never.position = rule->position;
    never.head = *rule->head;
    for (std::size_t i = 0; i < never.head->atom.arguments.size(); ++i)
    {
      never.head->atom.arguments[i] = {true, "X" + std::to_string(i)};
    }
    never.body.emplace_back(Comparison{{false, "0"}, Comparison::Operator::kEqual, {false, "1"}});
    part.constraints.push_back(std::move(never));
  }
}

Slice sliceFor(DomainKnowledge& whole, const std::vector<CheckedRecord>& records, int current_step,
               const std::vector<Literal>& about)
{
  Formula goal;
  goal.kind = Formula::Kind::kAnd;
  for (const Literal& literal : about)
  {
    goal.operands.emplace_back().literal = literal;
  }
  return Slicer(whole, records, current_step, goal).forGoal(std::nullopt, 0.0);
}

Description withDefinitions(const Description& whole, Description part)
{
  keepDefinitions(whole, part);
  return part;
}

bool same(const Record& a, const Record& b)
{
  return a.kind == b.kind && a.statement == b.statement && a.value == b.value && a.step == b.step &&
         a.confidence == b.confidence && a.source == b.source;
}

/// Where the records of a part stand in the whole; a part keeps their order.
std::vector<std::size_t> numbersOf(const std::vector<CheckedRecord>& part,
                                   const std::vector<CheckedRecord>& whole)
{
  std::vector<std::size_t> numbers;
  std::size_t next = 0;
  for (const CheckedRecord& checked : part)
  {
    while (next < whole.size() && !same(whole[next].record, checked.record))
    {
      ++next;
    }
    if (next == whole.size())
    {
      throw InternalError("a part of a history has a record that the history has not");
    }
    numbers.push_back(next++);
  }
  return numbers;
}

void renumber(Reason& reason, const std::vector<std::size_t>& numbers)
{
  if (reason.record != kNoRecord)
  {
    reason.record = numbers[reason.record];
  }
  for (Reason& child : reason.children)
  {
    renumber(child, numbers);
  }
}

bool isPartOf(const CitedLaw& part, const CitedLaw& whole)
{
  const SourcePosition& place = part.positions.front();
  return part.kind == whole.kind && part.about == whole.about &&
         std::any_of(whole.positions.begin(), whole.positions.end(),
                     [&](const SourcePosition& other) {
    return other.file == place.file && other.line == place.line && other.column == place.column;
         });
}

}  // namespace

ExplainedPart::ExplainedPart(DomainKnowledge& whole, const std::vector<CheckedRecord>& records,
                             int current_step, const std::vector<Literal>& about,
                             const SearchLimit& limit)
  : current_step_(current_step)
  , limit_(limit)
  , slice_(sliceFor(whole, records, current_step, about))
  , record_numbers_(numbersOf(slice_.records, records))
  , description_(withDefinitions(whole.description(), slice_.domain->description()))
  , program_(description_, whole.options())
  , instances_(description_)
{
  program_.limitTo(limit);
}

std::optional<Explanation> ExplainedPart::explain(const Literal& literal, int step,
                                                  const Laws& whole)
{
  if (!check_)
  {
    check_ = std::make_unique<HistoryCheck>(description_, program_, slice_.records, current_step_);
  }
  if (!check_->entail(check_->all(), literal, step))
  {
    return std::nullopt;
  }
  const Words words(description_, program_.options(), instances_, slice_.records);
  Explanation explanation = Explainer(description_, words, instances_, slice_.records,
                                      current_step_, limit_, check_.get())
                                .explain(literal, step);
  renumber(explanation.proof, record_numbers_);
  for (std::size_t& record : explanation.record_indices)
  {
    record = record_numbers_[record];
  }
  for (CitedLaw& law : explanation.laws)
  {
    for (std::size_t i = 0; i < whole.size(); ++i)
    {
      if (isPartOf(law, whole.law(i)))
      {
        law = whole.law(i);  // with all the rules of a definition
        break;
      }
    }
  }
  return explanation;
}

void ExplainedPart::justify(ExplanationAlternative& alternative,
                            const std::vector<Clingo::Symbol>& assumed,
                            const std::vector<bool>& known)
{
  const Words words(description_, program_.options(), instances_, slice_.records);
  Explainer(description_, words, instances_, slice_.records, current_step_, limit_, nullptr)
      .justify(alternative, assumed, known);
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    for (std::size_t& record : alternative.assumptions[i].because)
    {
      record = known[i] ? record : record_numbers_[record];
    }
  }
}

}  // namespace kr3::reasoner
