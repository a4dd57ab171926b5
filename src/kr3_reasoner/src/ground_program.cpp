#include "ground_program.hpp"

#include <algorithm>

namespace kr3::reasoner
{

void GroundProgram::addHeads(Rule& rule, Range<AtomId> heads)
{
  rule.head_begin = static_cast<std::uint32_t>(heads_.size());
  heads_.insert(heads_.end(), heads.begin(), heads.end());
  rule.head_end = static_cast<std::uint32_t>(heads_.size());
  std::for_each(heads.begin(), heads.end(), [this](AtomId atom) { note(atom); });
}

void GroundProgram::addRule(bool choice, Range<AtomId> heads, Range<std::int32_t> body)
{
  Rule rule{choice, true, 0, 0, 0, 0, static_cast<std::int32_t>(body.size())};
  addHeads(rule, heads);
  rule.body_begin = static_cast<std::uint32_t>(bodies_.size());
  for (const std::int32_t literal : body)
  {
    bodies_.push_back({literal, 1});
    note(bodies_.back().atom());
  }
  rule.body_end = static_cast<std::uint32_t>(bodies_.size());
  rules_.push_back(rule);
}

void GroundProgram::addWeightRule(bool choice, Range<AtomId> heads, std::int32_t bound,
                                  Range<BodyLiteral> body)
{
  Rule rule{choice, false, 0, 0, 0, 0, bound};
  addHeads(rule, heads);
  rule.body_begin = static_cast<std::uint32_t>(bodies_.size());
  for (const BodyLiteral& literal : body)
  {
    bodies_.push_back(literal);
    note(literal.atom());
  }
  rule.body_end = static_cast<std::uint32_t>(bodies_.size());
  rules_.push_back(rule);
}

void GroundProgram::append(const GroundProgram& other)
{
  const auto head_offset = static_cast<std::uint32_t>(heads_.size());
  const auto body_offset = static_cast<std::uint32_t>(bodies_.size());
  for (Rule rule : other.rules_)
  {
    rule.head_begin += head_offset;
    rule.head_end += head_offset;
    rule.body_begin += body_offset;
    rule.body_end += body_offset;
    rules_.push_back(rule);
  }
  heads_.insert(heads_.end(), other.heads_.begin(), other.heads_.end());
  bodies_.insert(bodies_.end(), other.bodies_.begin(), other.bodies_.end());
  note(other.num_atoms_);
}

void GroundProgramRecorder::rule(bool choice, Clingo::AtomSpan head, Clingo::LiteralSpan body)
{
  program_->addRule(choice, {head.begin(), head.end()}, {body.begin(), body.end()});
}

void GroundProgramRecorder::weight_rule(bool choice, Clingo::AtomSpan head,
                                        Clingo::weight_t lower_bound,
                                        Clingo::WeightedLiteralSpan body)
{
  std::vector<GroundProgram::BodyLiteral> literals;
  for (const Clingo::WeightedLiteral& literal : body)
  {
    literals.push_back({literal.literal(), literal.weight()});
  }
  program_->addWeightRule(choice, {head.begin(), head.end()}, lower_bound,
                          {literals.data(), literals.data() + literals.size()});
}

}  // namespace kr3::reasoner
