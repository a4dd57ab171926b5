#include "partial_evaluator.hpp"

#include <algorithm>
#include <utility>

namespace kr3::reasoner
{

PartialEvaluator::PartialEvaluator(GroundProgram program, std::size_t frame_begin,
                                   std::vector<std::vector<AtomId>> groups)
  : program_(std::move(program)), frame_begin_(frame_begin), groups_(std::move(groups))
{
  buildIndices();
}

void PartialEvaluator::buildIndices()
{
  const std::size_t num_atoms = program_.numAtoms() + 1;
  occurs_negatively_.assign(num_atoms, 0);
  group_of_.assign(num_atoms, -1);
  positive_.begin.assign(num_atoms + 1, 0);
  supporting_.begin.assign(num_atoms + 1, 0);
  for (std::size_t g = 0; g < groups_.size(); ++g)
  {
    for (const AtomId atom : groups_[g])
    {
      group_of_[atom] = static_cast<std::int32_t>(g);
    }
  }
  // Two passes: count, then fill from the back.
  for (const Rule& rule : program_.rules())
  {
    for (const AtomId head : program_.heads(rule))
    {
      ++supporting_.begin[head];
    }
    std::int32_t missing = rule.bound;
    for (const auto& literal : program_.body(rule))
    {
      if (literal.negative())
      {
        missing -= literal.weight;
        occurs_negatively_[literal.atom()] = 1;
      }
      else
      {
        ++positive_.begin[literal.atom()];
      }
    }
    if (missing <= 0)
    {
      without_positive_body_.push_back(static_cast<std::uint32_t>(initial_missing_.size()));
    }
    initial_missing_.push_back(missing);
  }
  for (std::size_t atom = 0; atom < num_atoms; ++atom)
  {
    positive_.begin[atom + 1] += positive_.begin[atom];
    supporting_.begin[atom + 1] += supporting_.begin[atom];
  }
  positive_.items.resize(positive_.begin[num_atoms]);
  supporting_.items.resize(supporting_.begin[num_atoms]);
  for (std::size_t r = program_.rules().size(); r-- > 0;)
  {
    const Rule& rule = program_.rules()[r];
    const auto number = static_cast<std::uint32_t>(r);
    for (const AtomId head : program_.heads(rule))
    {
      supporting_.items[--supporting_.begin[head]] = number;
    }
    for (const auto& literal : program_.body(rule))
    {
      if (!literal.negative())
      {
        positive_.items[--positive_.begin[literal.atom()]] = {number, literal.weight};
      }
    }
  }
}

void PartialEvaluator::selectRules(const std::vector<AtomId>& needed)
{
  selected_.assign(program_.rules().size(), 0);
  std::vector<char> seen(program_.numAtoms() + 1, 0);
  std::vector<AtomId> open = needed;
  while (!open.empty())
  {
    const AtomId atom = open.back();
    open.pop_back();
    if (seen[atom] != 0 || is_input_[atom] != 0)
    {
      continue;
    }
    seen[atom] = 1;
    for (const std::uint32_t r : supporting_.of(atom))
    {
      selected_[r] = 1;
      for (const auto& literal : program_.body(program_.rules()[r]))
      {
        open.push_back(literal.atom());
      }
    }
  }
}

void PartialEvaluator::instantiate(std::vector<SolverLiteral>& values, RuleSink& sink,
                                   const std::vector<AtomId>* needed)
{
  const std::size_t num_atoms = program_.numAtoms() + 1;
  values_ = &values;
  conflict_ = false;
  is_input_.assign(num_atoms, 0);
  is_alias_.assign(num_atoms, 0);
  for (std::size_t atom = 1; atom < num_atoms; ++atom)
  {
    is_input_[atom] = values[atom] != kOpen ? 1 : 0;
  }
  restricted_ = needed != nullptr;
  if (restricted_)
  {
    selectRules(*needed);
  }
  for (bool changed = true; changed && !conflict_;)
  {
    derivePossible();
    changed = deriveCertain();
    changed = decideGroups() || changed;
    changed = decideUnits() || changed;
  }
  for (std::size_t atom = 1; atom < num_atoms; ++atom)
  {
    if (values[atom] == kOpen && (conflict_ || possible_[atom] == 0))
    {
      values[atom] = kFalseLiteral;
    }
  }
  if (conflict_)
  {
    sink.contradiction();
    return;
  }
  name(sink);
  for (std::size_t r = 0; r < program_.rules().size(); ++r)
  {
    if (possible_rule_[r] != 0)
    {
      writeRule(program_.rules()[r], sink);
    }
  }
}

bool PartialEvaluator::isPossible(const GroundProgram::BodyLiteral& literal) const
{
  return literal.negative() ? (*values_)[literal.atom()] != kTrueLiteral
                            : possible_[literal.atom()] != 0;
}

bool PartialEvaluator::holds(const GroundProgram::BodyLiteral& literal) const
{
  const AtomId atom = literal.atom();
  return literal.negative() ? possible_[atom] == 0 : (*values_)[atom] == kTrueLiteral;
}

/// Everything that has a derivation when no negative literal stands in the way that is not known to
/// be false.
void PartialEvaluator::derivePossible()
{
  const std::size_t num_atoms = program_.numAtoms() + 1;
  possible_.assign(num_atoms, 0);
  possible_rule_.assign(program_.rules().size(), 0);
  missing_ = initial_missing_;
  order_.clear();
  for (const std::uint32_t r : without_positive_body_)
  {
    fire(r);
  }
  for (std::size_t atom = 1; atom < num_atoms; ++atom)
  {
    const SolverLiteral value = (*values_)[atom];
    if (value != kOpen && value != kFalseLiteral && possible_[atom] == 0)
    {
      possible_[atom] = 1;
      order_.push_back(static_cast<AtomId>(atom));
    }
  }
  for (std::size_t next = 0; next < order_.size(); ++next)
  {
    for (const Occurrence& occurrence : positive_.of(order_[next]))
    {
      const std::int32_t before = missing_[occurrence.rule];
      missing_[occurrence.rule] = before - occurrence.weight;
      if (before > 0 && missing_[occurrence.rule] <= 0)
      {
        fire(occurrence.rule);
      }
    }
  }
}

void PartialEvaluator::fire(std::uint32_t number)
{
  const Rule& rule = program_.rules()[number];
  if (restricted_ && selected_[number] == 0)
  {
    return;
  }
  if (rule.conjunction)
  {
    for (const auto& literal : program_.body(rule))
    {
      if (literal.negative() && (*values_)[literal.atom()] == kTrueLiteral)
      {
        return;
      }
    }
  }
  possible_rule_[number] = 1;
  for (const AtomId head : program_.heads(rule))
  {
    if (possible_[head] == 0 && (*values_)[head] == kOpen)
    {
      possible_[head] = 1;
      order_.push_back(head);
    }
  }
}

void PartialEvaluator::makeTrue(AtomId atom)
{
  SolverLiteral& value = (*values_)[atom];
  if (value == kTrueLiteral || (value != kOpen && value != kFalseLiteral))
  {
    return;  // an open input: the rule is written as a constraint on it
  }
  if (value == kFalseLiteral)
  {
    conflict_ = true;
    return;
  }
  value = kTrueLiteral;
  renewed_ = renewed_ || occurs_negatively_[atom] != 0;
  queue_.push_back(atom);
}

bool PartialEvaluator::deriveCertain()
{
  renewed_ = false;
  queue_.clear();
  // missing_ from here on: the weight of what is not certain yet.
  for (std::size_t r = 0; r < program_.rules().size(); ++r)
  {
    const Rule& rule = program_.rules()[r];
    if (possible_rule_[r] == 0 || rule.choice || program_.heads(rule).size() > 1)
    {
      missing_[r] = std::numeric_limits<std::int32_t>::max();
      continue;
    }
    std::int32_t missing = rule.bound;
    for (const auto& literal : program_.body(rule))
    {
      missing -= holds(literal) ? literal.weight : 0;
    }
    missing_[r] = missing;
  }
  const auto conclude = [this](std::size_t r) {
    const Rule& rule = program_.rules()[r];
    if (rule.isConstraint())
    {
      conflict_ = true;
      return;
    }
    makeTrue(*program_.heads(rule).begin());
  };
  const std::size_t num_rules = program_.rules().size();
  for (std::size_t r = 0; r < num_rules; ++r)
  {
    // What becomes true on the way is counted below, when it leaves the queue.
    if (missing_[r] <= 0)
    {
      conclude(r);
    }
  }
  for (std::size_t next = 0; next < queue_.size() && !conflict_; ++next)
  {
    for (const Occurrence& occurrence : positive_.of(queue_[next]))
    {
      std::int32_t& missing = missing_[occurrence.rule];
      if (missing == std::numeric_limits<std::int32_t>::max() || missing <= 0)
      {
        continue;
      }
      missing -= occurrence.weight;
      if (missing <= 0)
      {
        conclude(occurrence.rule);
      }
    }
  }
  return renewed_;
}

/// Exactly one atom of each group is true.
bool PartialEvaluator::decideGroups()
{
  bool changed = false;
  for (const std::vector<AtomId>& group : groups_)
  {
    std::size_t num_true = 0;
    std::size_t num_possible = 0;
    AtomId last = 0;
    for (const AtomId atom : group)
    {
      num_true += (*values_)[atom] == kTrueLiteral ? 1 : 0;
      if (possible_[atom] != 0 && (*values_)[atom] != kFalseLiteral)
      {
        ++num_possible;
        last = atom;
      }
    }
    if (num_true > 1 || num_possible == 0)
    {
      conflict_ = true;
      return true;
    }
    if (num_true == 1)
    {
      for (const AtomId atom : group)
      {
        if ((*values_)[atom] == kOpen)
        {
          (*values_)[atom] = kFalseLiteral;
          changed = changed || possible_[atom] != 0;
        }
      }
    }
    else if (num_possible == 1 && (*values_)[last] == kOpen && isChoosable(last))
    {
      (*values_)[last] = kTrueLiteral;
      changed = true;
    }
  }
  return changed;
}

bool PartialEvaluator::isChoosable(AtomId atom) const
{
  const auto rules = supporting_.of(atom);
  return std::any_of(rules.begin(), rules.end(), [&](std::uint32_t r) {
    const Rule& rule = program_.rules()[r];
    const auto body = program_.body(rule);
    return possible_rule_[r] != 0 && rule.choice && rule.conjunction &&
           std::all_of(body.begin(), body.end(),
                       [&](const auto& literal) { return holds(literal); });
  });
}

bool PartialEvaluator::actsAsConstraint(const Rule& rule) const
{
  if (rule.isConstraint())
  {
    return true;
  }
  const auto heads = program_.heads(rule);
  return !rule.choice && heads.size() == 1 && (*values_)[*heads.begin()] == kFalseLiteral;
}

/// A constraint all of whose literals but one hold decides that one.
bool PartialEvaluator::decideUnits()
{
  bool changed = false;
  for (std::size_t r = 0; r < program_.rules().size() && !conflict_; ++r)
  {
    const Rule& rule = program_.rules()[r];
    if (possible_rule_[r] == 0 || !rule.conjunction || !actsAsConstraint(rule))
    {
      continue;
    }
    const GroundProgram::BodyLiteral* open = nullptr;
    std::size_t num_open = 0;
    bool excluded = false;
    for (const auto& literal : program_.body(rule))
    {
      excluded = excluded || !isPossible(literal) ||
                 (!literal.negative() && (*values_)[literal.atom()] == kFalseLiteral);
      if (!holds(literal))
      {
        ++num_open;
        open = &literal;
      }
    }
    if (excluded || num_open > 1)
    {
      continue;
    }
    if (num_open == 0)
    {
      conflict_ = true;
      return true;
    }
    SolverLiteral& value = (*values_)[open->atom()];
    if (value != kOpen)
    {
      continue;
    }
    if (!open->negative())
    {
      value = kFalseLiteral;
      changed = true;
    }
    else if (isChoosable(open->atom()))
    {
      value = kTrueLiteral;
      changed = true;
    }
  }
  return changed;
}

}  // namespace kr3::reasoner
