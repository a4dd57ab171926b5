#include "ground_rules.hpp"

#include <algorithm>
#include <utility>

#include "history.hpp"
#include "instances.hpp"

namespace kr3::reasoner
{

std::size_t GroundAtomHash::operator()(const GroundAtom& atom) const
{
  auto hash = static_cast<std::size_t>(atom.symbol);
  for (const ConstantId argument : atom.arguments)
  {
    hash = hash * 1000003U + static_cast<std::size_t>(argument + 1);
  }
  return hash;
}

/// Takes one statement apart.
class GroundRules::RuleReader
{
public:
  RuleReader(GroundRules& rules, GroundableRule::Kind kind, std::size_t index,
             const SourcePosition& position)
    : rules_(rules)
  {
    rule_.kind = kind;
    rule_.index = index;
    rule_.position = position;
  }

  RuleReader& action(const Atom& atom)
  {
    const int symbol = rules_.actionSymbol(atom.name);
    rule_.actions.push_back(
        {symbol, slots(atom, rules_.description_.actions[symbol].argument_sorts, false)});
    return *this;
  }

  RuleReader& literal(const Literal& open, RuleLiteral::Role role)
  {
    const Literal literal = normalized(open, rules_.description_);
    const int symbol = rules_.fluentSymbol(literal.atom.name);
    const FluentDeclaration& fluent = rules_.description_.fluents[symbol];
    const bool is_static = fluent.kind == FluentKind::kStatic;
    RuleLiteral read{symbol, slots(literal.atom, fluent.argument_sorts, !is_static),
                     slot(literal.value, fluent.value_sort ? *fluent.value_sort : "", false),
                     literal.equal, role};
    (is_static ? rule_.statics : rule_.literals).push_back(std::move(read));
    return *this;
  }

  RuleReader& body(const Body& body)
  {
    for (const Condition& condition : body)
    {
      if (const auto* part = std::get_if<Literal>(&condition))
      {
        literal(*part, RuleLiteral::Role::kBody);
      }
      else if (const auto* comparison = std::get_if<Comparison>(&condition))
      {
        rule_.relations.push_back({slot(comparison->left, "", false), comparison->op,
                                   slot(comparison->right, "", false)});
      }
      else
      {
        const auto& membership = std::get<Membership>(condition);
        rule_.sort_tests.push_back(
            {rules_.sortIndex(membership.sort),
             slot(membership.term, membership.negated ? "" : membership.sort, false),
             membership.negated});
      }
    }
    return *this;
  }

  RuleReader& choice(const Body& body)
  {
    for (const Condition& condition : body)
    {
      if (const auto* part = std::get_if<Literal>(&condition))
      {
        literal(*part, RuleLiteral::Role::kChoice);
      }
    }
    return *this;
  }

  void anyAction() { rule_.any_action = true; }

  GroundableRule take() { return std::move(rule_); }

private:
  std::vector<Slot> slots(const Atom& atom, const std::vector<std::string>& sorts, bool in_fluent)
  {
    std::vector<Slot> slots;
    for (std::size_t i = 0; i < atom.arguments.size(); ++i)
    {
      slots.push_back(slot(atom.arguments[i], sorts[i], in_fluent));
    }
    return slots;
  }

  Slot slot(const Term& term, const std::string& sort, bool in_fluent)
  {
    if (!term.is_variable)
    {
      const auto found = rules_.constants_.emplace(term.name, rules_.names_.size());
      if (found.second)
      {
        rules_.names_.push_back(term.name);
      }
      return {false, found.first->second};
    }
    const auto [place, fresh] =
        variables_.emplace(term.name, static_cast<int>(rule_.in_fluent.size()));
    if (fresh)
    {
      rule_.in_fluent.push_back(false);
      rule_.variable_sorts.emplace_back();
    }
    const auto variable = static_cast<std::size_t>(place->second);
    rule_.in_fluent[variable] = rule_.in_fluent[variable] || in_fluent;
    if (!sort.empty())
    {
      rule_.variable_sorts[variable].push_back(rules_.sortIndex(sort));
    }
    return {true, place->second};
  }

