// The part of Encoding that writes causal laws, executability conditions and prices.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "encoding.hpp"
#include "statement_shape.hpp"

namespace kr3::reasoner
{
namespace
{

std::string tuple(const std::vector<std::string>& items)
{
  std::string text = "(";
  for (const std::string& item : items)
  {
    text += item + ",";
  }
  return items.empty() ? "()" : text + ")";
}

}  // namespace

std::string Encoding::lawRules(const CausalLaw& law, std::size_t index) const
{
  Guards guards(description_);
  guards.action(law.action).body(law.body);
  std::string text = comment(law.position);
  const std::string fired = "occ(" + term(law.action) + ",_t-1)";
  const bool deterministic =
      law.outcomes.size() == 1 &&
      std::none_of(law.outcomes[0].effects.begin(), law.outcomes[0].effects.end(),
                   [](const Effect& effect) { return effect.is_choice; }) &&
      law.outcomes[0].label.empty();
  if (deterministic)
  {
    for (const Effect& effect : law.outcomes[0].effects)
    {
      Guards here = guards;
      here.literal({effect.fluent, effect.value, true});
      std::set<std::string> used = variablesOf(law.action.arguments);
      used.merge(variablesOf(effect.fluent.arguments));
      used.merge(variablesOf({effect.value}));
      text += "h(" + term(effect.fluent) + "," + effect.value.name + ",_t) :- " + fired +
              conditionsBefore(law.body, here, used) + ".\n";
    }
    return text;
  }
  // One choice for each instance of the action and of the effects' own variables.
  Guards key(description_);
  key.action(law.action);
  for (const Outcome& outcome : law.outcomes)
  {
    for (const Effect& effect : outcome.effects)
    {
      key.fluent(effect.fluent);
      if (effect.is_choice)
      {
        Guards choice(description_);
        key.shared(choice.body(effect.choice), guards);
      }
      else
      {
        key.literal({effect.fluent, effect.value, true});
      }
    }
  }
  const std::string number = std::to_string(index);
  const std::string keys = tuple(key.variables());
  const std::string fire = "fire(" + number + "," + keys + "," + term(law.action) + ",_t)";
  const std::vector<std::string> key_variables = key.variables();
  std::set<std::string> used(key_variables.begin(), key_variables.end());
  used.merge(variablesOf(law.action.arguments));
  text += fire + " :- " + fired + key.text() + conditionsBefore(law.body, guards, used) + ".\n";
  for (std::size_t i = 0; i < law.outcomes.size(); ++i)
  {
    const std::string label = number + "," + std::to_string(i) + "," + keys;
    std::string possible;
    for (std::size_t j = 0; j < law.outcomes[i].effects.size(); ++j)
    {
      const Effect& effect = law.outcomes[i].effects[j];
      const std::string out = "out(" + label + "," + term(law.action) + ",_t)";
      if (!effect.is_choice)
      {
        text += "h(" + term(effect.fluent) + "," + effect.value.name + ",_t) :- " + out + ".\n";
        continue;
      }
      const std::string picked = label + "," + std::to_string(j);
      Guards choice = key;
      choice.literal({effect.fluent, effect.value, true}).body(effect.choice);
      text += "cand(" + picked + "," + effect.value.name + ",_t) :- " + fire + choice.text() +
              body(effect.choice, "_t-1") + ".\n";
      text += "1 { pick(" + picked + ",_Z,_t) : cand(" + picked + ",_Z,_t) } 1 :- " + out + ".\n";
      text +=
          "h(" + term(effect.fluent) + ",_Z,_t) :- pick(" + picked + ",_Z,_t)" + key.text() + ".\n";
      possible += ", cand(" + picked + ",_Z" + std::to_string(j) + ",_t)";
    }
    text += "can(" + label + "," + term(law.action) + ",_t) :- " + fire + possible + ".\n";
  }
  text += "1 { out(" + number + ",_O," + keys + "," + term(law.action) + ",_t) : can(" + number +
          ",_O," + keys + "," + term(law.action) + ",_t) } 1 :- " + fire + ".\n";
  return text;
}

std::string Encoding::executabilityRules(const Executability& rule, std::size_t index) const
{
  if (rule.actions.size() != 1)
  {
    return "";
  }
  // A condition with a variable of its own is said apart: `impossible grasp(R, O) if in_hand(R,
  // O2)` has then as many ground rules as objects, not as pairs of objects.
  std::string text = comment(rule.position);
  Guards guards(description_);
  const auto* atom = std::get_if<Atom>(&rule.actions[0]);
  const std::string only = atom != nullptr ? term(*atom) : std::get<Term>(rule.actions[0]).name;
  const std::set<std::string> used = variablesOf(
      atom != nullptr ? atom->arguments : std::vector<Term>{std::get<Term>(rule.actions[0])});
  const std::map<std::string, int> uses = variableUses(rule.body);
  Body together;
  std::string apart;
  for (std::size_t i = 0; i < rule.body.size(); ++i)
  {
    const auto* literal = std::get_if<Literal>(&rule.body[i]);
    std::vector<Term> terms;
    if (literal != nullptr)
    {
      terms = literal->atom.arguments;
      terms.push_back(literal->value);
    }
    std::vector<std::string> shared;
    bool has_own = false;
    for (const std::string& variable : variablesOf(terms))
    {
      const bool own = used.count(variable) == 0 && uses.at(variable) == 1;
      has_own = has_own || own;
      if (!own)
      {
        shared.push_back(variable);
      }
    }
    if (!has_own)
    {
      together.push_back(rule.body[i]);
      continue;
    }
    Guards own_guards(description_);
    own_guards.literal(*literal);
    const std::string some =
        "some(" + std::to_string(index) + "," + std::to_string(i) + "," + tuple(shared) + ",_t-1)";
    text += some + " :- #true" + own_guards.text() + ", " + condition(rule.body[i], "_t-1") + ".\n";
    apart += ", " + some;
  }
  guards.body(together);
  if (atom != nullptr)
  {
    guards.action(*atom);
  }
  return text + "imp(" + only + ",_t-1) :- " + (atom != nullptr ? "#true" : "agent(" + only + ")") +
         conditionsBefore(together, guards, used) + apart + ".\n";
}

/// Actions that may not occur together.
std::string Encoding::exclusionRules(const Executability& rule) const
{
  if (rule.actions.size() == 1)
  {
    return "";
  }
  if (isPairwiseExclusion(rule))
  {
    return comment(rule.position) + ":- 2 { occ(_A,_t-1) : agent(_A) }.\n";
  }
  Guards guards(description_);
  guards.body(rule.body);
  std::set<std::string> used;
  std::string occurrences;
  for (const auto& action : rule.actions)
  {
    if (const auto* atom = std::get_if<Atom>(&action))
    {
      guards.action(*atom);
      used.merge(variablesOf(atom->arguments));
      occurrences += ", occ(" + term(*atom) + ",_t-1)";
    }
    else
    {
      const std::string variable = std::get<Term>(action).name;
      used.insert(variable);
      occurrences += ", occ(" + variable + ",_t-1), agent(" + variable + ")";
    }
  }
  return comment(rule.position) + ":- #true" + occurrences +
         conditionsBefore(rule.body, guards, used) + ".\n";
}

std::string Encoding::effects() const
{
  std::string text;
  if (!unequalRules().empty())
  {
    text += "{ ne(_F,_V,_t) } :- ne(_F,_V,_t-1).\n";  // f != v stays as it was, too
  }
  for (std::size_t i = 0; i < description_.causal_laws.size(); ++i)
  {
    text += lawRules(description_.causal_laws[i], i);
  }
  for (const Executability& rule : description_.executabilities)
  {
    text += exclusionRules(rule);
  }
  return text + rawBlocks(AspPart::kTransition);
}

std::string Encoding::executability() const
{
  std::string text;
  for (std::size_t i = 0; i < description_.executabilities.size(); ++i)
  {
    text += executabilityRules(description_.executabilities[i], i);
  }
  return text;
}

std::string Encoding::prices() const
{
  constexpr double kMilli = 1000.0;
  std::string text;
  for (const ActionCost& cost : description_.costs)
  {
    Guards guards(description_);
    guards.action(cost.action).body(cost.body);
    text += comment(cost.position) + "price(" + term(cost.action) + "," +
            std::to_string(std::lround(cost.cost * kMilli)) + ",_t-1) :- #true" + guards.text() +
            body(cost.body, "_t-1") + ".\n";
  }
  return text;
}

std::string Encoding::transition() const
{
  return "{ h(_F,_V,_t) } :- h(_F,_V,_t-1), basic(_F).\n" + effects() + executability() +
         ":- occ(_A,_t-1), imp(_A,_t-1).\n";
}

}  // namespace kr3::reasoner
