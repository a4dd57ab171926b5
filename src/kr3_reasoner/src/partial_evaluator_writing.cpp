#include <utility>

#include "partial_evaluator.hpp"

namespace kr3::reasoner
{

/// Gives every atom that is still open a literal: an old one where an equivalent one is known.
void PartialEvaluator::name(RuleSink& sink)
{
  named_group_.assign(groups_.size(), 0);
  for (const AtomId atom : order_)
  {
    if ((*values_)[atom] != kOpen)
    {
      continue;
    }
    const std::int32_t group = group_of_[atom];
    if (group < 0)
    {
      nameSingle(atom, sink);
    }
    else if (named_group_[static_cast<std::size_t>(group)] == 0)
    {
      named_group_[static_cast<std::size_t>(group)] = 1;
      nameGroup(groups_[static_cast<std::size_t>(group)], sink);
    }
  }
}

std::uint32_t PartialEvaluator::frameRule(AtomId atom) const
{
  for (const std::uint32_t r : supporting_.of(atom))
  {
    if (r >= frame_begin_ && possible_rule_[r] != 0)
    {
      return r;
    }
  }
  return kNoRule;
}

void PartialEvaluator::nameGroup(const std::vector<AtomId>& group, RuleSink& sink)
{
  bool only_frame = true;
  for (const AtomId atom : group)
  {
    for (const std::uint32_t r : supporting_.of(atom))
    {
      only_frame = only_frame && (possible_rule_[r] == 0 || r >= frame_begin_);
    }
  }
  RuleSink::Body members;
  bool all_kept = true;
  for (const AtomId atom : group)
  {
    SolverLiteral& value = (*values_)[atom];
    const std::uint32_t frame = only_frame ? frameRule(atom) : kNoRule;
    if (value != kOpen)
    {
      all_kept = all_kept && frame == kNoRule;
      if (value != kFalseLiteral)
      {
        members.push_back(value);
      }
      continue;
    }
    if (frame != kNoRule)
    {
      value = valueOf(*program_.body(program_.rules()[frame]).begin());
      is_alias_[atom] = 1;
    }
    else
    {
      value = sink.newAtom();
    }
    members.push_back(value);
  }
  if (only_frame && all_kept)
  {
    return;  // exactly one held before, and all are as before
  }
  sink.atLeastOne(members);
  if (!only_frame)
  {
    sink.atMostOne(members);
  }
}

void PartialEvaluator::nameSingle(AtomId atom, RuleSink& sink)
{
  const Rule* support = nullptr;
  std::size_t num_support = 0;
  for (const std::uint32_t r : supporting_.of(atom))
  {
    if (possible_rule_[r] != 0)
    {
      support = &program_.rules()[r];
      ++num_support;
    }
  }
  SolverLiteral& value = (*values_)[atom];
  if (num_support == 1 && !support->choice && support->conjunction &&
      program_.heads(*support).size() == 1)
  {
    const GroundProgram::BodyLiteral* open = nullptr;
    std::size_t num_open = 0;
    for (const auto& literal : program_.body(*support))
    {
      if (!holds(literal))
      {
        ++num_open;
        open = &literal;
      }
    }
    // A negative literal only over an input: elsewhere it could turn a double negation in a cycle
    // into a positive cycle.
    if (num_open == 1 && (!open->negative() || is_input_[open->atom()] != 0) &&
        (*values_)[open->atom()] != kOpen)
    {
      value = valueOf(*open);
      is_alias_[atom] = 1;
      return;
    }
  }
  value = sink.newAtom();
}

SolverLiteral PartialEvaluator::valueOf(const GroundProgram::BodyLiteral& literal) const
{
  const SolverLiteral value = (*values_)[literal.atom()];
  return literal.negative() ? -value : value;
}

void PartialEvaluator::writeRule(const Rule& rule, RuleSink& sink)
{
  const auto heads = program_.heads(rule);
  if (heads.size() == 1 &&
      (is_alias_[*heads.begin()] != 0 || (*values_)[*heads.begin()] == kTrueLiteral))
  {
    return;
  }
  if (!rule.conjunction)
  {
    writeWeightRule(rule, sink);
    return;
  }
  RuleSink::Body body;
  for (const auto& literal : program_.body(rule))
  {
    const SolverLiteral value = valueOf(literal);
    if (value == kFalseLiteral)
    {
      return;
    }
    if (value != kTrueLiteral)
    {
      body.push_back(value);
    }
  }
  writeHeads(rule, body, sink);
}

void PartialEvaluator::writeHeads(const Rule& rule, const RuleSink::Body& body, RuleSink& sink)
{
  const auto heads = program_.heads(rule);
  if (rule.choice)
  {
    for (const AtomId head : heads)
    {
      if (is_input_[head] == 0 && is_alias_[head] == 0 && !isConstant((*values_)[head]))
      {
        sink.rule(true, (*values_)[head], body);
      }
    }
    return;
  }
  if (heads.size() > 1)
  {
    RuleSink::Body open;
    for (const AtomId head : heads)
    {
      if ((*values_)[head] == kTrueLiteral)
      {
        return;
      }
      if ((*values_)[head] != kFalseLiteral)
      {
        open.push_back((*values_)[head]);
      }
    }
    sink.disjunctiveRule(open, body);
    return;
  }
  const AtomId head = rule.isConstraint() ? 0 : *heads.begin();
  if (head != 0 && is_input_[head] == 0 && (*values_)[head] != kFalseLiteral)
  {
    sink.rule(false, (*values_)[head], body);
    return;
  }
  RuleSink::Body constraint = body;
  if (head != 0)
  {
    constraint.push_back(-(*values_)[head]);
  }
  sink.constraint(std::move(constraint));
}

void PartialEvaluator::writeWeightRule(const Rule& rule, RuleSink& sink)
{
  std::int32_t bound = rule.bound;
  std::vector<Clingo::WeightedLiteral> open;
  for (const auto& literal : program_.body(rule))
  {
    const SolverLiteral value = valueOf(literal);
    if (value == kTrueLiteral)
    {
      bound -= literal.weight;
    }
    else if (value != kFalseLiteral)
    {
      open.emplace_back(value, literal.weight);
    }
  }
  if (bound <= 0)
  {
    writeHeads(rule, {}, sink);
    return;
  }
  std::int32_t reachable = 0;
  for (const Clingo::WeightedLiteral& literal : open)
  {
    reachable += literal.weight();
  }
  if (reachable < bound)
  {
    return;
  }
  const SolverLiteral body = sink.newAtom();
  sink.weightRule(false, {static_cast<Clingo::atom_t>(body)}, bound, open);
  writeHeads(rule, {body}, sink);
}

}  // namespace kr3::reasoner
