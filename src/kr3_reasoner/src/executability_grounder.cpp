#include <algorithm>
#include <memory>
#include <unordered_map>

#include "step_parts.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = StepProgram::AtomId;

/// A condition with variables of its own, said apart as an atom for each value of the others:
/// `impossible grasp(R, O) if in_hand(R, O2)` has then as many ground rules as objects, not as
/// pairs of objects.
class SomeInstance
{
public:
  SomeInstance(const StepContext& context, const Literal& literal,
               const std::vector<std::string>& shared, ConditionReader& outer)
    : context_(context), body_(context)
  {
    body_.addBefore(Condition(literal));
    std::vector<bool> given(body_.reader().variables().size(), false);
    for (const std::string& name : shared)
    {
      inner_.push_back(body_.reader().variable(name));
      const auto variable = static_cast<std::size_t>(inner_.back());
      for (const int sort : body_.reader().conditions().variable_sorts[variable])
      {
        outer_.resize(inner_.size());
        outer_.back() = outer.slot({true, name}, sort).id;
      }
      given[variable] = true;
    }
    std::vector<bool> wanted(given.size(), true);
    join_ = std::make_unique<Join>(body_.reader().conditions(), context.statics, given, wanted,
                                   context.limit);
  }

  void markShared(std::vector<bool>& variables) const
  {
    for (const int variable : outer_)
    {
      variables[static_cast<std::size_t>(variable)] = true;
    }
  }

  /// The atom for the shared variables' values, or 0 when there is no instance.
  AtomId atom(const RuleBinding& binding)
  {
    std::vector<ConstantId> key;
    RuleBinding start(body_.reader().variables().size(), kUnbound);
    for (std::size_t i = 0; i < inner_.size(); ++i)
    {
      key.push_back(binding[static_cast<std::size_t>(outer_[i])]);
      start[static_cast<std::size_t>(inner_[i])] = key.back();
    }
    const auto [place, fresh] = atoms_.emplace(std::move(key), 0);
    if (fresh)
    {
      std::vector<std::int32_t> literals;
      join_->forEach(start, [&, &atom = place->second](const RuleBinding& instance) {
        literals.clear();
        if (body_.write(instance, literals))
        {
          atom = atom == 0 ? context_.atoms.fresh() : atom;
          context_.program.executability.addRule(
              false, {&atom, &atom + 1}, {literals.data(), literals.data() + literals.size()});
        }
      });
    }
    return place->second;
  }

private:
  const StepContext& context_;
  StepBody body_;
  std::vector<int> inner_;  // the shared variables here
  std::vector<int> outer_;  // and in the rule
  std::unique_ptr<Join> join_;
  std::unordered_map<std::vector<ConstantId>, AtomId, ConstantsHash> atoms_;
};

/// The numbers of all agent actions.
std::vector<int> agentActions(const StepContext& context)
{
  std::vector<int> actions;
  const auto& declared = context.vocabulary.description().actions;
  for (std::size_t symbol = 0; symbol < declared.size(); ++symbol)
  {
    if (!declared[symbol].exogenous)
    {
      const std::size_t first = context.signature.firstAction(static_cast<int>(symbol));
      for (std::size_t i = 0; i < context.signature.numInstances(static_cast<int>(symbol)); ++i)
      {
        actions.push_back(static_cast<int>(first + i));
      }
    }
  }
  return actions;
}

/// The comparisons of a rule's action variables, and the instances of the rest of its body.
class ActionVariables
{
public:
  ActionVariables(const StepContext& context, const Executability& rule) : context_(context)
  {
    for (const auto& action : rule.actions)
    {
      const auto* variable = std::get_if<Term>(&action);
      if (variable != nullptr &&
          std::find(names_.begin(), names_.end(), variable->name) == names_.end())
      {
        names_.push_back(variable->name);
      }
    }
    for (const Condition& condition : rule.body)
    {
      const auto* comparison = std::get_if<Comparison>(&condition);
      if (comparison != nullptr &&
          (number(comparison->left) >= 0 || number(comparison->right) >= 0))
      {
        comparisons_.push_back(*comparison);
      }
      else
      {
        rest_.push_back(condition);
      }
    }
  }

  [[nodiscard]] const Body& rest() const { return rest_; }

  /// Object variables that are compared with actions.
  [[nodiscard]] std::set<std::string> compared() const
  {
    std::set<std::string> names;
    for (const Comparison& comparison : comparisons_)
    {
      for (const Term* term : {&comparison.left, &comparison.right})
      {
        if (term->is_variable && number(*term) < 0)
        {
          names.insert(term->name);
        }
      }
    }
    return names;
  }

