#include <algorithm>
#include <functional>
#include <optional>

#include "kr3_reasoner/transition_system.hpp"

namespace kr3::reasoner
{

namespace
{

/// What restricting a part came to: it goes, or it stays (perhaps shorter).
class Restriction
{
public:
  explicit Restriction(const std::set<std::string>& constants) : constants_(constants) {}

  [[nodiscard]] bool keeps(const Term& term) const
  {
    return term.is_variable || term.name == "true" || term.name == "false" ||
           constants_.count(term.name) > 0;
  }

  [[nodiscard]] bool keeps(const Atom& atom) const
  {
    return std::all_of(atom.arguments.begin(), atom.arguments.end(),
                       [this](const Term& term) { return keeps(term); });
  }

  [[nodiscard]] bool keeps(const Literal& literal) const
  {
    return keeps(literal.atom) && keeps(literal.value);
  }

  /// The body without the conditions that became trivially true, or nothing when one became false.
  [[nodiscard]] std::optional<Body> body(const Body& body) const
  {
    Body kept;
    for (const Condition& condition : body)
    {
      switch (decide(condition))
      {
        case Decision::kFalse:
          return std::nullopt;
        case Decision::kTrue:
          break;
        case Decision::kOpen:
          kept.push_back(condition);
      }
    }
    return kept;
  }

private:
  enum class Decision
  {
    kFalse,
    kTrue,
    kOpen
  };

  [[nodiscard]] Decision decide(const Condition& condition) const
  {
    if (const auto* literal = std::get_if<Literal>(&condition))
    {
      if (keeps(*literal))
      {
        return Decision::kOpen;
      }
      // A fluent over a constant that went: no longer there. A value that went: not this value.
      const bool negative =
          !literal->equal || (literal->value.name == "false" && !literal->value.is_variable);
      return negative ? Decision::kTrue : Decision::kFalse;
    }
    if (const auto* comparison = std::get_if<Comparison>(&condition))
    {
      if (keeps(comparison->left) && keeps(comparison->right))
      {
        return Decision::kOpen;
      }
      return comparison->op == Comparison::Operator::kNotEqual ? Decision::kTrue : Decision::kFalse;
    }
    const auto& membership = std::get<Membership>(condition);
    if (keeps(membership.term))
    {
      return Decision::kOpen;
    }
    return membership.negated ? Decision::kTrue : Decision::kFalse;
  }

  const std::set<std::string>& constants_;
};

template <typename Item>
void keepIf(std::vector<Item>& items, const std::function<bool(Item&)>& keep)
{
  items.erase(std::remove_if(items.begin(), items.end(), [&](Item& item) { return !keep(item); }),
              items.end());
}

}  // namespace

Description restricted(const Description& description, const std::set<std::string>& constants)
{
  const Restriction restriction(constants);
  Description result = description;
  const auto restrictBody = [&](Body& body) {
    std::optional<Body> kept = restriction.body(body);
    if (kept)
    {
      body = std::move(*kept);
    }
    return kept.has_value();
  };
  for (Sort& sort : result.sorts)
  {
    keepIf<std::string>(sort.elements,
                        [&](std::string& element) { return constants.count(element) > 0; });
  }
  keepIf<Literal>(result.static_facts, [&](Literal& fact) { return restriction.keeps(fact); });
  keepIf<CausalLaw>(result.causal_laws, [&](CausalLaw& law) {
    for (Outcome& outcome : law.outcomes)
    {
      for (Effect& effect : outcome.effects)
      {
        if (!restriction.keeps(effect.fluent) || !restriction.keeps(effect.value) ||
            (effect.is_choice && !restrictBody(effect.choice)))
        {
          return false;
        }
      }
    }
    return restriction.keeps(law.action) && restrictBody(law.body);
  });
  keepIf<StateConstraint>(result.constraints, [&](StateConstraint& constraint) {
    return (!constraint.head || restriction.keeps(*constraint.head)) &&
           restrictBody(constraint.body);
  });
  keepIf<Executability>(result.executabilities, [&](Executability& rule) {
    const bool actions =
        std::all_of(rule.actions.begin(), rule.actions.end(), [&](const auto& action) {
          const auto* atom = std::get_if<Atom>(&action);
          return atom == nullptr || restriction.keeps(*atom);
        });
    return actions && restrictBody(rule.body);
  });
  keepIf<ObservationLaw>(result.observations, [&](ObservationLaw& law) {
    return restriction.keeps(law.action) && restriction.keeps(law.fluent) &&
           (!law.value || restriction.keeps(*law.value));
  });
  keepIf<Default>(result.defaults, [&](Default& rule) {
    return restriction.keeps(rule.head) && restriction.keeps(rule.name) && restrictBody(rule.body);
  });
  keepIf<Preference>(result.preferences, [&](Preference& preference) {
    const auto has = [&](const std::string& name) {
      return std::any_of(result.defaults.begin(), result.defaults.end(),
                         [&](const Default& rule) { return rule.name.name == name; });
    };
    return has(preference.better.name) && has(preference.worse.name) &&
           restriction.keeps(preference.better) && restriction.keeps(preference.worse);
  });
  keepIf<ActionCost>(result.costs, [&](ActionCost& cost) {
    return restriction.keeps(cost.action) && restrictBody(cost.body);
  });
  return result;
}

}  // namespace kr3::reasoner