  GroundRules& rules_;
  GroundableRule rule_;
  std::unordered_map<std::string, int> variables_;
};

GroundRules::GroundRules(const Description& description) : description_(description)
{
  for (const char* truth : {"false", "true"})
  {
    constants_.emplace(truth, static_cast<ConstantId>(names_.size()));
    names_.emplace_back(truth);
  }
  for (const Sort& sort : description.sorts)
  {
    sorts_.emplace(sort.name, static_cast<int>(elements_.size()));
    elements_.emplace_back();
    elements_.back().reserve(sort.elements.size());
    for (const std::string& element : sort.elements)
    {
      const auto [place, fresh] =
          constants_.emplace(element, static_cast<ConstantId>(names_.size()));
      if (fresh)
      {
        names_.push_back(element);
      }
      elements_.back().push_back(place->second);
    }
  }
  for (const auto& elements : elements_)
  {
    member_.emplace_back(names_.size(), false);
    for (const ConstantId element : elements)
    {
      member_.back()[element] = true;
    }
  }
  for (const FluentDeclaration& fluent : description.fluents)
  {
    fluents_.emplace(fluent.name, static_cast<int>(fluents_.size()));
  }
  for (const ActionDeclaration& action : description.actions)
  {
    actions_.emplace(action.name, static_cast<int>(actions_.size()));
  }
  of_fluent_.resize(fluents_.size());
  of_action_.resize(actions_.size());
  derived_static_.resize(fluents_.size(), false);
  using Kind = GroundableRule::Kind;
  using Role = RuleLiteral::Role;
  for (std::size_t i = 0; i < description.constraints.size(); ++i)
  {
    const StateConstraint& constraint = description.constraints[i];
    RuleReader reader(*this, Kind::kConstraint, i, constraint.position);
    if (constraint.head)
    {
      reader.literal(*constraint.head, Role::kHead);
      const int symbol = fluentSymbol(constraint.head->atom.name);
      derived_static_[symbol] = derived_static_[symbol] || isStatic(symbol);
    }
    add(reader.body(constraint.body).take());
  }
  for (std::size_t i = 0; i < description.causal_laws.size(); ++i)
  {
    const CausalLaw& law = description.causal_laws[i];
    RuleReader reader(*this, Kind::kLaw, i, law.position);
    reader.action(law.action).body(law.body);
    for (const Outcome& outcome : law.outcomes)
    {
      for (const Effect& effect : outcome.effects)
      {
        reader.literal({effect.fluent, effect.value, true}, Role::kEffect).choice(effect.choice);
      }
    }
    add(reader.take());
  }
  for (std::size_t i = 0; i < description.executabilities.size(); ++i)
  {
    const Executability& rule = description.executabilities[i];
    RuleReader reader(*this, Kind::kExecutability, i, rule.position);
    std::size_t num_variables = 0;
    for (const auto& action : rule.actions)
    {
      if (const auto* atom = std::get_if<Atom>(&action))
      {
        reader.action(*atom);
      }
      else
      {
        ++num_variables;
        reader.anyAction();
      }
    }
    const auto* unequal = rule.body.size() == 1 ? std::get_if<Comparison>(&rule.body[0]) : nullptr;
    serial_ = serial_ || (num_variables == 2 && rule.actions.size() == 2 && unequal != nullptr &&
                          unequal->op == Comparison::Operator::kNotEqual);
    if (num_variables > 0 && unequal != nullptr)
    {
      continue;  // says nothing about fluents
    }
    add(reader.body(rule.body).take());
  }
  for (std::size_t i = 0; i < description.defaults.size(); ++i)
  {
    const Default& rule = description.defaults[i];
    add(RuleReader(*this, Kind::kDefault, i, rule.position)
            .literal(rule.head, Role::kHead)
            .body(rule.body)
            .take());
  }
  for (std::size_t i = 0; i < description.costs.size(); ++i)
  {
    const ActionCost& cost = description.costs[i];
    add(RuleReader(*this, Kind::kCost, i, cost.position)
            .action(cost.action)
            .body(cost.body)
            .take());
  }
  for (const Literal& fact : description.static_facts)
  {
    if (fact.equal)
    {
      facts_[ground(fact.atom, false)] = constant(fact.value.name);
    }
  }
}

void GroundRules::add(GroundableRule rule)
{
  const std::size_t index = rules_.size();
  const auto note = [index](std::vector<std::size_t>& list) {
    if (list.empty() || list.back() != index)
    {
      list.push_back(index);
    }
  };
  for (const RuleLiteral& literal : rule.literals)
  {
    note(of_fluent_[literal.symbol]);
  }
  for (const RuleAction& action : rule.actions)
  {
    note(of_action_[action.symbol]);
  }
  if (rule.any_action)
  {
    note(any_action_);
  }
  rules_.push_back(std::move(rule));
}

const std::vector<std::size_t>& GroundRules::rulesOfFluent(int symbol) const
{
  return of_fluent_[symbol];
}

const std::vector<std::size_t>& GroundRules::rulesOfAction(int symbol) const
{
  return of_action_[symbol];
}

ConstantId GroundRules::constant(const std::string& name) const
{
  const auto found = constants_.find(name);
  return found == constants_.end() ? kUnbound : found->second;
}

bool GroundRules::inSort(ConstantId constant, int sort) const
{
  return static_cast<std::size_t>(constant) < member_[sort].size() && member_[sort][constant];
}

bool GroundRules::isStatic(int symbol) const
{
  return description_.fluents[symbol].kind == FluentKind::kStatic;
}

bool GroundRules::isDefined(int symbol) const
{
  return description_.fluents[symbol].kind == FluentKind::kDefined;
}

GroundAtom GroundRules::ground(const Atom& atom, bool is_action) const
{
  GroundAtom ground{is_action ? actionSymbol(atom.name) : fluentSymbol(atom.name), {}};
  for (const Term& argument : atom.arguments)
  {
    ground.arguments.push_back(constant(argument.name));
  }
  return ground;
}

namespace
{

std::string textOf(const std::string& name, const std::vector<std::string>& arguments)
{
  std::string text = name;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    text += (i == 0 ? "(" : ", ") + arguments[i];
  }
  return arguments.empty() ? text : text + ")";
}

}  // namespace

