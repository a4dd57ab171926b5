#include "relaxed_reach.hpp"

#include <algorithm>

#include "ground_fluents.hpp"

namespace kr3::reasoner
{

namespace
{

using Kind = GroundableRule::Kind;
using Role = RuleLiteral::Role;

const auto kAnything = [](const RuleLiteral&, const RuleBinding&) { return false; };

GroundAtom atomOf(const GroundRules& rules, const Clingo::Symbol& symbol, int number)
{
  GroundAtom atom{number, {}};
  if (symbol.type() == Clingo::SymbolType::Function)
  {
    for (const Clingo::Symbol& argument : symbol.arguments())
    {
      atom.arguments.push_back(rules.constant(argument.to_string()));
    }
  }
  return atom;
}

}  // namespace

RelaxedReach::RelaxedReach(const PlanningProblem& problem)
  : problem_(problem), rules_(problem.description), encoding_(problem.description)
{
  Solver solver({"1", "--warn=none"});
  solver.add("base", {}, encoding_.signature() + program());
  solver.ground({{"base", {}}});
  for (const Clingo::Model& model : solver.control().solve())
  {
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      const Clingo::Symbol what = symbol.arguments()[0];
      if (symbol.match("r", 2))
      {
        values_[atomOf(rules_, what, rules_.fluentSymbol(what.name()))].insert(
            rules_.constant(symbol.arguments()[1].to_string()));
      }
      else
      {
        actions_.insert(atomOf(rules_, what, rules_.actionSymbol(what.name())));
      }
    }
  }
}

// ---- The program: r(F, V): F = V may be reached; ract(A): A may be executed ----

std::string RelaxedReach::relaxed(const Literal& open) const
{
  const Literal literal = normalized(open, problem_.description);
  const FluentDeclaration& fluent = *problem_.description.findFluent(literal.atom.name);
  if (fluent.kind == FluentKind::kStatic)
  {
    return encoding_.literal(literal, "0");
  }
  if (fluent.kind == FluentKind::kDefined && literal.value.name == "false")
  {
    return "#true";
  }
  const std::string text = "r(" + Encoding::term(literal.atom) + ",";
  return literal.equal ? text + literal.value.name + ")"
                       : "1 { " + text + "_U) : _U != " + literal.value.name + ", fv(" +
                             Encoding::term(literal.atom) + ",_U) }";
}

std::string RelaxedReach::contrary(const Literal& open) const
{
  Literal literal = normalized(open, problem_.description);
  const bool boolean = !problem_.description.findFluent(literal.atom.name)->value_sort;
  if (boolean)
  {
    literal.value.name = literal.value.name == "true" ? "false" : "true";
  }
  else
  {
    literal.equal = !literal.equal;
  }
  return relaxed(literal);
}

std::string RelaxedReach::relaxed(const Body& body) const
{
  std::string text;
  for (const Condition& condition : body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    text += literal != nullptr ? ", " + relaxed(*literal) : encoding_.body({condition}, "0");
  }
  return text;
}

std::string RelaxedReach::executabilityRules() const
{
  std::string text;
  int number = 0;
  for (const Executability& rule : problem_.description.executabilities)
  {
    if (rule.actions.size() != 1)
    {
      continue;
    }
    Encoding::Guards guards(problem_.description);
    guards.body(rule.body);
    const auto* atom = std::get_if<Atom>(&rule.actions[0]);
    const std::string action =
        atom != nullptr ? Encoding::term(*atom) : std::get<Term>(rule.actions[0]).name;
    if (atom != nullptr)
    {
      guards.action(*atom);
    }
    std::string instance = std::to_string(number++);
    for (const std::string& variable : guards.variables())
    {
      instance += "," + variable;
    }
    Body fixed;
    std::string ways;
    for (const Condition& condition : rule.body)
    {
      const auto* literal = std::get_if<Literal>(&condition);
      if (literal == nullptr ||
          problem_.description.findFluent(literal->atom.name)->kind == FluentKind::kStatic)
      {
        fixed.push_back(condition);
      }
      else
      {
        ways += "ok(" + action + ",(" + instance + ")) :- inst(" + action + ",(" + instance +
                ")), " + contrary(*literal) + ".\n";
      }
    }
    text += "inst(" + action + ",(" + instance + ")) :- agent(" + action + ")" + guards.text() +
            encoding_.body(fixed, "0") + ".\n" + ways;
  }
  return text;
}