  [[nodiscard]] int number(const Term& term) const
  {
    const auto found = std::find(names_.begin(), names_.end(), term.name);
    return !term.is_variable || found == names_.end() ? -1
                                                      : static_cast<int>(found - names_.begin());
  }

  /// Calls `visit` with each choice of an agent action for each variable that agrees with the
  /// comparisons under a binding of the others.
  template <typename Visit>
  void forEach(const ConditionReader& reader, const RuleBinding& binding, const Visit& visit) const
  {
    std::vector<int> chosen;
    const std::vector<int> agent = agentActions(context_);
    choose(agent, reader, binding, chosen, visit);
  }

private:
  template <typename Visit>
  void choose(const std::vector<int>& agent, const ConditionReader& reader,
              const RuleBinding& binding, std::vector<int>& chosen, const Visit& visit) const
  {
    if (chosen.size() == names_.size())
    {
      visit(chosen);
      return;
    }
    for (const int action : agent)
    {
      chosen.push_back(action);
      if (agrees(reader, binding, chosen))
      {
        choose(agent, reader, binding, chosen, visit);
      }
      chosen.pop_back();
    }
  }

  [[nodiscard]] bool agrees(const ConditionReader& reader, const RuleBinding& binding,
                            const std::vector<int>& chosen) const
  {
    return std::all_of(comparisons_.begin(), comparisons_.end(), [&](const Comparison& comparison) {
      const int left = number(comparison.left);
      const int right = number(comparison.right);
      const auto last = static_cast<int>(chosen.size()) - 1;
      if (std::max(left, right) > last)
      {
        return true;  // later
      }
      bool equal = left == right;
      if (left >= 0 && right >= 0)
      {
        equal = chosen[static_cast<std::size_t>(left)] == chosen[static_cast<std::size_t>(right)];
      }
      else
      {
        const Term& other = left >= 0 ? comparison.right : comparison.left;
        const int action = chosen[static_cast<std::size_t>(std::max(left, right))];
        equal = isNamed(action,
                        other.is_variable
                            ? context_.vocabulary.name(
                                  binding[static_cast<std::size_t>(reader.variable(other.name))])
                            : other.name);
      }
      return equal == (comparison.op == Comparison::Operator::kEqual);
    });
  }

  /// Whether it is the action of this name, without arguments.
  [[nodiscard]] bool isNamed(int action, const std::string& name) const
  {
    const Description& description = context_.vocabulary.description();
    const ActionDeclaration* declared = description.findAction(name);
    return declared != nullptr && declared->argument_sorts.empty() &&
           static_cast<int>(
               context_.signature.firstAction(context_.vocabulary.actionSymbol(name))) == action;
  }

  const StepContext& context_;
  std::vector<std::string> names_;
  std::vector<Comparison> comparisons_;
  Body rest_;
};

}  // namespace

