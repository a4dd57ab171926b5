#include <algorithm>
#include <functional>

#include <kr3_common/error.hpp>

#include "oracle.hpp"

namespace kr3::reasoner::oracle
{

namespace
{

bool holds(const GroundLiteral& literal, const Values& state)
{
  return (state[static_cast<std::size_t>(literal.fluent)] == literal.value) == literal.equal;
}

bool isDefined(const GroundLiteral& literal, const GroundDomain& domain)
{
  return domain.fluents[static_cast<std::size_t>(literal.fluent)].defined;
}

}  // namespace

bool holds(const GroundBody& body, const Values& state)
{
  return std::all_of(body.begin(), body.end(),
                     [&](const GroundLiteral& literal) { return holds(literal, state); });
}

GroundLiteral contrary(const GroundLiteral& literal, const GroundDomain& domain)
{
  return domain.fluents[static_cast<std::size_t>(literal.fluent)].boolean
             ? GroundLiteral{literal.fluent, 1 - literal.value, true}
             : GroundLiteral{literal.fluent, literal.value, !literal.equal};
}

Knowledge::Knowledge(const GroundDomain& domain) : domain_(&domain) {}

bool Knowledge::add(const GroundLiteral& literal)
{
  const bool fresh = literals_.insert({{literal.fluent, literal.value}, literal.equal}).second;
  const GroundFluentInfo& fluent = domain_->fluents[static_cast<std::size_t>(literal.fluent)];
  for (int value = 0;
       fresh && literal.equal && !fluent.boolean && value < static_cast<int>(fluent.values.size());
       ++value)
  {
    if (value != literal.value)
    {
      literals_.insert({{literal.fluent, value}, false});
    }
  }
  return fresh;
}

bool Knowledge::has(const GroundLiteral& literal) const
{
  return literals_.count({{literal.fluent, literal.value}, literal.equal}) > 0;
}

bool Knowledge::has(const GroundBody& body) const
{
  return std::all_of(body.begin(), body.end(),
                     [&](const GroundLiteral& literal) { return has(literal); });
}

Diagram::Diagram(const GroundDomain& domain, std::size_t max_assignments)
  : domain_(domain), max_assignments_(max_assignments)
{
  std::size_t assignments = 1;
  for (const GroundFluentInfo& fluent : domain.fluents)
  {
    assignments *= fluent.defined ? 1 : fluent.values.size();
    if (assignments > max_assignments_)
    {
      throw ResourceExhausted("too many assignments to enumerate");
    }
  }
  Values values(domain.fluents.size(), 0);
  complete(values, 0);
}

void Diagram::complete(Values& values, std::size_t fluent)
{
  if (fluent < values.size())
  {
    const GroundFluentInfo& info = domain_.fluents[fluent];
    const int count = info.defined ? 1 : static_cast<int>(info.values.size());
    for (values[fluent] = 0; values[fluent] < count; ++values[fluent])
    {
      complete(values, fluent + 1);
    }
    values[fluent] = 0;
    return;
  }
  for (const Values& candidate : withDefinitions(values))
  {
    const bool allowed = std::all_of(domain_.constraints.begin(), domain_.constraints.end(),
                                     [&](const GroundConstraint& constraint) {
      return !oracle::holds(constraint.body, candidate) ||
             (constraint.head && holds(*constraint.head, candidate));
    });
    if (allowed)
    {
      states_.push_back(candidate);
    }
  }
}

std::vector<Values> Diagram::withDefinitions(const Values& values) const
{
  std::vector<std::size_t> defined;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (domain_.fluents[i].defined)
    {
      defined.push_back(i);
    }
  }
  // A set of defined fluents is right when its definitions, looking for `-d` at the whole set,
  // build exactly that set up.
  std::vector<Values> right;
  for (std::size_t mask = 0; mask < (std::size_t{1} << defined.size()); ++mask)
  {
    Values guess = values;
    for (std::size_t i = 0; i < defined.size(); ++i)
    {
      guess[defined[i]] = (mask >> i & 1U) != 0 ? 1 : 0;
    }
    Values built = values;
    for (bool changed = true; changed;)
    {
      changed = false;
      for (const GroundConstraint& rule : domain_.constraints)
      {
        if (!rule.head || !isDefined(*rule.head, domain_))
        {
          continue;
        }
        const bool fires = std::all_of(rule.body.begin(), rule.body.end(),
                                       [&](const GroundLiteral& literal) {
          return holds(literal, isDefined(literal, domain_) && literal.value == 1 ? built : guess);
        });
        int& value = built[static_cast<std::size_t>(rule.head->fluent)];
        changed = changed || (fires && value == 0);
        value = fires ? 1 : value;
      }
    }
    if (built == guess)
    {
      right.push_back(guess);
    }
  }
  return right;
}

