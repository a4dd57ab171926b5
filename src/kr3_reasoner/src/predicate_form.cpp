#include "predicate_form.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace kr3::reasoner
{

namespace
{

bool isNegative(const Literal& literal)
{
  return literal.equal && !literal.value.is_variable && literal.value.name == "false";
}

bool isPositive(const Literal& literal)
{
  return literal.equal && !literal.value.is_variable && literal.value.name == "true";
}

/// `-f(X, V1) if f(X, V2), V1 != V2.`, with distinct variables X.
bool isExclusionLaw(const StateConstraint& constraint)
{
  if (!constraint.head || !isNegative(*constraint.head) || constraint.body.size() != 2)
  {
    return false;
  }
  const Atom& head = constraint.head->atom;
  const bool literal_first = std::holds_alternative<Literal>(constraint.body[0]);
  const auto* other = std::get_if<Literal>(&constraint.body[literal_first ? 0 : 1]);
  const auto* unequal = std::get_if<Comparison>(&constraint.body[literal_first ? 1 : 0]);
  if (other == nullptr || unequal == nullptr || !isPositive(*other) ||
      other->atom.name != head.name || head.arguments.empty() ||
      other->atom.arguments.size() != head.arguments.size() ||
      unequal->op != Comparison::Operator::kNotEqual)
  {
    return false;
  }
  std::set<std::string> variables;
  for (std::size_t i = 0; i + 1 < head.arguments.size(); ++i)
  {
    if (!head.arguments[i].is_variable || !(head.arguments[i] == other->atom.arguments[i]) ||
        !variables.insert(head.arguments[i].name).second)
    {
      return false;
    }
  }
  const Term& first = head.arguments.back();
  const Term& second = other->atom.arguments.back();
  const bool compared = (unequal->left == first && unequal->right == second) ||
                        (unequal->left == second && unequal->right == first);
  return first.is_variable && second.is_variable && compared &&
         variables.insert(first.name).second && variables.insert(second.name).second;
}

/// Whether the fluent, written as a predicate, is the atom's.
bool isWrittenAsPredicate(const Atom& atom, const FluentDeclaration& fluent)
{
  return atom.arguments.size() == fluent.argument_sorts.size() + 1;
}

void moveValue(Atom& atom, Term& value)
{
  value = atom.arguments.back();
  atom.arguments.pop_back();
}

/// What stops a fluent from being a function.
struct Candidate
{
  bool has_exclusion_law = false;
  bool has_negative_effect = false;
  bool has_negative_head = false;
  bool total = false;
};

class Rewriting
{
public:
  Rewriting(Description& description, const Description* base,
            const std::vector<Totality>& totalities, std::vector<Diagnostic>& problems)
    : description_(description), base_(base), totalities_(totalities), problems_(problems)
  {
  }

  void run()
  {
    collect();
    declare();
    if (functions_.empty())
    {
      return;
    }
    rewriteAxioms();
    rewriteRest();
  }

private:
  void collect()
  {
    for (const StateConstraint& constraint : description_.constraints)
    {
      if (constraint.head && isNegative(*constraint.head))
      {
        Candidate& candidate = candidates_[constraint.head->atom.name];
        (isExclusionLaw(constraint) ? candidate.has_exclusion_law : candidate.has_negative_head) =
            true;
      }
    }
    for (const CausalLaw& law : description_.causal_laws)
    {
      for (const Outcome& outcome : law.outcomes)
      {
        for (const Effect& effect : outcome.effects)
        {
          if (!effect.is_choice && isNegative({effect.fluent, effect.value, true}))
          {
            candidates_[effect.fluent.name].has_negative_effect = true;
          }
        }
      }
    }
    for (const Totality& totality : totalities_)
    {
      candidates_[totality.fluent].total = true;
    }
  }

  void declare()
  {
    if (base_ != nullptr)
    {
      for (const FluentDeclaration& fluent : base_->fluents)
      {
        if (fluent.predicate_form)
        {
          functions_.emplace(fluent.name, Function{fluent.argument_sorts.size(), {}});
        }
      }
    }
    for (FluentDeclaration& fluent : description_.fluents)
    {
      const auto found = candidates_.find(fluent.name);
      if (found == candidates_.end() || fluent.kind != FluentKind::kInertial || fluent.value_sort ||
          fluent.argument_sorts.empty())
      {
        continue;
      }
      const Candidate& candidate = found->second;
      if (candidate.has_exclusion_law && !candidate.has_negative_effect &&
          (candidate.total || !candidate.has_negative_head))
      {
        makeFunction(fluent, candidate.total);
      }
    }
    for (const Totality& totality : totalities_)
    {
      reportTotality(totality);
    }
  }

  void reportTotality(const Totality& totality)
  {
    if (functions_.count(totality.fluent) > 0)
    {
      return;
    }
    const Candidate& candidate = candidates_.at(totality.fluent);
    problems_.push_back(
        {totality.position,
         "found total " + totality.fluent + ", expected an inertial predicate fluent " +
             (candidate.has_negative_effect
                  ? "without negative effects: -" + totality.fluent + "(...) is caused somewhere"
                  : "with the law -" + totality.fluent + "(X, V1) if " + totality.fluent +
                        "(X, V2), V1 != V2")});
  }

  void makeFunction(FluentDeclaration& fluent, bool total)
  {
    const std::string last = fluent.argument_sorts.back();
    fluent.argument_sorts.pop_back();
    fluent.predicate_form = true;
    fluent.value_sort = last;
    if (!total)
    {
      fluent.no_value = unusedElement("no_" + last);
      fluent.value_sort = unusedSort(fluent.name + "_value");
      description_.sorts.push_back(
          {*fluent.value_sort, {fluent.no_value}, {last}, fluent.position});
    }
    functions_[fluent.name] = {fluent.argument_sorts.size(), total ? "" : last};
    const std::string& name = fluent.name;
    auto& constraints = description_.constraints;
    constraints.erase(std::remove_if(
                          constraints.begin(), constraints.end(),
                          [&](const StateConstraint& constraint) {
      return constraint.head && constraint.head->atom.name == name && isExclusionLaw(constraint);
                          }),
                      constraints.end());
  }

  [[nodiscard]] std::string unusedSort(std::string name) const
  {
    while (description_.findSort(name) != nullptr || description_.findFluent(name) != nullptr)
    {
      name += "_";
    }
    return name;
  }

  [[nodiscard]] std::string unusedElement(std::string name)
  {
    if (elements_.empty())
    {
      for (const Sort& sort : description_.sorts)
      {
        elements_.insert(sort.elements.begin(), sort.elements.end());
      }
    }
    while (elements_.count(name) > 0)
    {
      name += "_";
    }
    return name;
  }

  /// Rewrites one literal; of a partial function its value is restricted by `guards`.
  void rewrite(Atom& atom, Term& value, bool& equal, Body& guards)
  {
    const auto found = functions_.find(atom.name);
    if (found == functions_.end() || atom.arguments.size() != found->second.arity + 1 ||
        value.is_variable || (value.name != "true" && value.name != "false"))
    {
      return;
    }
    equal = (value.name == "true") == equal;
    moveValue(atom, value);
    const std::string& sort = found->second.guard;
    if (sort.empty() || !value.is_variable)
    {
      return;
    }
    const auto guarded = [&](const Condition& condition) {
      const auto* membership = std::get_if<Membership>(&condition);
      return membership != nullptr && !membership->negated && membership->sort == sort &&
             membership->term == value;
    };
    if (std::none_of(guards.begin(), guards.end(), guarded))
    {
      guards.push_back(Membership{sort, value, false, atom.position});
    }
  }

  void rewrite(Body& body)
  {
    Body guards;
    for (Condition& condition : body)
    {
      if (auto* literal = std::get_if<Literal>(&condition))
      {
        rewrite(literal->atom, literal->value, literal->equal, guards);
      }
    }
    addMissing(body, guards);
  }

  static void addMissing(Body& body, const Body& guards)
  {
    for (const Condition& guard : guards)
    {
      const auto& wanted = std::get<Membership>(guard);
      const auto same = [&](const Condition& condition) {
        const auto* membership = std::get_if<Membership>(&condition);
        return membership != nullptr && !membership->negated && membership->sort == wanted.sort &&
               membership->term == wanted.term;
      };
      if (std::none_of(body.begin(), body.end(), same))
      {
        body.push_back(guard);
      }
    }
  }

  void rewriteAxioms()
  {
    for (CausalLaw& law : description_.causal_laws)
    {
      rewrite(law.body);
      for (Outcome& outcome : law.outcomes)
      {
        for (Effect& effect : outcome.effects)
        {
          bool equal = true;
          Body guards;
          rewrite(effect.choice);
          if (!effect.is_choice)
          {
            rewrite(effect.fluent, effect.value, equal, guards);
          }
          addMissing(law.body, guards);
        }
      }
    }
    for (StateConstraint& constraint : description_.constraints)
    {
      rewrite(constraint.body);
      rewriteHead(constraint.head ? &*constraint.head : nullptr, constraint.body);
    }
    for (Executability& rule : description_.executabilities)
    {
      rewrite(rule.body);
    }
  }

  void rewriteHead(Literal* head, Body& body)
  {
    if (head != nullptr)
    {
      Body guards;
      rewrite(head->atom, head->value, head->equal, guards);
      addMissing(body, guards);
    }
  }

  void rewriteRest()
  {
    for (ObservationLaw& law : description_.observations)
    {
      const auto found = functions_.find(law.fluent.name);
      if (!law.value && found != functions_.end() &&
          law.fluent.arguments.size() == found->second.arity + 1)
      {
        law.value.emplace();
        moveValue(law.fluent, *law.value);
      }
    }
    for (Default& rule : description_.defaults)
    {
      rewrite(rule.body);
      rewriteHead(&rule.head, rule.body);
    }
    for (ActionCost& cost : description_.costs)
    {
      rewrite(cost.body);
    }
  }

  struct Function
  {
    std::size_t arity = 0;
    std::string guard;  // of a partial one: the sort of the proper values
  };

  Description& description_;
  const Description* base_;
  const std::vector<Totality>& totalities_;
  std::vector<Diagnostic>& problems_;
  std::unordered_map<std::string, Candidate> candidates_;
  std::unordered_map<std::string, Function> functions_;
  std::unordered_set<std::string> elements_;
};

}  // namespace

void rewritePredicateForm(Description& description, const Description* base,
                          const std::vector<Totality>& totalities,
                          std::vector<Diagnostic>& problems)
{
  Rewriting(description, base, totalities, problems).run();
}

void makeFunctional(Literal& literal, const Description& description)
{
  const FluentDeclaration* fluent = description.findFluent(literal.atom.name);
  if (fluent == nullptr || !fluent->predicate_form ||
      !isWrittenAsPredicate(literal.atom, *fluent) ||
      (!isPositive(literal) && !isNegative(literal)))
  {
    return;
  }
  literal.equal = isPositive(literal);
  moveValue(literal.atom, literal.value);
}

}  // namespace kr3::reasoner