std::string RelaxedReach::program() const
{
  std::string text;
  for (const GroundFluent& fluent : groundFluents(problem_.description))
  {
    Literal literal;
    literal.atom.name = fluent.symbol;
    for (const std::string& argument : fluent.arguments)
    {
      literal.atom.arguments.push_back({false, argument});
    }
    for (const std::string& value : fluent.values)
    {
      literal.value.name = value;
      if (problem_.consequences.inSome(literal, problem_.now))
      {
        text += "r(" + Encoding::term(literal.atom) + "," + value + ").\n";
      }
    }
  }
  for (const CausalLaw& law : problem_.description.causal_laws)
  {
    for (const Outcome& outcome : law.outcomes)
    {
      for (const Effect& effect : outcome.effects)
      {
        Encoding::Guards guards(problem_.description);
        guards.action(law.action).body(law.body).literal({effect.fluent, effect.value, true});
        guards.body(effect.choice);
        text += "r(" + Encoding::term(effect.fluent) + "," + effect.value.name + ") :- ract(" +
                Encoding::term(law.action) + ")" + guards.text() + relaxed(law.body) +
                relaxed(effect.choice) + ".\n";
      }
    }
  }
  for (const StateConstraint& constraint : problem_.description.constraints)
  {
    if (!constraint.head)
    {
      continue;
    }
    const Literal head = normalized(*constraint.head, problem_.description);
    if (head.equal && problem_.description.findFluent(head.atom.name)->kind != FluentKind::kStatic)
    {
      Encoding::Guards guards(problem_.description);
      guards.literal(head).body(constraint.body);
      text += "r(" + Encoding::term(head.atom) + "," + head.value.name + ") :- #true" +
              guards.text() + relaxed(constraint.body) + ".\n";
    }
  }
  return text + executabilityRules() +
         "ract(_A) :- agent(_A), ok(_A,_I) : inst(_A,_I).\n"
         "#defined inst/2. #defined ok/2. #defined r/2. #defined ract/1.\n"
         "#show r/2. #show ract/1.\n";
}

// ---- Reasons ----

bool RelaxedReach::mayHold(const GroundAtom& fluent, ConstantId value, bool equal) const
{
  if (rules_.isStatic(fluent.symbol) ||
      (rules_.isDefined(fluent.symbol) && value == rules_.constant("false")))
  {
    return true;  // a static that is false makes the goal false in every state
  }
  const auto found = values_.find(fluent);
  if (found == values_.end())
  {
    return false;
  }
  return equal ? found->second.count(value) > 0 : found->second.size() > found->second.count(value);
}

std::optional<std::string> RelaxedReach::whyUnreachable(const Formula& formula) const
{
  return why(formula, true);
}

std::optional<std::string> RelaxedReach::why(const Formula& formula, bool wanted) const
{
  if (formula.kind == Formula::Kind::kNot)
  {
    return why(formula.operands[0], !wanted);
  }
  if (formula.kind != Formula::Kind::kLiteral)
  {
    const bool all = (formula.kind == Formula::Kind::kAnd) == wanted;
    std::optional<std::string> reason;
    for (const Formula& operand : formula.operands)
    {
      std::optional<std::string> here = why(operand, wanted);
      if (all ? here.has_value() : !here.has_value())
      {
        return here;
      }
      reason = std::move(here);
    }
    return reason;
  }
  const Literal literal = wanted ? normalized(formula.literal, problem_.description)
                                 : kr3::reasoner::contrary(formula.literal, problem_.description);
  const GroundAtom fluent = rules_.ground(literal.atom, false);
  const ConstantId value = rules_.constant(literal.value.name);
  if (mayHold(fluent, value, literal.equal))
  {
    return std::nullopt;
  }
  Visited visited;
  return why(fluent, value, literal.equal, visited);
}

std::string RelaxedReach::text(const GroundAtom& fluent, ConstantId value, bool equal) const
{
  RuleLiteral literal{fluent.symbol, {}, {false, value}, equal, Role::kBody};
  for (const ConstantId argument : fluent.arguments)
  {
    literal.arguments.push_back({false, argument});
  }
  return rules_.literalText(literal, {});
}

