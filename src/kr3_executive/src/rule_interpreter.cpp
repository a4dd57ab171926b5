#include "kr3_executive/rule_interpreter.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

using reasoner::Atom;
using reasoner::Comparison;
using reasoner::Description;
using reasoner::FluentKind;
using reasoner::Literal;
using reasoner::Membership;
using reasoner::Term;
using Bound = std::map<std::string, std::string>;

constexpr int kMaxRounds = 100;

std::optional<std::string> constantOf(const Term& term, const Bound& binding)
{
  if (!term.is_variable)
    return term.name;
  const auto found = binding.find(term.name);
  if (found == binding.end())
    return std::nullopt;
  return found->second;
}

std::string ground(const Atom& atom, const Bound& binding)
{
  std::string text = atom.name;
  for (std::size_t i = 0; i < atom.arguments.size(); ++i)
  {
    text += i == 0 ? "(" : ", ";
    text += constantOf(atom.arguments[i], binding).value_or("?");
  }
  if (!atom.arguments.empty())
    text += ")";
  return text;
}

/// Extends the binding so that the pattern equals the ground atom; false when it cannot.
bool unify(const Atom& pattern, const Atom& ground_atom, Bound& binding)
{
  if (pattern.name != ground_atom.name || pattern.arguments.size() != ground_atom.arguments.size())
    return false;
  for (std::size_t i = 0; i < pattern.arguments.size(); ++i)
  {
    const Term& term = pattern.arguments[i];
    const std::string& value = ground_atom.arguments[i].name;
    if (!term.is_variable)
    {
      if (term.name != value)
        return false;
    }
    else if (!binding.emplace(term.name, value).second && binding.at(term.name) != value)
      return false;
  }
  return true;
}

bool compare(const std::string& left, Comparison::Operator op, const std::string& right)
{
  using Operator = Comparison::Operator;
  if (op == Operator::kEqual)
    return left == right;
  if (op == Operator::kNotEqual)
    return left != right;
  const long l = std::strtol(left.c_str(), nullptr, 10);
  const long r = std::strtol(right.c_str(), nullptr, 10);
  switch (op)
  {
    case Operator::kLess:
      return l < r;
    case Operator::kLessEqual:
      return l <= r;
    case Operator::kGreater:
      return l > r;
    default:
      return l >= r;
  }
}

bool contains(const Description& description, const std::string& sort, const std::string& element)
{
  const auto* declared = description.findSort(sort);
  return declared != nullptr && std::find(declared->elements.begin(), declared->elements.end(),
                                          element) != declared->elements.end();
}

const std::vector<std::string>& elements(const Description& description, const std::string& sort)
{
  const auto* declared = description.findSort(sort);
  if (declared == nullptr)
    throw InternalError("sort '" + sort + "' is not declared");
  return declared->elements;
}

/// The elements that a literal's arguments or value range over.
bool hasElement(const Description& description, const Literal& literal, const Bound& binding)
{
  const auto* fluent = description.findFluent(literal.atom.name);
  for (std::size_t i = 0; fluent != nullptr && i < literal.atom.arguments.size(); ++i)
  {
    const auto argument = constantOf(literal.atom.arguments[i], binding);
    if (argument && !contains(description, fluent->argument_sorts[i], *argument))
      return false;
  }
  return fluent != nullptr;
}

}  // namespace

RuleInterpreter::RuleInterpreter(const Description& description) : description_(description)
{
  for (const auto& fact : description_.static_facts)
  {
    if (fact.equal)
      statics_[ground(fact.atom, {})] = fact.value.name;
  }
  has_defined_ = std::any_of(description_.fluents.begin(), description_.fluents.end(),
                             [](const auto& f) { return f.kind == FluentKind::kDefined; });
  used_defined_ = definedInUse();
}

std::set<std::string> RuleInterpreter::definedInUse() const
{
  std::set<std::string> used;
  const auto use = [&](const reasoner::Body& body) {
    bool more = false;
    for (const auto& condition : body)
    {
      const auto* literal = std::get_if<Literal>(&condition);
      const auto* fluent =
          literal != nullptr ? description_.findFluent(literal->atom.name) : nullptr;
      if (fluent != nullptr && fluent->kind == FluentKind::kDefined)
        more = used.insert(fluent->name).second || more;
    }
    return more;
  };
  for (const auto& law : description_.executabilities)
    use(law.body);
  for (const auto& law : description_.causal_laws)
  {
    use(law.body);
    for (const auto& outcome : law.outcomes)
    {
      for (const auto& effect : outcome.effects)
        use(effect.choice);
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const auto& law : description_.constraints)
    {
      const auto* head = law.head ? description_.findFluent(law.head->atom.name) : nullptr;
      const bool defines = head != nullptr && head->kind == FluentKind::kDefined;
      if (!defines || used.count(head->name) != 0)
        changed = use(law.body) || changed;
    }
  }
  return used;
}

