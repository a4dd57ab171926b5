#include "check.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_set>
#include <utility>

#include "asp_check.hpp"
#include "definition_check.hpp"
#include "preferences.hpp"
#include "scope.hpp"
#include "sort_completion.hpp"

namespace kr3::reasoner
{

namespace
{

class Checker
{
public:
  /// @param description  with completed sorts; must outlive the checker
  Checker(const Description& description, std::vector<Diagnostic>& problems)
    : description_(description), symbols_(description), problems_(problems)
  {
  }

  void run()
  {
    checkNames();
    checkDeclarations();
    for (const CausalLaw& law : description_.causal_laws)
    {
      checkLaw(law);
    }
    for (const StateConstraint& constraint : description_.constraints)
    {
      checkConstraint(constraint);
    }
    for (const Executability& rule : description_.executabilities)
    {
      checkExecutability(rule);
    }
    checkObservations();
    checkFacts();
    checkDefaults();
    checkCosts();
  }

private:
  void report(const SourcePosition& position, const std::string& message)
  {
    problems_.push_back({position, message});
  }

  void checkNames()
  {
    struct First
    {
      std::string what;
      int line;
    };
    std::map<std::string, First> seen;
    const auto declare =
        [&](const std::string& name, const std::string& what, const SourcePosition& position) {
      const auto [place, fresh] = seen.emplace(name, First{what, position.line});
      if (!fresh)
      {
        const First& first = place->second;
        report(position, "'" + name + "' is declared twice, first as " + first.what +
                             (first.line > 0 ? " in line " + std::to_string(first.line) : ""));
      }
    };
    for (const Sort& sort : description_.sorts)
    {
      declare(sort.name, "a sort", sort.position);
    }
    for (const FluentDeclaration& fluent : description_.fluents)
    {
      declare(fluent.name, fluent.kind == FluentKind::kStatic ? "a static" : "a fluent",
              fluent.position);
    }
    for (const ActionDeclaration& action : description_.actions)
    {
      declare(action.name, "an action", action.position);
    }
  }

  void checkSort(const std::string& name, const SourcePosition& position)
  {
    if (symbols_.sort(name) == nullptr)
    {
      constexpr std::size_t kEnough = 100;  // looking is slow, and nobody reads that far
      report(position,
             "unknown sort '" + name + "'" +
                 (problems_.size() < kEnough ? suggestion(name, symbols_.sortNames()) : ""));
    }
  }

  void checkDeclarations()
  {
    for (const FluentDeclaration& fluent : description_.fluents)
    {
      for (const std::string& sort : fluent.argument_sorts)
      {
        checkSort(sort, fluent.position);
      }
      if (fluent.value_sort)
      {
        checkSort(*fluent.value_sort, fluent.position);
        if (fluent.kind == FluentKind::kDefined || fluent.kind == FluentKind::kKnowledge)
        {
          report(fluent.position,
                 "the fluent " + fluent.name + " has values of sort " + *fluent.value_sort +
                     ", expected a boolean one: defined and knowledge fluents are boolean");
        }
      }
    }
    for (const ActionDeclaration& action : description_.actions)
    {
      for (const std::string& sort : action.argument_sorts)
      {
        checkSort(sort, action.position);
      }
    }
    for (const Magnification& magnification : description_.magnifications)
    {
      checkSort(magnification.coarse, magnification.position);
    }
  }

  void checkEffect(const Effect& effect, Scope& scope)
  {
    const FluentDeclaration* fluent = scope.useLiteral({effect.fluent, effect.value, true});
    if (fluent != nullptr &&
        (fluent->kind == FluentKind::kDefined || fluent->kind == FluentKind::kStatic))
    {
      report(effect.fluent.position,
             std::string("found the ") +
                 (fluent->kind == FluentKind::kDefined ? "defined fluent " : "static ") +
                 fluent->name + " as an effect, expected an inertial or knowledge fluent");
    }
    scope.useBody(effect.choice);
  }

  void checkLaw(const CausalLaw& law)
  {
    Scope scope(symbols_, law.position, problems_);
    scope.useAction(law.action);
    scope.useBody(law.body);
    std::set<std::string> labels;
    for (const Outcome& outcome : law.outcomes)
    {
      if (law.outcomes.size() > 1 &&
          (!labels.insert(outcome.label).second || outcome.label.empty()))
      {
        report(
            law.position,
            outcome.label.empty()
                ? "found several outcomes without a label, expected a label for each, as [failed]"
                : "the label '" + outcome.label + "' is given to two outcomes");
      }
      for (const Effect& effect : outcome.effects)
      {
        checkEffect(effect, scope);
      }
    }
    scope.finish();
  }

