#include "step_body.hpp"

#include <algorithm>

namespace kr3::reasoner
{

StepAtoms::StepAtoms(const Signature& signature)
  : num_values_(signature.numValues())
  , first_action_(static_cast<AtomId>(num_values_) + 1)
  , next_(first_action_ + static_cast<AtomId>(signature.numActions()))
{
}

void StepAtoms::beginNow()
{
  first_now_ = next_;
  next_ += static_cast<AtomId>(num_values_);
  for (std::size_t i = 0; i < watched_.size(); ++i)
  {
    unequal_now_.push_back(fresh());
  }
}

void StepAtoms::watch(int value)
{
  if (watched_numbers_.emplace(value, watched_.size()).second)
  {
    watched_.push_back(value);
    unequal_before_.push_back(fresh());
  }
}

StepAtoms::AtomId StepAtoms::unequalNowOf(int value) const
{
  return unequal_now_[watched_numbers_.at(value)];
}

void markVariables(const std::vector<Slot>& slots, std::vector<bool>& variables)
{
  for (const Slot& slot : slots)
  {
    if (slot.is_variable)
    {
      variables[static_cast<std::size_t>(slot.id)] = true;
    }
  }
}

void StepBody::add(const Condition& condition, Time time)
{
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    reader_.add(*comparison);
    return;
  }
  if (const auto* membership = std::get_if<Membership>(&condition))
  {
    reader_.add(*membership);
    return;
  }
  const auto& literal = std::get<Literal>(condition);
  const int symbol = context_.vocabulary.fluentSymbol(literal.atom.name);
  if (context_.vocabulary.isStatic(symbol))
  {
    reader_.addStatic(literal);
    return;
  }
  LiteralPattern pattern = reader_.literal(literal);
  bool negative = !pattern.equal;
  if (context_.vocabulary.isDefined(symbol) && pattern.value.id == Vocabulary::kFalse)
  {
    pattern.value.id = Vocabulary::kTrue;
    negative = true;
  }
  parts_.push_back({std::move(pattern), time, negative && time != Time::kUnequalNow});
}

void StepBody::addBefore(const Condition& condition)
{
  add(condition, Time::kBefore);
}

void StepBody::addNow(const Condition& condition)
{
  add(condition, Time::kNow);
}

void StepBody::addUnequalNow(const Literal& literal)
{
  add(literal, Time::kUnequalNow);
}

/// The fluent has not this value before. Which values there are is of no matter to the value.
void StepBody::addDiffering(const Literal& literal, const Term& value)
{
  const int symbol = context_.vocabulary.fluentSymbol(literal.atom.name);
  const FluentDeclaration& fluent = context_.vocabulary.fluent(symbol);
  parts_.push_back({{symbol, reader_.arguments(literal.atom, fluent.argument_sorts),
                     reader_.slot(value, ConditionReader::kNoSort), true},
                    Time::kBefore,
                    true});
}

void StepBody::addBefore(const Body& body, const std::set<std::string>& used)
{
  const std::map<std::string, int> uses = variableUses(body);
  const auto onlyCompared = [&](const Literal& literal) {
    const FluentDeclaration& fluent =
        *context_.vocabulary.description().findFluent(literal.atom.name);
    return literal.equal && fluent.value_sort && fluent.kind != FluentKind::kStatic &&
           literal.value.is_variable && used.count(literal.value.name) == 0 &&
           uses.at(literal.value.name) == 2;
  };
  std::vector<bool> done(body.size(), false);
  for (std::size_t i = 0; i < body.size(); ++i)
  {
    const auto* comparison = std::get_if<Comparison>(&body[i]);
    if (comparison == nullptr || comparison->op != Comparison::Operator::kNotEqual)
    {
      continue;
    }
    for (std::size_t j = 0; j < body.size() && !done[i]; ++j)
    {
      const auto* part = std::get_if<Literal>(&body[j]);
      if (part == nullptr || done[j] || !onlyCompared(*part) ||
          (comparison->left == part->value) == (comparison->right == part->value))
      {
        continue;
      }
      addDiffering(*part, comparison->left == part->value ? comparison->right : comparison->left);
      done[i] = done[j] = true;
    }
  }
  for (std::size_t i = 0; i < body.size(); ++i)
  {
    if (!done[i])
    {
      addBefore(body[i]);
    }
  }
}

void StepBody::markLiterals(std::vector<bool>& variables) const
{
  for (const Part& part : parts_)
  {
    markVariables(part.literal.arguments, variables);
    markVariables({part.literal.value}, variables);
  }
}

bool StepBody::write(const RuleBinding& binding, std::vector<std::int32_t>& body) const
{
  for (const Part& part : parts_)
  {
    if (context_.signature.valuesOf(part.literal.symbol) == 0)
    {
      return false;  // no value, no fluent
    }
    const int value = context_.signature.value(part.literal.symbol, part.literal.arguments,
                                               part.literal.value, binding);
    if (value < 0)
    {
      if (!part.negative)
      {
        return false;
      }
      continue;
    }
    const auto atom =
        static_cast<std::int32_t>(part.time == Time::kBefore ? context_.atoms.before(value)
                                  : part.time == Time::kNow  ? context_.atoms.now(value)
                                                             : context_.atoms.unequalNowOf(value));
    body.push_back(part.negative ? -atom : atom);
  }
  return true;
}

void StepBody::forEach(std::vector<bool> wanted,
                       const std::function<void(const RuleBinding&)>& visit) const
{
  const Conditions& conditions = reader_.conditions();
  wanted.resize(conditions.numVariables(), false);
  markLiterals(wanted);
  Join(conditions, context_.statics, std::vector<bool>(conditions.numVariables(), false), wanted,
       context_.limit)
      .forEach(RuleBinding(conditions.numVariables(), kUnbound), visit);
}

}  // namespace kr3::reasoner