std::string GroundRules::fluentText(const GroundAtom& fluent) const
{
  std::vector<std::string> arguments;
  for (const ConstantId argument : fluent.arguments)
  {
    arguments.push_back(argument == kUnbound ? "_" : names_[argument]);
  }
  return textOf(description_.fluents[fluent.symbol].name, arguments);
}

std::string GroundRules::actionText(const GroundAtom& action) const
{
  std::vector<std::string> arguments;
  for (const ConstantId argument : action.arguments)
  {
    arguments.push_back(argument == kUnbound ? "_" : names_[argument]);
  }
  return textOf(description_.actions[action.symbol].name, arguments);
}

std::string GroundRules::literalText(const RuleLiteral& literal, const RuleBinding& binding) const
{
  const std::string fluent = fluentText(bound(literal, binding));
  const ConstantId value = bound(literal.value, binding);
  const FluentDeclaration& declared = description_.fluents[literal.symbol];
  if (!declared.value_sort)
  {
    return (names_[value] == "true") == literal.equal ? fluent : "-" + fluent;
  }
  const std::string text = value == kUnbound ? "_" : names_[value];
  if (declared.predicate_form && text != declared.no_value)
  {
    const std::string open =
        declared.argument_sorts.empty() ? fluent + "(" : fluent.substr(0, fluent.size() - 1) + ", ";
    return (literal.equal ? "" : "-") + open + text + ")";
  }
  return fluent + (literal.equal ? " = " : " != ") + text;
}

ConstantId GroundRules::bound(const Slot& slot, const RuleBinding& binding)
{
  return slot.is_variable ? binding[slot.id] : slot.id;
}

GroundAtom GroundRules::bound(const RuleLiteral& literal, const RuleBinding& binding)
{
  GroundAtom atom{literal.symbol, {}};
  atom.arguments.reserve(literal.arguments.size());
  for (const Slot& slot : literal.arguments)
  {
    atom.arguments.push_back(bound(slot, binding));
  }
  return atom;
}