  [[nodiscard]] bool onlyStatics(const Body& body) const
  {
    return std::all_of(body.begin(), body.end(), [&](const Condition& condition) {
      const auto* literal = std::get_if<Literal>(&condition);
      const FluentDeclaration* fluent =
          literal == nullptr ? nullptr : symbols_.fluent(literal->atom.name);
      return fluent == nullptr || fluent->kind == FluentKind::kStatic;
    });
  }

  void checkConstraint(const StateConstraint& constraint)
  {
    Scope scope(symbols_, constraint.position, problems_);
    if (constraint.head)
    {
      const FluentDeclaration* fluent = scope.useLiteral(*constraint.head);
      const bool positive = constraint.head->equal && constraint.head->value.name == "true";
      if (fluent != nullptr && fluent->kind == FluentKind::kDefined && !positive)
      {
        report(constraint.position,
               "found a definition of " + toString(*constraint.head) +
                   ", expected a positive head: a defined fluent is false unless defined");
      }
      if (fluent != nullptr && fluent->kind == FluentKind::kStatic &&
          (!constraint.head->equal || constraint.head->value.name == "false" ||
           !onlyStatics(constraint.body)))
      {
        report(constraint.position,
               "found the static " + fluent->name +
                   " as the head of a constraint, expected a fluent (a static may only be "
                   "derived positively, from statics)");
      }
    }
    scope.useBody(constraint.body);
    scope.finish();
  }

  void checkExecutability(const Executability& rule)
  {
    Scope scope(symbols_, rule.position, problems_);
    for (const auto& action : rule.actions)
    {
      if (const auto* atom = std::get_if<Atom>(&action))
      {
        scope.useAction(*atom);
      }
      else
      {
        scope.useActionVariable(std::get<Term>(action));
      }
    }
    scope.useBody(rule.body);
    scope.finish();
  }

  void checkObservations()
  {
    for (const ObservationLaw& law : description_.observations)
    {
      Scope scope(symbols_, law.position, problems_);
      scope.useAction(law.action);
      const FluentDeclaration* fluent = scope.useFluent(law.fluent);
      if (law.value && fluent != nullptr)
      {
        scope.useValue(*fluent, *law.value, law.fluent.position);
      }
      scope.finish();
    }
  }

  void checkFacts()
  {
    for (const Literal& fact : description_.static_facts)
    {
      Scope scope(symbols_, fact.atom.position, problems_);
      const FluentDeclaration* fluent = scope.useLiteral(fact);
      if (fluent != nullptr && fluent->kind != FluentKind::kStatic)
      {
        report(fact.atom.position,
               "found the fluent " + fluent->name + " in a fact, expected a static");
      }
      scope.requireGround("fact");
    }
  }

  void checkDefaults()
  {
    for (const Default& rule : description_.defaults)
    {
      Scope scope(symbols_, rule.position, problems_);
      const FluentDeclaration* fluent = scope.useLiteral(rule.head);
      if (fluent != nullptr &&
          (fluent->kind == FluentKind::kStatic || fluent->kind == FluentKind::kDefined))
      {
        report(rule.position,
               "the default " + rule.name.name + " is about the " +
                   (fluent->kind == FluentKind::kStatic ? "static " : "defined fluent ") +
                   fluent->name + ", expected an inertial fluent");
      }
      scope.useBody(rule.body);
      for (const Term& term : rule.name.arguments)
      {
        scope.mention(term, rule.name.position);
      }
      scope.finish();
    }
    checkPreferences(description_, problems_);
  }

  void checkCosts()
  {
    for (const ActionCost& cost : description_.costs)
    {
      Scope scope(symbols_, cost.position, problems_);
      scope.useAction(cost.action);
      scope.useBody(cost.body);
      scope.finish();
    }
  }

  const Description& description_;
  const Symbols symbols_;
  std::vector<Diagnostic>& problems_;
};

}  // namespace

std::vector<Diagnostic> check(Description& description)
{
  std::vector<Diagnostic> problems;
  if (completeSorts(description, problems))
  {
    Checker(description, problems).run();
    checkAsp(description, problems);
    if (problems.empty())
    {
      checkDefinitions(description, problems);
    }
  }
  return problems;
}

std::vector<Diagnostic> checkGround(const Literal& literal, const Symbols& symbols)
{
  std::vector<Diagnostic> problems;
  Scope scope(symbols, literal.atom.position, problems);
  scope.useLiteral(literal);
  scope.requireGround("literal");
  return problems;
}

std::vector<Diagnostic> checkGroundAction(const Atom& action, const Symbols& symbols)
{
  std::vector<Diagnostic> problems;
  Scope scope(symbols, action.position, problems);
  scope.useAction(action);
  scope.requireGround("action");
  return problems;
}

}  // namespace kr3::reasoner