void groundExecutability(const StepContext& context, const Executability& rule)
{
  if (rule.actions.size() != 1)
  {
    return;
  }
  const auto* atom = std::get_if<Atom>(&rule.actions[0]);
  if (atom != nullptr && !context.signature.hasAction(context.vocabulary.actionSymbol(atom->name)))
  {
    return;
  }
  const ActionVariables variables(context, rule);
  std::set<std::string> used = variables.compared();
  if (atom != nullptr)
  {
    used.merge(variablesOf(atom->arguments));
  }
  const std::map<std::string, int> uses = variableUses(rule.body);
  StepBody body(context);
  const std::vector<Slot> arguments =
      atom != nullptr ? body.reader().action(*atom) : std::vector<Slot>{};
  Body together;
  struct Apart
  {
    const Literal* literal;
    std::vector<std::string> shared;
  };
  std::vector<Apart> apart;
  for (const Condition& condition : variables.rest())
  {
    const auto* literal = std::get_if<Literal>(&condition);
    bool has_own = false;
    std::vector<std::string> shared;
    if (literal != nullptr &&
        context.vocabulary.description().findFluent(literal->atom.name)->kind !=
            FluentKind::kStatic)
    {
      std::vector<Term> terms = literal->atom.arguments;
      terms.push_back(literal->value);
      for (const std::string& variable : variablesOf(terms))
      {
        const bool own = used.count(variable) == 0 && uses.at(variable) == 1;
        has_own = has_own || own;
        if (!own)
        {
          shared.push_back(variable);
        }
      }
    }
    if (has_own)
    {
      apart.push_back({literal, std::move(shared)});
    }
    else
    {
      together.push_back(condition);
    }
  }
  body.addBefore(together, used);
  std::vector<std::unique_ptr<SomeInstance>> some;
  for (const Apart& part : apart)
  {
    some.push_back(
        std::make_unique<SomeInstance>(context, *part.literal, part.shared, body.reader()));
  }
  std::vector<bool> wanted(body.reader().variables().size(), false);
  markVariables(arguments, wanted);
  for (const std::string& name : variables.compared())
  {
    wanted[static_cast<std::size_t>(body.reader().variable(name))] = true;
  }
  for (const auto& part : some)
  {
    part->markShared(wanted);
  }
  std::vector<std::int32_t> literals;
  const auto addRule = [&](int action) {
    AtomId& impossible = context.program.impossible[static_cast<std::size_t>(action)];
    impossible = impossible == 0 ? context.atoms.fresh() : impossible;
    context.program.executability.addRule(false, {&impossible, &impossible + 1},
                                          {literals.data(), literals.data() + literals.size()});
  };
  body.forEach(wanted, [&](const RuleBinding& binding) {
    literals.clear();
    if (!body.write(binding, literals))
    {
      return;
    }
    for (const auto& part : some)
    {
      const AtomId instance = part->atom(binding);
      if (instance == 0)
      {
        return;
      }
      literals.push_back(static_cast<std::int32_t>(instance));
    }
    if (atom != nullptr)
    {
      addRule(context.signature.action(context.vocabulary.actionSymbol(atom->name), arguments,
                                       binding));
      return;
    }
    variables.forEach(body.reader(), binding,
                      [&](const std::vector<int>& chosen) { addRule(chosen.front()); });
  });
}

void groundExclusion(const StepContext& context, const Executability& rule)
{
  if (rule.actions.size() == 1)
  {
    return;
  }
  if (isPairwiseExclusion(rule))
  {
    std::vector<GroundProgram::BodyLiteral> occurrences;
    for (const int action : agentActions(context))
    {
      occurrences.push_back({static_cast<std::int32_t>(context.atoms.occurs(action)), 1});
    }
    context.program.effects.addWeightRule(
        false, {nullptr, nullptr}, 2,
        {occurrences.data(), occurrences.data() + occurrences.size()});
    return;
  }
  const ActionVariables variables(context, rule);
  std::set<std::string> used = variables.compared();
  StepBody body(context);
  struct Named
  {
    int symbol;
    std::vector<Slot> arguments;
  };
  std::vector<Named> named;
  std::vector<int> chosen_variables;  // of the actions that are variables
  for (const auto& action : rule.actions)
  {
    const auto* atom = std::get_if<Atom>(&action);
    if (atom == nullptr)
    {
      chosen_variables.push_back(variables.number(std::get<Term>(action)));
      continue;
    }
    const int symbol = context.vocabulary.actionSymbol(atom->name);
    if (!context.signature.hasAction(symbol))
    {
      return;
    }
    named.push_back({symbol, body.reader().action(*atom)});
    used.merge(variablesOf(atom->arguments));
  }
  body.addBefore(variables.rest(), used);
  std::vector<bool> wanted(body.reader().variables().size(), false);
  for (const Named& action : named)
  {
    markVariables(action.arguments, wanted);
  }
  for (const std::string& name : variables.compared())
  {
    wanted[static_cast<std::size_t>(body.reader().variable(name))] = true;
  }
  std::vector<std::int32_t> literals;
  body.forEach(wanted, [&](const RuleBinding& binding) {
    literals.clear();
    if (!body.write(binding, literals))
    {
      return;
    }
    for (const Named& action : named)
    {
      literals.push_back(static_cast<std::int32_t>(context.atoms.occurs(
          context.signature.action(action.symbol, action.arguments, binding))));
    }
    const std::size_t fixed = literals.size();
    variables.forEach(body.reader(), binding, [&](const std::vector<int>& chosen) {
      literals.resize(fixed);
      for (const int variable : chosen_variables)
      {
        literals.push_back(static_cast<std::int32_t>(
            context.atoms.occurs(chosen[static_cast<std::size_t>(variable)])));
      }
      context.program.effects.addRule(false, {nullptr, nullptr},
                                      {literals.data(), literals.data() + literals.size()});
    });
  });
}

}  // namespace kr3::reasoner
