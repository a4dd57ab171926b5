#include "history_theory.hpp"

#include <algorithm>
#include <utility>

namespace kr3::reasoner
{

HistoryTheory::HistoryTheory(const Description& description, const Words& words,
                             const Instances& instances, const std::vector<CheckedRecord>& records,
                             const Laws& laws, const Cited& kept, const InitialWorld& world,
                             int current_step, const Atom& fluent, bool wide,
                             const SearchLimit& limit)
  : description_(description)
  , words_(words)
  , records_(records)
  , laws_(laws)
  , kept_(kept)
  , world_(world)
  , current_step_(current_step)
  , rules_(description, words, instances, records, laws, kept, world, fluent, wide, limit)
  , propagation_(limit)
{
  for (const Atom& atom : rules_.fluents())
  {
    const FluentDeclaration& declared = *description.findFluent(atom.name);
    fluent_index_.emplace(toString(atom), values_.size());
    values_.push_back(declared.value_sort ? description.findSort(*declared.value_sort)->elements
                                          : std::vector<std::string>{"false", "true"});
    value_index_.emplace_back();
    for (std::size_t i = 0; i < values_.back().size(); ++i)
    {
      value_index_.back().emplace(values_.back()[i], static_cast<int>(i));
    }
  }
  for (std::size_t i = 0; i < rules_.occurrences().size(); ++i)
  {
    occurrence_variables_.push_back(propagation_.addVariable(2));
    meanings_.emplace_back();
    meanings_.back().occurrence = i;
  }
  findChanges();
  addTransitions();
  for (const GroundRule& rule : rules_.rules())
  {
    std::set<int> steps;
    const auto note = [&](const Literal& literal) {
      for (const auto& [step, variable] : variables_[*fluentIndex(literal.atom)])
      {
        steps.insert(step);
      }
    };
    std::for_each(rule.body.begin(), rule.body.end(), note);
    if (rule.head)
    {
      note(*rule.head);
    }
    for (const int step : steps)
    {
      addRule(rule, step);
    }
  }
  addDefinitions();
  addBans();
  propagation_.propagate();
  base_ = propagation_.mark();
}

std::optional<std::size_t> HistoryTheory::fluentIndex(const Atom& atom) const
{
  const auto found = fluent_index_.find(toString(atom));
  return found == fluent_index_.end() ? std::nullopt : std::make_optional(found->second);
}

int HistoryTheory::variable(std::size_t fluent, int step) const
{
  return std::prev(variables_[fluent].upper_bound(step))->second;
}

bool HistoryTheory::changes(std::size_t fluent, int step) const
{
  return variables_[fluent].count(step) > 0;
}

std::size_t HistoryTheory::definitionOf(std::size_t fluent) const
{
  const std::string& name = rules_.fluents()[fluent].name;
  return description_.findFluent(name)->kind == FluentKind::kDefined ? laws_.ofDefinition(name)
                                                                     : kNoLaw;
}

FiniteLiteral HistoryTheory::at(const Literal& open, int step) const
{
  const Literal literal = normalized(open, description_);
  const std::size_t fluent = *fluentIndex(literal.atom);
  return {variable(fluent, step), value_index_[fluent].at(literal.value.name), literal.equal, step};
}

HistoryTheory::Body HistoryTheory::at(const std::vector<Literal>& literals, int step) const
{
  Body body;
  for (const Literal& literal : literals)
  {
    body.push_back(at(literal, step));
  }
  return body;
}

Literal HistoryTheory::literalOf(const FiniteLiteral& finite) const
{
  const std::size_t fluent = *meaning(finite.variable).fluent;
  Literal literal;
  literal.atom = rules_.fluents()[fluent];
  literal.value.name = values_[fluent][static_cast<std::size_t>(finite.value)];
  literal.equal = finite.equal;
  return normalized(std::move(literal), description_);
}

int HistoryTheory::addOrigin(ClauseOrigin origin)
{
  origins_.push_back(std::move(origin));
  return static_cast<int>(origins_.size()) - 1;
}

void HistoryTheory::addImplication(const Body& body, std::optional<FiniteLiteral> head, int origin)
{
  Body clause;
  for (FiniteLiteral literal : body)
  {
    literal.equal = !literal.equal;
    clause.push_back(literal);
  }
  if (head)
  {
    clause.push_back(*head);
  }
  propagation_.addClause(clause, origin);
}

/// Where effects reach a fluent, directly or through constraints, it gets a variable of its own.
void HistoryTheory::findChanges()
{
  std::vector<std::set<std::size_t>> dependents(values_.size());
  for (const GroundRule& rule : rules_.rules())
  {
    for (const Literal& literal : rule.body)
    {
      if (rule.head)
      {
        dependents[*fluentIndex(literal.atom)].insert(*fluentIndex(rule.head->atom));
      }
    }
  }
  std::map<int, std::set<std::size_t>> changed;
  for (const GroundLaw& law : rules_.laws())
  {
    for (const auto& outcome : law.outcomes)
    {
      for (const GroundEffect& effect : outcome)
      {
        if (const auto fluent = fluentIndex(effect.fluent))
        {
          changed[rules_.occurrences()[law.occurrence].step + 1].insert(*fluent);
        }
      }
    }
  }
  for (std::size_t fluent = 0; fluent < values_.size(); ++fluent)
  {
    for (int step = 1; step <= current_step_ && !kept_.hasLaw(definitionOf(fluent)); ++step)
    {
      changed[step].insert(fluent);  // nothing ties it to anything
    }
  }
  variables_.resize(values_.size());
  const auto add = [&](std::size_t fluent, int step) {
    variables_[fluent][step] = propagation_.addVariable(static_cast<int>(values_[fluent].size()));
    meanings_.emplace_back();
    meanings_.back().fluent = fluent;
    meanings_.back().since = step;
  };
  for (std::size_t fluent = 0; fluent < values_.size(); ++fluent)
  {
    add(fluent, 0);
  }
  for (auto& [step, fluents] : changed)
  {
    std::vector<std::size_t> reached(fluents.begin(), fluents.end());
    while (!reached.empty())
    {
      const std::size_t next = reached.back();
      reached.pop_back();
      for (const std::size_t dependent : dependents[next])
      {
        if (fluents.insert(dependent).second)
        {
          reached.push_back(dependent);
        }
      }
    }
    for (const std::size_t fluent : fluents)
    {
      if (step <= current_step_)
      {
        add(fluent, step);
      }
    }
  }
}

void HistoryTheory::addRule(const GroundRule& rule, int step)
{
  ClauseOrigin origin;
  origin.kind =
      rule.head && description_.findFluent(rule.head->atom.name)->kind == FluentKind::kDefined
          ? ReasonKind::kDefinition
          : ReasonKind::kConstraint;
  origin.step = step;
  origin.position = rule.position;
  origin.law = rule.law;
  addImplication(at(rule.body, step),
                 rule.head ? std::make_optional(at(*rule.head, step)) : std::nullopt,
                 addOrigin(std::move(origin)));
}

/// A literal that is true only if all of the body is.
FiniteLiteral HistoryTheory::conjunction(const Body& body, const std::string& action, int origin)
{
  if (body.size() == 1)
  {
    return body.front();
  }
  const int variable = propagation_.addVariable(2);
  meanings_.emplace_back();
  meanings_.back().action = action;
  const FiniteLiteral all{variable, 1, true, body.empty() ? 0 : body.front().step};
  for (const FiniteLiteral& literal : body)
  {
    addImplication({all}, literal, origin);
  }
  return all;
}

/// A defined fluent is true only by one of its definitions.
void HistoryTheory::addDefinitions()
{
  std::map<std::size_t, std::vector<const GroundRule*>> definitions;
  bool recursive = false;
  const auto isDefined = [&](const Literal& literal) {
    return description_.findFluent(literal.atom.name)->kind == FluentKind::kDefined;
  };
  for (const GroundRule& rule : rules_.rules())
  {
    if (rule.head && isDefined(*rule.head) && rule.head->value.name == "true")
    {
      definitions[*fluentIndex(rule.head->atom)].push_back(&rule);
      recursive = recursive || std::any_of(rule.body.begin(), rule.body.end(), isDefined);
    }
  }
  for (std::size_t fluent = 0; fluent < values_.size(); ++fluent)
  {
    if (description_.findFluent(rules_.fluents()[fluent].name)->kind != FluentKind::kDefined ||
        !kept_.hasLaw(definitionOf(fluent)))
    {
      continue;
    }
    for (const auto& [step, variable] : variables_[fluent])
    {
      ClauseOrigin origin;
      origin.kind = ReasonKind::kDefinition;
      origin.step = step;
      origin.law = definitionOf(fluent);
      if (!definitions[fluent].empty())
      {
        origin.position = definitions[fluent].front()->position;
      }
      const int completion = addOrigin(origin);
      origin.silent = true;
      const int silent = addOrigin(origin);
      Body clause = {{variable, 1, false, step}};
      bool always = false;
      for (const GroundRule* rule : definitions[fluent])
      {
        always = always || rule->body.empty();
        clause.push_back(conjunction(at(rule->body, step), "", silent));
        if (recursive)
        {
          propagation_.addFoundedRule({variable, 1, true, step}, at(rule->body, step), completion);
        }
      }
      if (!always)
      {
        propagation_.addClause(clause, completion);
      }
    }
  }
}

void HistoryTheory::addBans()
{
  for (const GroundBan& ban : rules_.bans())
  {
    const int step = rules_.occurrences()[ban.occurrences.front()].step;
    ClauseOrigin origin;
    origin.kind = ReasonKind::kExecutability;
    origin.step = step;
    origin.position = ban.position;
    origin.law = ban.law;
    Body body;
    std::vector<std::string> actions;
    for (const std::size_t i : ban.occurrences)
    {
      body.push_back({occurrence_variables_[i], 1, true, step});
      actions.push_back(toString(rules_.occurrences()[i].action));
    }
    origin.action = listed(actions);
    const Body conditions = at(ban.body, step);
    body.insert(body.end(), conditions.begin(), conditions.end());
    addImplication(body, std::nullopt, addOrigin(std::move(origin)));
  }
}

}  // namespace kr3::reasoner
