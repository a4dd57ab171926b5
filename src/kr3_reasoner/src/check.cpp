#include "check.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <unordered_set>
#include <utility>

#include <kr3_common/error.hpp>

#include "scope.hpp"

namespace kr3::reasoner
{

namespace
{

std::size_t editDistance(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

/// Completes the elements of all sorts; reports unknown and cyclic members.
class SortCompletion
{
public:
  SortCompletion(Description& description, std::vector<Diagnostic>& problems)
    : description_(description), problems_(problems)
  {
  }

  void run()
  {
    for (Sort& sort : description_.sorts)
    {
      complete(sort);
    }
  }

private:
  void complete(Sort& sort)
  {
    if (done_.count(sort.name) > 0)
    {
      return;
    }
    if (!open_.insert(sort.name).second)
    {
      problems_.push_back({sort.position, "the sort " + sort.name +
                                              " contains itself, expected no cycle of sorts"});
      return;
    }
    std::unordered_set<std::string> known(sort.elements.begin(), sort.elements.end());
    for (const std::string& member : sort.member_sorts)
    {
      const auto found = std::find_if(description_.sorts.begin(), description_.sorts.end(),
                                      [&](const Sort& other) { return other.name == member; });
      if (found == description_.sorts.end())
      {
        problems_.push_back({sort.position, "unknown sort '" + member + "'" +
                                                suggestion(member, sortNames(description_))});
        continue;
      }
      complete(*found);
      for (const std::string& element : found->elements)
      {
        if (known.insert(element).second)
        {
          sort.elements.push_back(element);
        }
      }
    }
    open_.erase(sort.name);
    done_.insert(sort.name);
  }

  Description& description_;
  std::vector<Diagnostic>& problems_;
  std::set<std::string> open_;
  std::set<std::string> done_;
};

class Checker
{
public:
  explicit Checker(Description& description) : description_(description) {}

  std::vector<Diagnostic> run()
  {
    SortCompletion(description_, problems_).run();
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
    checkRest();
    checkPreferences();
    return std::move(problems_);
  }

private:
  void report(const SourcePosition& position, const std::string& message)
  {
    problems_.push_back({position, message});
  }

  void checkNames()
  {
    std::map<std::string, std::string> seen;
    const auto declare =
        [&](const std::string& name, const std::string& what, const SourcePosition& position) {
      const auto [place, fresh] = seen.emplace(name, what);
      if (!fresh)
      {
        report(position, "'" + name + "' is declared twice, first as " + place->second);
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
    for (const Sort& sort : description_.sorts)
    {
      std::set<std::string> elements;
      for (const std::string& element : sort.elements)
      {
        if (!elements.insert(element).second)
        {
          report(sort.position,
                 "the sort " + sort.name + " has the element '" + element + "' twice");
        }
      }
    }
  }

  void checkSort(const std::string& name, const SourcePosition& position)
  {
    if (description_.findSort(name) == nullptr)
    {
      report(position, "unknown sort '" + name + "'" + suggestion(name, sortNames(description_)));
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
    Scope scope(description_, law.position, problems_);
    scope.useAction(law.action);
    scope.useBody(law.body);
    std::set<std::string> labels;
    for (const Outcome& outcome : law.outcomes)
    {
      if (law.outcomes.size() > 1 && !labels.insert(outcome.label).second)
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
          literal == nullptr ? nullptr : description_.findFluent(literal->atom.name);
      return fluent == nullptr || fluent->kind == FluentKind::kStatic;
    });
  }

  void checkConstraint(const StateConstraint& constraint)
  {
    Scope scope(description_, constraint.position, problems_);
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
    Scope scope(description_, rule.position, problems_);
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

  void checkRest()
  {
    for (const ObservationLaw& law : description_.observations)
    {
      Scope scope(description_, law.position, problems_);
      scope.useAction(law.action);
      const FluentDeclaration* fluent = scope.useFluent(law.fluent);
      if (law.value && fluent != nullptr)
      {
        scope.useValue(*fluent, *law.value, law.fluent.position);
      }
      scope.finish();
    }
    for (const Literal& fact : description_.static_facts)
    {
      Scope scope(description_, fact.atom.position, problems_);
      const FluentDeclaration* fluent = scope.useLiteral(fact);
      if (fluent != nullptr && fluent->kind != FluentKind::kStatic)
      {
        report(fact.atom.position,
               "found the fluent " + fluent->name + " in a fact, expected a static");
      }
      scope.requireGround("fact");
    }
    for (const Default& rule : description_.defaults)
    {
      Scope scope(description_, rule.position, problems_);
      const FluentDeclaration* fluent = scope.useLiteral(rule.head);
      if (fluent != nullptr &&
          (fluent->kind == FluentKind::kStatic || fluent->kind == FluentKind::kDefined))
      {
        report(rule.position, "the default " + rule.name.name + " is about " + fluent->name +
                                  ", expected an inertial fluent");
      }
      scope.useBody(rule.body);
      for (const Term& term : rule.name.arguments)
      {
        scope.mention(term, rule.name.position);
      }
      scope.finish();
    }
    for (const ActionCost& cost : description_.costs)
    {
      Scope scope(description_, cost.position, problems_);
      scope.useAction(cost.action);
      scope.useBody(cost.body);
      scope.finish();
    }
  }

  void checkPreferences()
  {
    std::map<std::string, std::size_t> arity;
    std::vector<std::string> names;
    for (const Default& rule : description_.defaults)
    {
      if (!arity.emplace(rule.name.name, rule.name.arguments.size()).second)
      {
        report(rule.position, "the default '" + rule.name.name + "' is declared twice");
      }
      names.push_back(rule.name.name);
    }
    std::map<std::string, std::set<std::string>> better;
    for (const Preference& preference : description_.preferences)
    {
      for (const Atom* atom : {&preference.better, &preference.worse})
      {
        const auto found = arity.find(atom->name);
        if (found == arity.end())
        {
          report(atom->position,
                 "unknown default '" + atom->name + "'" + suggestion(atom->name, names));
        }
        else if (found->second != atom->arguments.size())
        {
          report(atom->position, "found " + std::to_string(atom->arguments.size()) +
                                     " arguments of the default " + atom->name + ", expected " +
                                     std::to_string(found->second));
        }
      }
      better[preference.worse.name].insert(preference.better.name);
    }
    for (const Preference& preference : description_.preferences)
    {
      std::set<std::string> reached;
      std::vector<std::string> open = {preference.better.name};
      while (!open.empty())
      {
        const std::string name = open.back();
        open.pop_back();
        if (reached.insert(name).second)
        {
          open.insert(open.end(), better[name].begin(), better[name].end());
        }
      }
      if (reached.count(preference.worse.name) > 0)
      {
        report(preference.position, "the preference of " + preference.better.name + " over " +
                                        preference.worse.name +
                                        " closes a cycle, expected an order");
      }
    }
  }

  Description& description_;
  std::vector<Diagnostic> problems_;
};

}  // namespace

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates)
{
  std::string best;
  std::size_t best_distance = std::min(name.size(), std::max<std::size_t>(2, name.size() / 3) + 1);
  for (const std::string& candidate : candidates)
  {
    const std::size_t distance = editDistance(name, candidate);
    if (distance < best_distance)
    {
      best_distance = distance;
      best = candidate;
    }
  }
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

void throwIfAny(const std::vector<Diagnostic>& problems)
{
  if (problems.empty())
  {
    return;
  }
  std::string text;
  for (const Diagnostic& problem : problems)
  {
    const SourcePosition& at = problem.position;
    text += (text.empty() ? "" : "\n") + at.file + ":" + std::to_string(at.line) + ":" +
            std::to_string(at.column) + ": " + problem.message;
  }
  throw InvalidArgument(text);
}

std::vector<Diagnostic> check(Description& description)
{
  return Checker(description).run();
}

std::vector<Diagnostic> checkGround(const Literal& literal, const Description& description)
{
  std::vector<Diagnostic> problems;
  Scope scope(description, literal.atom.position, problems);
  scope.useLiteral(literal);
  scope.requireGround("literal");
  return problems;
}

std::vector<Diagnostic> checkGroundAction(const Atom& action, const Description& description)
{
  std::vector<Diagnostic> problems;
  Scope scope(description, action.position, problems);
  scope.useAction(action);
  scope.requireGround("action");
  return problems;
}

}  // namespace kr3::reasoner
