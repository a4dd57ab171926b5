#include <algorithm>

#include "step_parts.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = StepProgram::AtomId;

void addRule(GroundProgram& program, bool choice, AtomId head,
             const std::vector<std::int32_t>& body)
{
  program.addRule(choice, {&head, &head + (head == 0 ? 0 : 1)},
                  {body.data(), body.data() + body.size()});
}

/// The values of the fluent that a value belongs to, but that one.
template <typename Visit>
void forEachOther(const StepContext& context, const LiteralPattern& literal, int value,
                  const RuleBinding& binding, const Visit& visit)
{
  const int own = context.vocabulary.position(
      bound(literal.value, binding),
      context.vocabulary.sortIndex(*context.vocabulary.fluent(literal.symbol).value_sort));
  const int first = value - own;
  const auto end = first + static_cast<int>(context.signature.valuesOf(literal.symbol));
  for (int other = first; other < end; ++other)
  {
    if (other != value)
    {
      visit(other);
    }
  }
}

/// Every instance of the conditions of constraints that must be watched.
template <typename Visit>
void forEachWatched(const StepContext& context, const Visit& visit)
{
  const Description& description = context.vocabulary.description();
  for (const StateConstraint& constraint : description.constraints)
  {
    for (const Condition& condition : constraint.body)
    {
      if (!isCircular(description, constraint, condition))
      {
        continue;
      }
      StepBody body(context);
      const LiteralPattern literal = body.reader().literal(std::get<Literal>(condition));
      body.forEach(std::vector<bool>(body.reader().variables().size(), true),
                   [&](const RuleBinding& binding) {
        const int value =
            context.signature.value(literal.symbol, literal.arguments, literal.value, binding);
        if (value >= 0)
        {
          visit(literal, value, binding);
        }
      });
    }
  }
}

void groundConstraint(const StepContext& context, const StateConstraint& constraint)
{
  const Description& description = context.vocabulary.description();
  StepBody body(context);
  LiteralPattern head;
  bool derives = false;
  if (constraint.head)
  {
    const int symbol = context.vocabulary.fluentSymbol(constraint.head->atom.name);
    if (context.vocabulary.isStatic(symbol))
    {
      return;
    }
    head = body.reader().literal(*constraint.head);
    derives = head.equal;
    if (!derives)  // what it excludes may not hold
    {
      Literal excluded = *constraint.head;
      excluded.equal = true;
      body.addNow(excluded);
    }
  }
  for (const Condition& condition : constraint.body)
  {
    if (isCircular(description, constraint, condition))
    {
      body.addUnequalNow(std::get<Literal>(condition));
    }
    else
    {
      body.addNow(condition);
    }
  }
  std::vector<bool> wanted(body.reader().variables().size(), false);
  if (derives)
  {
    markVariables(head.arguments, wanted);
    markVariables({head.value}, wanted);
  }
  std::vector<std::int32_t> literals;
  body.forEach(wanted, [&](const RuleBinding& binding) {
    literals.clear();
    const int value =
        derives ? context.signature.value(head.symbol, head.arguments, head.value, binding) : 0;
    if (value >= 0 && body.write(binding, literals))
    {
      addRule(context.program.state, false, derives ? context.atoms.now(value) : 0, literals);
    }
  });
}

}  // namespace

void watchCircular(const StepContext& context)
{
  forEachWatched(context, [&](const LiteralPattern&, int value, const RuleBinding&) {
    context.atoms.watch(value);
  });
}

void groundConstraints(const StepContext& context)
{
  StepAtoms& atoms = context.atoms;
  std::set<int> done;
  forEachWatched(context,
                 [&](const LiteralPattern& literal, int value, const RuleBinding& binding) {
    if (!done.insert(value).second)
    {
      return;
    }
    const AtomId unequal = atoms.unequalNowOf(value);
    forEachOther(context, literal, value, binding, [&](int other) {
      addRule(context.program.state, false, unequal, {static_cast<std::int32_t>(atoms.now(other))});
    });
    addRule(context.program.state, false, 0,
            {static_cast<std::int32_t>(unequal), static_cast<std::int32_t>(atoms.now(value))});
  });
  for (std::size_t i = 0; i < atoms.watched().size(); ++i)
  {
    // f != v stays as it was, too
    addRule(context.program.effects, true, atoms.unequalNow(i),
            {static_cast<std::int32_t>(atoms.unequalBefore(i))});
  }
  for (const StateConstraint& constraint : context.vocabulary.description().constraints)
  {
    groundConstraint(context, constraint);
  }
}

}  // namespace kr3::reasoner