std::string RuleInterpreter::valueOf(const FluentValues& state, const std::string& symbol,
                                     const std::string& name) const
{
  const auto* fluent = description_.findFluent(symbol);
  if (fluent == nullptr)
    throw InternalError("fluent '" + symbol + "' is not declared");
  const FluentValues& values = fluent->kind == FluentKind::kStatic ? statics_ : state;
  const auto found = values.find(name);
  if (found != values.end())
    return found->second;
  return fluent->value_sort ? std::string() : "false";
}

bool RuleInterpreter::matchLiteral(const FluentValues& state, const Literal& literal,
                                   Binding& binding, const std::function<bool()>& next) const
{
  for (std::size_t i = 0; i < literal.atom.arguments.size(); ++i)
  {
    const Term& argument = literal.atom.arguments[i];
    if (constantOf(argument, binding))
      continue;
    const auto* fluent = description_.findFluent(literal.atom.name);
    for (const auto& element : elements(description_, fluent->argument_sorts[i]))
    {
      binding[argument.name] = element;
      const bool stop = matchLiteral(state, literal, binding, next);
      binding.erase(argument.name);
      if (stop)
        return true;
    }
    return false;
  }
  if (!hasElement(description_, literal, binding))
    return false;
  const std::string value = valueOf(state, literal.atom.name, ground(literal.atom, binding));
  if (value.empty())
    return false;
  const auto expected = constantOf(literal.value, binding);
  if (expected)
    return (*expected == value) == literal.equal && next();
  if (literal.equal)
  {
    binding[literal.value.name] = value;
    const bool stop = next();
    binding.erase(literal.value.name);
    return stop;
  }
  const auto* fluent = description_.findFluent(literal.atom.name);
  for (const auto& element : elements(description_, *fluent->value_sort))
  {
    if (element == value)
      continue;
    binding[literal.value.name] = element;
    const bool stop = next();
    binding.erase(literal.value.name);
    if (stop)
      return true;
  }
  return false;
}

bool RuleInterpreter::match(const FluentValues& state, const reasoner::Body& body,
                            std::vector<bool>& done, Binding& binding, const Visit& visit) const
{
  // First what can be decided or binds one value, then literals that enumerate.
  std::size_t chosen = body.size();
  for (const bool enumerate : {false, true})
  {
    for (std::size_t i = 0; i < body.size() && chosen == body.size(); ++i)
    {
      if (done[i])
        continue;
      if (const auto* comparison = std::get_if<Comparison>(&body[i]))
      {
        const bool left = constantOf(comparison->left, binding).has_value();
        const bool right = constantOf(comparison->right, binding).has_value();
        const bool equality = comparison->op == Comparison::Operator::kEqual;
        if ((left && right) || (equality && (left || right)))
          chosen = i;
      }
      else if (const auto* membership = std::get_if<Membership>(&body[i]))
      {
        if (constantOf(membership->term, binding) || (enumerate && !membership->negated))
          chosen = i;
      }
      else
      {
        const auto& literal = std::get<Literal>(body[i]);
        const bool known =
            std::all_of(literal.atom.arguments.begin(), literal.atom.arguments.end(),
                        [&](const Term& term) { return constantOf(term, binding).has_value(); });
        const bool bound = constantOf(literal.value, binding).has_value();
        if ((known && (literal.equal || bound)) || enumerate)
          chosen = i;
      }
    }
  }
  if (chosen == body.size())
  {
    if (std::all_of(done.begin(), done.end(), [](bool d) { return d; }))
      return visit(binding);
    throw InvalidArgument("a rule has a variable that only comparisons mention");
  }

  done[chosen] = true;
  const auto next = [&] { return match(state, body, done, binding, visit); };
  bool stop = false;
  if (const auto* comparison = std::get_if<Comparison>(&body[chosen]))
  {
    const auto left = constantOf(comparison->left, binding);
    const auto right = constantOf(comparison->right, binding);
    if (left && right)
      stop = compare(*left, comparison->op, *right) && next();
    else
    {
      const std::string& name = left ? comparison->right.name : comparison->left.name;
      binding[name] = left ? *left : *right;
      stop = next();
      binding.erase(name);
    }
  }
  else if (const auto* membership = std::get_if<Membership>(&body[chosen]))
  {
    if (const auto term = constantOf(membership->term, binding))
      stop = contains(description_, membership->sort, *term) != membership->negated && next();
    else
    {
      for (const auto& element : elements(description_, membership->sort))
      {
        binding[membership->term.name] = element;
        stop = next();
        binding.erase(membership->term.name);
        if (stop)
          break;
      }
    }
  }
  else
    stop = matchLiteral(state, std::get<Literal>(body[chosen]), binding, next);
  done[chosen] = false;
  return stop;
}

