#include "rule_sink.hpp"

#include <algorithm>

#include "solver.hpp"

namespace kr3::reasoner
{

namespace
{

template <typename Item>
GroundProgram::Range<Item> rangeOf(const std::vector<Item>& items)
{
  return {items.data(), items.data() + items.size()};
}

}  // namespace

Clingo::Backend* RuleSink::backend()
{
  if (!backend_ && solver_ != nullptr)
  {
    backend_.emplace(solver_->control().backend());
  }
  return backend_ ? &*backend_ : nullptr;
}

void RuleSink::write(bool choice, GroundProgram::Range<Clingo::atom_t> head, const Body& body)
{
  if (Clingo::Backend* const to = backend())
  {
    to->rule(choice, {head.first, head.size()}, {body.data(), body.size()});
  }
  else if (program_ != nullptr)
  {
    program_->addRule(choice, head, rangeOf(body));
  }
}

SolverLiteral RuleSink::newAtom()
{
  ++num_atoms_;
  Clingo::Backend* const to = backend();
  return to != nullptr ? static_cast<SolverLiteral>(to->add_atom())
                       : static_cast<SolverLiteral>(num_atoms_);
}

bool RuleSink::simplify(Body& body)
{
  if (std::find(body.begin(), body.end(), kFalseLiteral) != body.end())
  {
    return false;
  }
  body.erase(std::remove(body.begin(), body.end(), kTrueLiteral), body.end());
  return true;
}

SolverLiteral RuleSink::newChoice()
{
  const SolverLiteral atom = newAtom();
  rule(true, atom, {});
  return atom;
}

void RuleSink::rule(bool choice, SolverLiteral head, Body body)
{
  if (simplify(body))
  {
    const auto atom = static_cast<Clingo::atom_t>(head);
    write(choice, {&atom, &atom + 1}, body);
    ++num_rules_;
    if (components_ != nullptr && choice)
    {
      body.push_back(head);
      components_->join(body);
    }
    else if (components_ != nullptr)
    {
      components_->define(atom, std::move(body));
    }
  }
}

void RuleSink::constraint(Body body)
{
  if (simplify(body))
  {
    write(false, {nullptr, nullptr}, body);
    num_contradictions_ += body.empty() ? 1 : 0;
    note(body);
  }
}

SolverLiteral RuleSink::conjunction(Body body)
{
  if (!simplify(body))
  {
    return kFalseLiteral;
  }
  if (body.empty())
  {
    return kTrueLiteral;
  }
  if (body.size() == 1)
  {
    return body.front();
  }
  const SolverLiteral both = newAtom();
  rule(false, both, std::move(body));
  return both;
}

SolverLiteral RuleSink::disjunction(const Body& literals)
{
  Body open;
  for (const SolverLiteral literal : literals)
  {
    if (literal == kTrueLiteral)
    {
      return kTrueLiteral;
    }
    if (literal != kFalseLiteral)
    {
      open.push_back(literal);
    }
  }
  if (open.size() < 2)
  {
    return open.empty() ? kFalseLiteral : open.front();
  }
  const SolverLiteral any = newAtom();
  for (const SolverLiteral literal : open)
  {
    rule(false, any, {literal});
  }
  return any;
}

void RuleSink::weightRule(bool choice, const std::vector<Clingo::atom_t>& head, int bound,
                          const std::vector<Clingo::WeightedLiteral>& body)
{
  if (Clingo::Backend* const to = backend())
  {
    to->weight_rule(choice, {head.data(), head.size()}, bound, {body.data(), body.size()});
  }
  else if (program_ != nullptr)
  {
    std::vector<GroundProgram::BodyLiteral> sum;
    for (const Clingo::WeightedLiteral& weighted : body)
    {
      sum.push_back({weighted.literal(), weighted.weight()});
    }
    program_->addWeightRule(choice, rangeOf(head), bound, rangeOf(sum));
  }
  Body literals(head.begin(), head.end());
  for (const Clingo::WeightedLiteral& weighted : body)
  {
    literals.push_back(weighted.literal());
  }
  note(literals);
}

void RuleSink::disjunctiveRule(const Body& heads, const Body& body)
{
  const std::vector<Clingo::atom_t> atoms(heads.begin(), heads.end());
  write(false, rangeOf(atoms), body);
  Body literals = heads;
  literals.insert(literals.end(), body.begin(), body.end());
  note(literals);
}

void RuleSink::note(const Body& literals)
{
  ++num_rules_;
  if (components_ != nullptr)
  {
    components_->join(literals);
  }
}

void RuleSink::atLeastOne(Body literals)
{
  for (SolverLiteral& literal : literals)
  {
    literal = -literal;
  }
  constraint(std::move(literals));
}

void RuleSink::atMostOne(const Body& literals)
{
  if (literals.size() == 2)
  {
    constraint(literals);
  }
  else if (literals.size() > 2)
  {
    std::vector<Clingo::WeightedLiteral> weighted;
    weighted.reserve(literals.size());
    for (const SolverLiteral literal : literals)
    {
      weighted.emplace_back(literal, 1);
    }
    weightRule(false, {}, 2, weighted);
  }
}

void RuleSink::minimize(int priority, const std::vector<Clingo::WeightedLiteral>& literals)
{
  if (Clingo::Backend* const to = backend())
  {
    to->minimize(priority, {literals.data(), literals.size()});
  }
}

}  // namespace kr3::reasoner
