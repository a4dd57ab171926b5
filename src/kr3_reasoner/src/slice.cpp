#include "slice.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_set>
#include <utility>

#include "slice_cut.hpp"

namespace kr3::reasoner
{

namespace
{

bool isNumeric(const std::string& name)
{
  return name.find_first_not_of("-0123456789") == std::string::npos;
}

}  // namespace

ProblemSize sizeOf(const Description& description, std::size_t num_records)
{
  ProblemSize size;
  std::unordered_set<std::string> constants;
  std::map<std::string, std::size_t> elements;
  for (const Sort& sort : description.sorts)
  {
    constants.insert(sort.elements.begin(), sort.elements.end());
    elements[sort.name] = sort.elements.size();
  }
  const auto count = [&](const std::vector<std::string>& sorts) {
    std::size_t product = 1;
    for (const std::string& sort : sorts)
    {
      product *= elements[sort];
    }
    return product;
  };
  for (const FluentDeclaration& fluent : description.fluents)
  {
    size.fluents += fluent.kind == FluentKind::kStatic ? 0 : count(fluent.argument_sorts);
  }
  for (const ActionDeclaration& action : description.actions)
  {
    size.actions += action.exogenous ? 0 : count(action.argument_sorts);
  }
  size.constants = constants.size();
  size.records = num_records;
  return size;
}

Slicer::Slicer(const GroundRules& rules, const std::vector<CheckedRecord>& records,
               int current_step)
  : rules_(rules), records_(records), current_step_(current_step)
{
}

Relevance Slicer::relevanceOf(const Formula& goal) const
{
  Relevance relevance(rules_, records_, current_step_, Relevance::Purpose::kPlan);
  relevance.addGoal(goal);
  relevance.close();
  return relevance;
}

/// Asks for all fluents over a share of the constants that do not matter; these constants.
std::vector<ConstantId> Slicer::addShare(Relevance& relevance, const Formula& goal,
                                         double share) const
{
  Cut cut(*this, relevance);
  cut.keepGoal(goal);
  cut.close();
  static_cast<void>(cut.leaveOutAlike(1));
  std::vector<bool> extra(rules_.numConstants(), false);
  std::vector<ConstantId> added;
  double due = 0.0;
  for (std::size_t i = 0; i < extra.size(); ++i)
  {
    const auto constant = static_cast<ConstantId>(i);
    if (!cut.keeps(constant) && !isNumeric(rules_.name(constant)))
    {
      due += share;
      extra[i] = due >= 1.0;
      due -= extra[i] ? 1.0 : 0.0;
      if (extra[i])
      {
        added.push_back(constant);
      }
    }
  }
  const Description& description = rules_.description();
  for (std::size_t symbol = 0; symbol < description.fluents.size(); ++symbol)
  {
    const FluentDeclaration& fluent = description.fluents[symbol];
    if (fluent.kind == FluentKind::kStatic)
    {
      continue;
    }
    GroundAtom atom{static_cast<int>(symbol), {}};
    const std::function<void(bool)> extend = [&](bool has_extra) {
      const std::size_t position = atom.arguments.size();
      if (position == fluent.argument_sorts.size())
      {
        if (has_extra)
        {
          relevance.addFluent(atom, {-1, "a share of what does not matter was asked for"});
        }
        return;
      }
      for (const ConstantId element :
           rules_.elements(rules_.sortIndex(fluent.argument_sorts[position])))
      {
        if (extra[element] || cut.keeps(element))
        {
          atom.arguments.push_back(element);
          extend(has_extra || extra[element]);
          atom.arguments.pop_back();
        }
      }
    };
    extend(false);
  }
  relevance.close();
  return added;
}

Slice Slicer::forGoal(const Formula& goal, std::optional<int> horizon, double extra_share) const
{
  Relevance relevance = relevanceOf(goal);
  std::vector<ConstantId> extra;
  if (extra_share > 0.0)
  {
    extra = addShare(relevance, goal, extra_share);
  }
  Cut cut(*this, relevance);
  cut.keepGoal(goal);
  for (const ConstantId constant : extra)
  {
    cut.need(constant);
  }
  cut.close();
  std::vector<std::string> spares;
  if (horizon)
  {
    spares = cut.leaveOutAlike(*horizon);
  }
  Slice slice = cut.take();
  slice.spares = std::move(spares);
  return slice;
}

std::optional<Slice> Slicer::forRest(const Formula& goal) const
{
  const Relevance relevance = relevanceOf(goal);
  Relevance rest(rules_, records_, current_step_, Relevance::Purpose::kExplain);
  bool any = false;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (!relevance.concerns(i) && !relevance.isPlainFact(i))
    {
      rest.addRecord(i);
      for (std::size_t j = 0; records_[i].isAction() && j < records_.size(); ++j)
      {
        if (records_[j].isAction() && records_[j].record.step == records_[i].record.step)
        {
          rest.addRecord(j);  // they may exclude each other
        }
      }
      any = true;
    }
  }
  if (!any)
  {
    return std::nullopt;
  }
  rest.close();
  Cut cut(*this, rest);
  cut.close();
  return cut.take();
}

RelevantPart Slicer::report(const Formula& goal, int horizon) const
{
  const Relevance relevance = relevanceOf(goal);
  const std::vector<Relevance::Item>& items = relevance.items();
  const auto text = [this](const Relevance::Item& item) {
    return item.is_action ? rules_.actionText(item.atom) : rules_.fluentText(item.atom);
  };
  const auto why = [&](std::size_t number) {
    std::vector<std::string> chain;
    for (int i = static_cast<int>(number); i >= 0; i = items[i].origin.from)
    {
      chain.push_back(text(items[i]) + ": " + items[i].origin.because);
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  };
  RelevantPart part;
  std::unordered_set<std::string> explained;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    (items[i].is_action ? part.actions : part.fluents).push_back({text(items[i]), why(i)});
    for (const ConstantId argument : items[i].atom.arguments)
    {
      if (argument != kUnbound && explained.insert(rules_.name(argument)).second)
      {
        part.constants.push_back({rules_.name(argument), why(i)});
        part.constants.back().why.push_back(rules_.name(argument) + ": an argument of " +
                                            text(items[i]));
      }
    }
  }
  const Slice slice = forGoal(goal, horizon, 0.0);
  const std::set<std::string> spares(slice.spares.begin(), slice.spares.end());
  for (const Sort& sort : slice.description.sorts)
  {
    for (const std::string& element : sort.elements)
    {
      if (explained.insert(element).second)
      {
        part.constants.push_back(
            {element,
             {element + (spares.count(element) > 0
                             ? ": stands for others like it, which nothing tells apart"
                             : ": what is relevant can have it as its value or argument")}});
      }
    }
  }
  for (const CheckedRecord& checked : slice.records)
  {
    part.records.push_back(checked.record);
  }
  part.considered = slice.size;
  part.whole = wholeSize();
  return part;
}

ProblemSize Slicer::wholeSize() const
{
  return sizeOf(rules_.description(), records_.size());
}

}  // namespace kr3::reasoner