bool RuleInterpreter::forEach(const FluentValues& state, const reasoner::Body& body,
                              const Binding& binding, const Visit& visit) const
{
  std::vector<bool> done(body.size(), false);
  Binding copy = binding;
  return match(state, body, done, copy, visit);
}

FluentValues RuleInterpreter::withDefined(const FluentValues& state, Defined which) const
{
  if (!has_defined_ || (which == Defined::kUsed && used_defined_.empty()))
    return state;
  FluentValues complete = state;
  for (auto it = complete.begin(); it != complete.end();)
  {
    const auto* fluent = description_.findFluent(it->first.substr(0, it->first.find('(')));
    it = fluent != nullptr && fluent->kind == FluentKind::kDefined ? complete.erase(it)
                                                                   : std::next(it);
  }
  for (int round = 0; round < kMaxRounds; ++round)
  {
    bool changed = false;
    for (const auto& law : description_.constraints)
    {
      const auto* fluent = law.head ? description_.findFluent(law.head->atom.name) : nullptr;
      if (fluent == nullptr || fluent->kind != FluentKind::kDefined ||
          (which == Defined::kUsed && used_defined_.count(fluent->name) == 0))
        continue;
      FluentValues next = complete;
      forEach(complete, law.body, {}, [&](const Binding& binding) {
        next[ground(law.head->atom, binding)] = "true";
        return false;
      });
      changed = changed || next != complete;
      complete = std::move(next);
    }
    if (!changed)
      return complete;
  }
  throw InvalidArgument("the axioms of the defined fluents do not come to rest");
}

bool RuleInterpreter::executable(const FluentValues& state, const Atom& action) const
{
  const FluentValues complete = withDefined(state, Defined::kUsed);
  for (const auto& law : description_.executabilities)
  {
    if (law.actions.size() != 1 || !std::holds_alternative<Atom>(law.actions.front()))
      continue;  // about actions at the same time
    Binding binding;
    if (unify(std::get<Atom>(law.actions.front()), action, binding) &&
        forEach(complete, law.body, binding, [](const Binding&) { return true; }))
      return false;
  }
  return true;
}

bool RuleInterpreter::applyConstraints(FluentValues& state,
                                       const std::map<std::string, bool>& caused, bool strict) const
{
  std::map<std::string, bool> fixed = caused;
  for (int round = 0; round < kMaxRounds; ++round)
  {
    const FluentValues complete = withDefined(state, Defined::kUsed);
    bool changed = false;
    bool violated = false;
    for (const auto& law : description_.constraints)
    {
      if (!law.head)
      {
        violated = violated || forEach(complete, law.body, {}, [](const Binding&) { return true; });
        continue;
      }
      const auto* fluent = description_.findFluent(law.head->atom.name);
      if (fluent == nullptr || fluent->kind != FluentKind::kInertial)
        continue;
      forEach(complete, law.body, {}, [&](const Binding& binding) {
        if (!hasElement(description_, *law.head, binding))
          return false;
        const std::string name = ground(law.head->atom, binding);
        const std::string value = constantOf(law.head->value, binding).value_or("");
        const std::string now = valueOf(complete, law.head->atom.name, name);
        if (value.empty() || (now == value) == law.head->equal)
          return false;
        if (strict || fixed.count(name) != 0 || !law.head->equal)
        {
          violated = true;
          return false;
        }
        state[name] = value;
        fixed[name] = true;
        changed = true;
        return false;
      });
    }
    if (violated)
      return false;
    if (!changed)
      return true;
  }
  return false;
}

bool RuleInterpreter::consistent(const FluentValues& state) const
{
  FluentValues copy = state;
  return applyConstraints(copy, {}, true);
}