/// Why a literal that cannot be reached cannot: the first way to it, and what that lacks.
std::string RelaxedReach::why(const GroundAtom& fluent, ConstantId value, bool equal,
                              Visited& visited) const
{
  const std::string literal = text(fluent, value, equal);
  visited.insert(literal);
  for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    for (const RuleLiteral& head : rule.literals)
    {
      const bool brings =
          head.symbol == fluent.symbol &&
          ((rule.kind == Kind::kConstraint && head.role == Role::kHead && head.equal) ||
           (rule.kind == Kind::kLaw && head.role == Role::kEffect &&
            !problem_.description.actions[rule.actions[0].symbol].exogenous));
      if (brings)
      {
        if (auto here = whyNot(rule, head, fluent, value, equal, visited))
        {
          return literal + " can never hold: " + *here;
        }
      }
    }
  }
  return literal +
         " can never hold: it is false now, and no action or state constraint can bring "
         "it about";
}

/// Why a rule that could bring a literal about never does; nothing when it could not anyway.
std::optional<std::string> RelaxedReach::whyNot(const GroundableRule& rule,
                                                const RuleLiteral& literal,
                                                const GroundAtom& fluent, ConstantId value,
                                                bool equal, Visited& visited) const
{
  RuleBinding binding;
  if (!rules_.unify(rule, literal.arguments, fluent.arguments, binding) ||
      (equal && !rules_.unify(rule, {literal.value}, {value}, binding)))
  {
    return std::nullopt;
  }
  std::optional<std::string> reason;
  const std::vector<bool> all(rule.in_fluent.size(), true);
  rules_.forEachInstance(rule, binding, all, kAnything, [&](const RuleBinding& instance) {
    if (reason || (!equal && GroundRules::bound(literal.value, instance) == value))
    {
      return;
    }
    if (rule.kind == Kind::kLaw)
    {
      GroundAtom action{rule.actions[0].symbol, {}};
      for (const Slot& slot : rule.actions[0].arguments)
      {
        action.arguments.push_back(GroundRules::bound(slot, instance));
      }
      if (actions_.count(action) == 0)
      {
        reason = rules_.actionText(action) + " would bring it about, but is never possible" +
                 whyImpossible(action);
        return;
      }
    }
    for (const RuleLiteral& part : rule.literals)
    {
      const GroundAtom other = GroundRules::bound(part, instance);
      const ConstantId needed = GroundRules::bound(part.value, instance);
      if (part.role != Role::kBody || mayHold(other, needed, part.equal) ||
          visited.count(text(other, needed, part.equal)) > 0)
      {
        continue;
      }
      reason = "it needs " + text(other, needed, part.equal) + "; " +
               why(other, needed, part.equal, visited);
      return;
    }
  });
  return reason;
}

/// The executability condition that always forbids an action.
std::string RelaxedReach::whyImpossible(const GroundAtom& action) const
{
  std::string text;
  for (const std::size_t index : rules_.rulesOfAction(action.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    RuleBinding binding;
    if (!text.empty() || rule.kind != Kind::kExecutability || rule.actions.size() != 1 ||
        rule.any_action ||
        !rules_.unify(rule, rule.actions[0].arguments, action.arguments, binding))
    {
      continue;
    }
    rules_.forEachInstance(rule, binding, std::vector<bool>(rule.in_fluent.size(), true), kAnything,
                           [&](const RuleBinding& instance) {
      const bool avoidable = std::any_of(rule.literals.begin(), rule.literals.end(),
                                         [&](const RuleLiteral& literal) {
        const FluentDeclaration& fluent = problem_.description.fluents[literal.symbol];
        const ConstantId value = GroundRules::bound(literal.value, instance);
        const ConstantId other = rules_.constant(rules_.name(value) == "true" ? "false" : "true");
        return fluent.value_sort
                   ? mayHold(GroundRules::bound(literal, instance), value, !literal.equal)
                   : mayHold(GroundRules::bound(literal, instance), other, true);
      });
      if (avoidable || !text.empty())
      {
        return;
      }
      for (const RuleLiteral& literal : rule.literals)
      {
        text += (text.empty() ? ": always " : ", ") + rules_.literalText(literal, instance);
      }
      text = text.empty() ? ": it is forbidden in every state" : text;
      if (rule.position.line > 0)
      {
        text += " (" + rule.position.file + ":" + std::to_string(rule.position.line) + ")";
      }
    });
  }
  return text;
}

}  // namespace kr3::reasoner
