#include "join.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace kr3::reasoner
{

namespace
{

bool isBound(const Slot& slot, const std::vector<bool>& variables)
{
  return !slot.is_variable || variables[static_cast<std::size_t>(slot.id)];
}

bool isBound(const LiteralPattern& literal, const std::vector<bool>& variables)
{
  return isBound(literal.value, variables) &&
         std::all_of(literal.arguments.begin(), literal.arguments.end(),
                     [&](const Slot& slot) { return isBound(slot, variables); });
}

bool isNegative(const LiteralPattern& literal, const Vocabulary& vocabulary)
{
  return !literal.equal ||
         (literal.value.id == Vocabulary::kFalse && !vocabulary.fluent(literal.symbol).value_sort);
}

const Slot& slotOf(const LiteralPattern& literal, std::size_t column)
{
  return column < literal.arguments.size() ? literal.arguments[column] : literal.value;
}

}  // namespace

Join::Join(const Conditions& conditions, const Statics& statics, const std::vector<bool>& given,
           const std::vector<bool>& wanted, const SearchLimit& limit)
  : conditions_(conditions), statics_(statics), limit_(limit), given_(given)
{
  std::vector<bool> bound = given;
  std::vector<bool> checked_statics(conditions.statics.size(), false);
  std::vector<bool> checked_relations(conditions.relations.size(), false);
  std::vector<bool> checked_sorts(conditions.sort_tests.size(), false);
  for (std::size_t v = 0; v < wanted.size(); ++v)
  {
    if (wanted[v])
    {
      wanted_.push_back(v);
    }
  }
  addChecks(start_, bound, checked_statics, checked_relations, checked_sorts);
  bool unwanted_before = false;
  while (std::find(bound.begin(), bound.end(), false) != bound.end())
  {
    Level level = cheapest(bound, wanted);
    bool binds_wanted = false;
    bool binds_unwanted = false;
    for (const int variable : level.binds)
    {
      const auto v = static_cast<std::size_t>(variable);
      bound[v] = true;
      (wanted[v] ? binds_wanted : binds_unwanted) = true;
    }
    unwanted_before = unwanted_before || binds_unwanted;
    if (level.source >= 0)
    {
      checked_statics[static_cast<std::size_t>(level.source)] = true;
    }
    addChecks(level, bound, checked_statics, checked_relations, checked_sorts);
    levels_.push_back(std::move(level));
    if (binds_wanted)
    {
      last_wanted_ = levels_.size();
      may_repeat_ = unwanted_before;
    }
  }
}

/// The cheapest way to bind another variable: few candidates; of equal ones, what is wanted first.
Join::Level Join::cheapest(const std::vector<bool>& bound, const std::vector<bool>& wanted) const
{
  Level best;
  double least = std::numeric_limits<double>::max();
  const Vocabulary& vocabulary = statics_.vocabulary();
  for (std::size_t v = 0; v < bound.size(); ++v)
  {
    if (bound[v])
    {
      continue;
    }
    const std::vector<int>& sorts = conditions_.variable_sorts[v];
    assert(!sorts.empty() && "the checks of the language refuse a variable without a sort");
    const int sort = *std::min_element(sorts.begin(), sorts.end(), [&](int a, int b) {
      return vocabulary.elements(a).size() < vocabulary.elements(b).size();
    });
    const double cost =
        static_cast<double>(vocabulary.elements(sort).size()) + (wanted[v] ? 0.0 : 0.5);
    if (cost < least)
    {
      least = cost;
      best = Level{};
      best.variable = static_cast<int>(v);
      best.sort = sort;
      best.binds = {static_cast<int>(v)};
    }
  }
  for (std::size_t s = 0; s < conditions_.statics.size(); ++s)
  {
    const LiteralPattern& literal = conditions_.statics[s];
    if (isNegative(literal, vocabulary) || isBound(literal, bound))
    {
      continue;
    }
    Level level;
    level.source = static_cast<int>(s);
    level.column = kNoColumn;
    auto cost = static_cast<double>(statics_.numRows(literal.symbol));
    for (std::size_t column = 0; column <= literal.arguments.size(); ++column)
    {
      const Slot& slot = slotOf(literal, column);
      if (!isBound(slot, bound))
      {
        if (std::find(level.binds.begin(), level.binds.end(), slot.id) == level.binds.end())
        {
          level.binds.push_back(slot.id);
        }
        continue;
      }
      const double here = statics_.rowsPerConstant(literal.symbol, column);
      if (level.column == kNoColumn || here < cost)
      {
        cost = here;
        level.column = column;
      }
    }
    if (cost < least)
    {
      least = cost;
      best = std::move(level);
    }
  }
  return best;
}

/// What can be decided as soon as these variables are bound, and was not before.
void Join::addChecks(Level& level, const std::vector<bool>& bound,
                     std::vector<bool>& checked_statics, std::vector<bool>& checked_relations,
                     std::vector<bool>& checked_sorts) const
{
  for (std::size_t i = 0; i < conditions_.statics.size(); ++i)
  {
    if (!checked_statics[i] && isBound(conditions_.statics[i], bound))
    {
      checked_statics[i] = true;
      level.statics.push_back(i);
    }
  }
  for (std::size_t i = 0; i < conditions_.relations.size(); ++i)
  {
    const Conditions::Relation& relation = conditions_.relations[i];
    if (!checked_relations[i] && isBound(relation.left, bound) && isBound(relation.right, bound))
    {
      checked_relations[i] = true;
      level.relations.push_back(i);
    }
  }
  for (std::size_t i = 0; i < conditions_.sort_tests.size(); ++i)
  {
    if (!checked_sorts[i] && isBound(conditions_.sort_tests[i].term, bound))
    {
      checked_sorts[i] = true;
      level.sort_tests.push_back(i);
    }
  }
}

bool Join::fitsSorts(int variable) const
{
  const auto v = static_cast<std::size_t>(variable);
  const std::vector<int>& sorts = conditions_.variable_sorts[v];
  return std::all_of(sorts.begin(), sorts.end(),
                     [&](int sort) { return statics_.vocabulary().inSort(binding_[v], sort); });
}

bool Join::passes(const Level& level) const
{
  const Vocabulary& vocabulary = statics_.vocabulary();
  for (const std::size_t i : level.relations)
  {
    const Conditions::Relation& relation = conditions_.relations[i];
    if (!vocabulary.holds(bound(relation.left, binding_), relation.op,
                          bound(relation.right, binding_)))
    {
      return false;
    }
  }
  for (const std::size_t i : level.sort_tests)
  {
    const Conditions::SortTest& test = conditions_.sort_tests[i];
    if (vocabulary.inSort(bound(test.term, binding_), test.sort) == test.negated)
    {
      return false;
    }
  }
  return std::all_of(level.statics.begin(), level.statics.end(), [&](std::size_t i) {
    return statics_.holds(conditions_.statics[i], binding_);
  });
}

void Join::forEach(const RuleBinding& start, const std::function<void(const RuleBinding&)>& visit)
{
  binding_ = start;
  visit_ = &visit;
  seen_.clear();
  for (std::size_t v = 0; v < given_.size(); ++v)
  {
    if (given_[v] && !fitsSorts(static_cast<int>(v)))
    {
      return;
    }
  }
  if (passes(start_))
  {
    run(0);
  }
}

/// Binds the variables of the levels from this one on. Past what is wanted, one solution is enough.
/// @return whether there was a solution
bool Join::run(std::size_t number)
{
  constexpr std::uint32_t kBetweenChecks = 4096;
  if (++num_looks_ % kBetweenChecks == 0)
  {
    limit_.check();
  }
  if (number == levels_.size())
  {
    found();
    return true;
  }
  const Level& level = levels_[number];
  const bool one_is_enough = number >= last_wanted_;
  bool any = false;
  if (level.source < 0)
  {
    const auto v = static_cast<std::size_t>(level.variable);
    for (const ConstantId element : statics_.vocabulary().elements(level.sort))
    {
      binding_[v] = element;
      if (fitsSorts(level.variable) && passes(level) && run(number + 1))
      {
        any = true;
        if (one_is_enough)
        {
          break;
        }
      }
    }
    binding_[v] = kUnbound;
    return any;
  }
  const LiteralPattern& literal = conditions_.statics[static_cast<std::size_t>(level.source)];
  const auto tryRow = [&](const std::vector<ConstantId>& row) {
    for (const int variable : level.binds)
    {
      binding_[static_cast<std::size_t>(variable)] = kUnbound;
    }
    return bindRow(literal, row, level) && passes(level) && run(number + 1);
  };
  if (level.column == kNoColumn)
  {
    for (std::size_t r = 0; r < statics_.numRows(literal.symbol) && !(any && one_is_enough); ++r)
    {
      any = tryRow(statics_.row(literal.symbol, static_cast<std::uint32_t>(r))) || any;
    }
  }
  else
  {
    const ConstantId key = bound(slotOf(literal, level.column), binding_);
    for (const std::uint32_t r : statics_.rowsWith(literal.symbol, level.column, key))
    {
      any = tryRow(statics_.row(literal.symbol, r)) || any;
      if (any && one_is_enough)
      {
        break;
      }
    }
  }
  for (const int variable : level.binds)
  {
    binding_[static_cast<std::size_t>(variable)] = kUnbound;
  }
  return any;
}

bool Join::bindRow(const LiteralPattern& literal, const std::vector<ConstantId>& row,
                   const Level& level)
{
  for (std::size_t column = 0; column < row.size(); ++column)
  {
    const Slot& slot = slotOf(literal, column);
    if (!slot.is_variable)
    {
      if (slot.id != row[column])
      {
        return false;
      }
      continue;
    }
    ConstantId& value = binding_[static_cast<std::size_t>(slot.id)];
    if (value != kUnbound && value != row[column])
    {
      return false;
    }
    value = row[column];
  }
  return std::all_of(level.binds.begin(), level.binds.end(),
                     [&](int variable) { return fitsSorts(variable); });
}

void Join::found()
{
  if (may_repeat_)
  {
    std::vector<ConstantId> key;
    for (const std::size_t v : wanted_)
    {
      key.push_back(binding_[v]);
    }
    if (!seen_.insert(std::move(key)).second)
    {
      return;
    }
  }
  (*visit_)(binding_);
}

}  // namespace kr3::reasoner