FluentValues RuleInterpreter::successor(const FluentValues& state, const Atom& action,
                                        const OutcomeChooser& chooser, std::string* label) const
{
  const FluentValues complete = withDefined(state, Defined::kUsed);
  std::vector<std::pair<const reasoner::CausalLaw*, Binding>> applied;
  for (const auto& law : description_.causal_laws)
  {
    Binding binding;
    if (!unify(law.action, action, binding))
      continue;
    forEach(complete, law.body, binding, [&](const Binding& bound) {
      applied.emplace_back(&law, bound);
      return false;
    });
  }
  const auto possible = [&](const reasoner::Outcome& outcome, const Binding& bound) {
    return std::all_of(outcome.effects.begin(), outcome.effects.end(), [&](const auto& effect) {
      return !effect.is_choice ||
             forEach(complete, effect.choice, bound, [](const Binding&) { return true; });
    });
  };
  // The labels of all laws that apply name one event: it is drawn once. It cannot happen where one
  // of its effects has no value to choose.
  std::vector<std::string> labels;
  std::set<std::string> impossible;
  for (const auto& [law, bound] : applied)
  {
    for (const auto& outcome : law->outcomes)
    {
      if (!possible(outcome, bound))
        impossible.insert(outcome.label);
      if (!outcome.label.empty() &&
          std::find(labels.begin(), labels.end(), outcome.label) == labels.end())
        labels.push_back(outcome.label);
    }
  }
  const bool labelled = !labels.empty();
  labels.erase(std::remove_if(labels.begin(), labels.end(),
                              [&](const auto& name) { return impossible.count(name) > 0; }),
               labels.end());
  if (impossible.count("") > 0 || (labelled && labels.empty()))
    return state;
  std::string drawn;
  if (labelled)
    drawn = labels[labels.size() == 1 ? 0 : chooser.outcome(action.name, labels)];
  if (label != nullptr && labelled)
    *label = drawn;

  FluentValues next = state;
  std::map<std::string, bool> caused;
  const auto apply = [&](const reasoner::Outcome& outcome, const Binding& bound) {
    for (const auto& effect : outcome.effects)
    {
      const auto* fluent = description_.findFluent(effect.fluent.name);
      if (fluent == nullptr || fluent->kind == FluentKind::kKnowledge)
        continue;
      const std::string name = ground(effect.fluent, bound);
      std::string value;
      if (effect.is_choice)
      {
        std::vector<std::string> values;
        forEach(complete, effect.choice, bound, [&](const Binding& with_value) {
          values.push_back(with_value.at(effect.value.name));
          return false;
        });
        value = values[values.size() == 1 ? 0 : chooser.value(values.size())];
      }
      else
        value = constantOf(effect.value, bound).value_or("");
      next[name] = value;
      caused[name] = true;
    }
  };
  for (const auto& [law, bound] : applied)
  {
    for (const auto& outcome : law->outcomes)
    {
      if (outcome.label.empty() || outcome.label == drawn)
        apply(outcome, bound);
    }
  }
  if (!applyConstraints(next, caused, false))
    throw InvalidArgument("the effects of " + reasoner::toString(action) +
                          " contradict the state constraints");
  return next;
}

FluentValues RuleInterpreter::imposed(const FluentValues& state, const FluentValues& values) const
{
  FluentValues next = state;
  std::map<std::string, bool> caused;
  std::string given;
  for (const auto& [fluent, value] : values)
  {
    next[fluent] = value;
    caused[fluent] = true;
    given += (given.empty() ? "" : ", ") + fluent + " = " + value;
  }
  if (!applyConstraints(next, caused, false))
    throw InvalidArgument(given + " contradicts the state constraints of the state it is set in");
  return next;
}

bool RuleInterpreter::holds(const FluentValues& state, const Literal& literal) const
{
  const FluentValues complete = withDefined(state, Defined::kAll);
  const std::string value = valueOf(complete, literal.atom.name, ground(literal.atom, {}));
  return !value.empty() && (value == literal.value.name) == literal.equal;
}

bool RuleInterpreter::holds(const FluentValues& state, const reasoner::Formula& formula) const
{
  using Kind = reasoner::Formula::Kind;
  const auto each = [&](const reasoner::Formula& operand) { return holds(state, operand); };
  const auto& operands = formula.operands;
  switch (formula.kind)
  {
    case Kind::kLiteral:
      return holds(state, formula.literal);
    case Kind::kNot:
      return !each(operands.front());
    case Kind::kAnd:
      return std::all_of(operands.begin(), operands.end(), each);
    default:
      return std::any_of(operands.begin(), operands.end(), each);
  }
}

std::vector<Atom> RuleInterpreter::instances(const reasoner::ActionDeclaration& action) const
{
  std::vector<Atom> atoms{{action.name, {}, {}}};
  for (const auto& sort : action.argument_sorts)
  {
    std::vector<Atom> longer;
    for (const auto& atom : atoms)
    {
      for (const auto& element : elements(description_, sort))
      {
        longer.push_back(atom);
        longer.back().arguments.push_back({false, element});
      }
    }
    atoms = std::move(longer);
  }
  return atoms;
}

}  // namespace kr3::executive