bool Diagram::possible(const Values& state, const std::set<int>& actions) const
{
  return std::none_of(domain_.executabilities.begin(), domain_.executabilities.end(),
                      [&](const GroundExecutability& rule) {
    return std::all_of(rule.actions.begin(), rule.actions.end(),
                       [&](int action) { return actions.count(action) > 0; }) &&
           oracle::holds(rule.body, state);
  });
}

std::vector<Diagram::Effects> Diagram::effectsOf(const GroundLaw& law, const Values& state) const
{
  std::vector<Effects> results;
  for (const std::vector<GroundEffect>& outcome : law.outcomes)
  {
    std::vector<Effects> partial = {{}};
    for (const GroundEffect& effect : outcome)
    {
      std::vector<int> values;
      for (const GroundEffect::Candidate& candidate : effect.candidates)
      {
        if (std::any_of(candidate.bodies.begin(), candidate.bodies.end(),
                        [&](const GroundBody& body) { return oracle::holds(body, state); }))
        {
          values.push_back(candidate.value);
        }
      }
      if (!effect.is_choice)
      {
        values = {effect.value};
      }
      std::vector<Effects> extended;
      for (const Effects& effects : partial)
      {
        for (const int value : values)
        {
          Effects more = effects;
          if (more.emplace(effect.fluent, value).first->second == value)
          {
            extended.push_back(std::move(more));
          }
        }
      }
      partial = std::move(extended);
    }
    results.insert(results.end(), partial.begin(), partial.end());
  }
  return results;
}

const std::vector<std::size_t>& Diagram::successors(std::size_t state,
                                                    const std::set<int>& actions) const
{
  const auto [place, fresh] = successors_.try_emplace({state, actions});
  if (!fresh)
  {
    return place->second;
  }
  const Values& before = states_[state];
  std::vector<Effects> all = {{}};
  for (const GroundLaw& law : domain_.laws)
  {
    const bool fires =
        actions.count(law.action) > 0 &&
        std::any_of(law.bodies.begin(), law.bodies.end(),
                    [&](const GroundBody& body) { return oracle::holds(body, before); });
    if (!fires)
    {
      continue;
    }
    std::vector<Effects> joint;
    for (const Effects& one : all)
    {
      for (const Effects& two : effectsOf(law, before))
      {
        Effects merged = one;
        merged.insert(two.begin(), two.end());
        const bool agree = std::all_of(two.begin(), two.end(), [&](const auto& effect) {
          return merged.at(effect.first) == effect.second;
        });
        if (agree)
        {
          joint.push_back(std::move(merged));
        }
      }
    }
    std::sort(joint.begin(), joint.end());
    joint.erase(std::unique(joint.begin(), joint.end()), joint.end());
    all = std::move(joint);
  }
  for (std::size_t next = 0; next < states_.size(); ++next)
  {
    if (std::any_of(all.begin(), all.end(),
                    [&](const Effects& effects) { return caused(before, states_[next], effects); }))
    {
      place->second.push_back(next);
    }
  }
  return place->second;
}

bool Diagram::caused(const Values& before, const Values& after, const Effects& effects) const
{
  // McCain and Turner (1995): the next state is what follows, under the constraints, from the
  // direct effects and from what stays as it was. `f != v` may stay as well.
  Knowledge known(domain_);
  for (const auto& [fluent, value] : effects)
  {
    if (after[static_cast<std::size_t>(fluent)] != value)
    {
      return false;
    }
    known.add({fluent, value, true});
  }
  for (std::size_t i = 0; i < after.size(); ++i)
  {
    const GroundFluentInfo& fluent = domain_.fluents[i];
    for (int value = 0; !fluent.defined && value < static_cast<int>(fluent.values.size()); ++value)
    {
      for (const bool equal :
           fluent.boolean ? std::vector<bool>{true} : std::vector<bool>{true, false})
      {
        const GroundLiteral literal{static_cast<int>(i), value, equal};
        if (holds(literal, before) && holds(literal, after))
        {
          known.add(literal);
        }
      }
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const GroundConstraint& rule : domain_.constraints)
    {
      const bool fires = rule.head && std::all_of(rule.body.begin(), rule.body.end(),
                                                  [&](const GroundLiteral& literal) {
        return isDefined(literal, domain_) && literal.value == 0 ? holds(literal, after)
                                                                 : known.has(literal);
                         });
      changed = (fires && known.add(*rule.head)) || changed;
    }
  }
  for (std::size_t i = 0; i < after.size(); ++i)
  {
    const GroundFluentInfo& fluent = domain_.fluents[i];
    const bool needed = !fluent.defined || after[i] == 1;
    if (known.has({static_cast<int>(i), after[i], true}) != needed)
    {
      return false;
    }
    // Nothing that is false there may follow.
    for (int value = 0; value < static_cast<int>(fluent.values.size()); ++value)
    {
      if ((value != after[i] && known.has({static_cast<int>(i), value, true})) ||
          (value == after[i] && known.has({static_cast<int>(i), value, false})))
      {
        return false;
      }
    }
  }
  return true;
}

}  // namespace kr3::reasoner::oracle
