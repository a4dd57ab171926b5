#include "slice.hpp"

#include <algorithm>
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

/// The records after those that say the facts of a beginning.
std::vector<CheckedRecord> withFacts(const Beginning& beginning,
                                     const std::vector<CheckedRecord>& records)
{
  std::vector<CheckedRecord> all;
  for (const Literal& fact : beginning.facts)
  {
    CheckedRecord said;
    said.record.statement = toString(fact);
    said.record.step = beginning.first_step;
    said.literal = fact;
    all.push_back(std::move(said));
  }
  all.insert(all.end(), records.begin(), records.end());
  return all;
}

}  // namespace

Slicer::Slicer(DomainKnowledge& whole, const std::vector<CheckedRecord>& records, int current_step,
               const Formula& goal, std::shared_ptr<const Beginning> beginning)
  : whole_(whole)
  , rules_(whole.groundRules())
  , beginning_(std::move(beginning))
  , with_facts_(beginning_ ? withFacts(*beginning_, records) : std::vector<CheckedRecord>{})
  , records_(beginning_ ? with_facts_ : records)
  , current_step_(current_step)
  , goal_(goal)
  , relevance_(rules_, records_, current_step, Relevance::Purpose::kPlan, beginning_.get())
{
  relevance_.addGoal(goal);
  relevance_.close();
}

std::size_t Slicer::numFacts() const
{
  return beginning_ ? beginning_->facts.size() : 0;
}

/// Asks for all fluents over a share of the constants that do not matter; these constants.
std::vector<ConstantId> Slicer::addShare(Relevance& relevance, double share) const
{
  Cut cut(*this, relevance);
  cut.keepGoal(goal_);
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

Slice Slicer::cutFor(const Relevance& relevance, const std::vector<ConstantId>& extra,
                     std::optional<int> horizon) const
{
  Cut cut(*this, relevance);
  cut.keepGoal(goal_);
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

Slice Slicer::forGoal(std::optional<int> horizon, double extra_share) const
{
  if (extra_share <= 0.0)
  {
    return cutFor(relevance_, {}, horizon);
  }
  Relevance more(rules_, records_, current_step_, Relevance::Purpose::kPlan, beginning_.get());
  more.addGoal(goal_);
  more.close();
  const std::vector<ConstantId> extra = addShare(more, extra_share);
  return cutFor(more, extra, horizon);
}

std::optional<Slice> Slicer::forRest() const
{
  std::vector<std::size_t> left;
  for (std::size_t i = numFacts(); i < records_.size(); ++i)
  {
    if (!relevance_.concerns(i) && !relevance_.isPlainFact(i))
    {
      left.push_back(i);
    }
  }
  if (left.empty())
  {
    return std::nullopt;
  }
  Relevance rest(rules_, records_, current_step_, Relevance::Purpose::kExplain, beginning_.get());
  for (const std::size_t i : left)
  {
    rest.addRecord(i);
    for (std::size_t j = 0; records_[i].isAction() && j < records_.size(); ++j)
    {
      if (records_[j].isAction() && records_[j].record.step == records_[i].record.step)
      {
        rest.addRecord(j);  // they may exclude each other
      }
    }
  }
  rest.close();
  Cut cut(*this, rest);
  cut.close();
  return cut.take();
}

RelevantPart Slicer::report(int horizon) const
{
  const std::vector<Relevance::Item>& items = relevance_.items();
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
  const Slice slice = forGoal(horizon, 0.0);
  const std::set<std::string> spares(slice.spares.begin(), slice.spares.end());
  for (const Sort& sort : slice.domain->description().sorts)
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
  for (std::size_t i = slice.num_facts; i < slice.records.size(); ++i)
  {
    part.records.push_back(slice.records[i].record);
  }
  part.considered = slice.size;
  part.whole = wholeSize();
  return part;
}

}  // namespace kr3::reasoner