bool GroundRules::isBound(const RuleLiteral& literal, const RuleBinding& binding)
{
  return std::all_of(literal.arguments.begin(), literal.arguments.end(),
                     [&](const Slot& slot) { return bound(slot, binding) != kUnbound; });
}

bool GroundRules::unify(const GroundableRule& rule, const std::vector<Slot>& slots,
                        const std::vector<ConstantId>& constants, RuleBinding& binding) const
{
  if (binding.empty())
  {
    binding.assign(rule.in_fluent.size(), kUnbound);
  }
  for (std::size_t i = 0; i < slots.size(); ++i)
  {
    if (constants[i] == kUnbound)
    {
      continue;
    }
    if (!slots[i].is_variable)
    {
      if (slots[i].id != constants[i])
      {
        return false;
      }
      continue;
    }
    ConstantId& value = binding[slots[i].id];
    if (value != kUnbound && value != constants[i])
    {
      return false;
    }
    for (const int sort : rule.variable_sorts[slots[i].id])
    {
      if (!inSort(constants[i], sort))
      {
        return false;
      }
    }
    value = constants[i];
  }
  return true;
}

bool GroundRules::refuted(const RuleLiteral& literal, const RuleBinding& binding) const
{
  if (derived_static_[literal.symbol] || !isBound(literal, binding))
  {
    return false;
  }
  const auto found = facts_.find(bound(literal, binding));
  const ConstantId value = bound(literal.value, binding);
  if (!description_.fluents[literal.symbol].value_sort)
  {
    const bool is_true = found != facts_.end() && names_[found->second] == "true";
    return is_true != ((names_[value] == "true") == literal.equal);
  }
  if (found == facts_.end())
  {
    return literal.equal;  // it has no value
  }
  return value != kUnbound && (found->second == value) != literal.equal;
}

bool GroundRules::refuted(const GroundableRule& rule, const RuleBinding& binding) const
{
  for (const auto& relation : rule.relations)
  {
    const ConstantId left = bound(relation.left, binding);
    const ConstantId right = bound(relation.right, binding);
    if (left != kUnbound && right != kUnbound && !holds(names_[left], relation.op, names_[right]))
    {
      return true;
    }
  }
  for (const auto& test : rule.sort_tests)
  {
    const ConstantId term = bound(test.term, binding);
    if (term != kUnbound && inSort(term, test.sort) == test.negated)
    {
      return true;
    }
  }
  return std::any_of(rule.statics.begin(), rule.statics.end(), [&](const RuleLiteral& literal) {
    return literal.role == RuleLiteral::Role::kBody && refuted(literal, binding);
  });
}

void GroundRules::forEachInstance(
    const GroundableRule& rule, const RuleBinding& binding, const std::vector<bool>& also,
    const std::function<bool(const RuleLiteral&, const RuleBinding&)>& is_false,
    const std::function<void(const RuleBinding&)>& visit) const
{
  if (refuted(rule, binding))
  {
    return;
  }
  for (const RuleLiteral& literal : rule.literals)
  {
    if (literal.role == RuleLiteral::Role::kBody && isBound(literal, binding) &&
        is_false(literal, binding))
    {
      return;
    }
  }
  std::size_t variable = 0;
  while (variable < binding.size() &&
         (binding[variable] != kUnbound ||
          !(rule.in_fluent[variable] || (variable < also.size() && also[variable]))))
  {
    ++variable;
  }
  if (variable == binding.size())
  {
    visit(binding);
    return;
  }
  const std::vector<int>& sorts = rule.variable_sorts[variable];
  const int smallest = *std::min_element(sorts.begin(), sorts.end(), [&](int a, int b) {
    return elements_[a].size() < elements_[b].size();
  });
  RuleBinding longer = binding;
  for (const ConstantId element : elements_[smallest])
  {
    if (std::all_of(sorts.begin(), sorts.end(), [&](int sort) { return inSort(element, sort); }))
    {
      longer[variable] = element;
      forEachInstance(rule, longer, also, is_false, visit);
    }
  }
}

}  // namespace kr3::reasoner
