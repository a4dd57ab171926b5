#include "relevance.hpp"

#include <algorithm>

namespace kr3::reasoner
{

Relevance::Relevance(const GroundRules& rules, const std::vector<CheckedRecord>& records,
                     int current_step, Purpose purpose, const Beginning* beginning)
  : rules_(rules)
  , records_(records)
  , current_step_(current_step)
  , purpose_(purpose)
  , first_step_(firstStepOf(beginning))
{
  if (beginning != nullptr)
  {
    readBeginning(*beginning);
  }
  findOpenPositions();
  readRecords();
  findEvidence();
  expandOccurrences();
  drain();
  changed_ = affected_;
  planning_ = purpose_ == Purpose::kPlan;
  collectOccurrences();
}
bool Relevance::refutes(const RuleLiteral& literal, const RuleBinding& binding, Basis basis)
{
  const GroundAtom fluent = GroundRules::bound(literal, binding);
  const auto known = known_.find(fluent);
  const ConstantId value = GroundRules::bound(literal.value, binding);
  if (known == known_.end() || value == kUnbound || (known->second == value) == literal.equal ||
      isTied(fluent))  // its record goes with what it is tied to
  {
    return false;
  }
  if (basis == Basis::kInitially)
  {
    return true;
  }
  if (exogenous_[fluent.symbol] || changed_.count(fluent) > 0)
  {
    return false;
  }
  if (basis == Basis::kAlways)
  {
    if (affected_.count(fluent) > 0)
    {
      return false;
    }
    auto& tasks = waiting_[fluent];
    if (tasks.empty() || tasks.back() != running_)
    {
      tasks.push_back(running_);
    }
  }
  return true;
}

void Relevance::forEachLive(std::size_t rule, const RuleBinding& binding, Basis basis,
                            const std::function<void(const RuleBinding&)>& visit)
{
  const GroundableRule& groundable = rules_.rules()[rule];
  rules_.forEachInstance(
      groundable, binding, actionVariables(groundable),
      [&](const RuleLiteral& literal, const RuleBinding& bound) {
    return refutes(literal, bound, basis);
      },
      visit);
}

// ---- The fixpoint ----

void Relevance::run(std::function<void()> task)
{
  tasks_.push_back(std::move(task));
  queue_.push_back(tasks_.size() - 1);
}

void Relevance::drain()
{
  for (std::size_t next = 0; next < queue_.size(); ++next)
  {
    running_ = queue_[next];
    const std::function<void()> task = tasks_[running_];  // it may add tasks
    task();
  }
  queue_.clear();
}

void Relevance::close()
{
  drain();
}

bool Relevance::isRelevant(const GroundAtom& fluent) const
{
  return fluent_item_.count(fluent) > 0;
}

void Relevance::addFluent(const GroundAtom& fluent, const Origin& origin)
{
  const auto [place, fresh] = fluent_item_.emplace(fluent, static_cast<int>(items_.size()));
  if (fresh)
  {
    items_.push_back({false, fluent, origin});
    const int item = place->second;
    run([this, item] { expandFluent(item); });
  }
}

void Relevance::addAction(const GroundAtom& action, const Origin& origin)
{
  const auto [place, fresh] = action_item_.emplace(action, static_cast<int>(items_.size()));
  if (fresh)
  {
    items_.push_back({true, action, origin});
    const int item = place->second;
    run([this, item] { expandAction(item); });
  }
}

void Relevance::addGoal(const Formula& goal)
{
  for (const Formula& operand : goal.operands)
  {
    addGoal(operand);
  }
  if (goal.kind != Formula::Kind::kLiteral)
  {
    return;
  }
  const GroundAtom fluent = rules_.ground(goal.literal.atom, false);
  if (rules_.isStatic(fluent.symbol))
  {
    return;
  }
  addFluent(fluent, {-1, "the goal mentions it"});
  if (known_.count(fluent) > 0 && changed_.count(fluent) == 0 && !exogenous_[fluent.symbol])
  {
    return;  // it is not open now
  }
  // Where the goal may hold already but need not, an action that depends on it has to tell.
  for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    if (rule.kind != Kind::kExecutability || rule.actions.size() != 1 || rule.any_action ||
        rules_.description().actions[rule.actions[0].symbol].exogenous)
    {
      continue;
    }
    for (const RuleLiteral& literal : rule.literals)
    {
      RuleBinding binding;
      if (literal.symbol == fluent.symbol &&
          rules_.unify(rule, literal.arguments, fluent.arguments, binding))
      {
        const int item = fluent_item_.at(fluent);
        run([this, index, binding, item] {
          const GroundableRule& condition = rules_.rules()[index];
          rules_.forEachInstance(
              condition, binding, actionVariables(condition),
              [](const RuleLiteral&, const RuleBinding&) { return false; },
              [&](const RuleBinding& instance) {
            addAction(actionOf(condition, instance),
                      {item, "whether it can be executed tells about " +
                                 rules_.fluentText(items_[item].atom) + at(condition)});
              });
        });
      }
    }
  }
}

void Relevance::addRecord(std::size_t record)
{
  const CheckedRecord& checked = records_[record];
  const Origin origin{-1, toString(checked.record) + " mentions it"};
  if (checked.isAction())
  {
    occurrences_.at(record).asked = true;
    for (const GroundAtom& fluent : occurrences_.at(record).fluents)
    {
      addFluent(fluent, origin);
    }
  }
  else if (const GroundAtom fluent = rules_.ground(checked.literal.atom, false);
           !rules_.isStatic(fluent.symbol))
  {
    addFluent(fluent, origin);
  }
}

void Relevance::join(const GroundableRule& rule, const RuleBinding& binding, int from,
                     const std::string& what)
{
  for (const RuleLiteral& literal : rule.literals)
  {
    const GroundAtom fluent = GroundRules::bound(literal, binding);
    if (!isRelevant(fluent))
    {
      addFluent(fluent, {from, what + at(rule)});
    }
  }
}

void Relevance::expandFluent(int item)
{
  const GroundAtom fluent = items_[item].atom;
  for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    for (std::size_t i = 0; i < rule.literals.size(); ++i)
    {
      if (rule.literals[i].symbol != fluent.symbol)
      {
        continue;
      }
      switch (rule.kind)
      {
        case Kind::kConstraint:
        case Kind::kDefault:
          expandConstraint(index, i, item);
          break;
        case Kind::kLaw:
          expandLaw(index, i, item);
          break;
        case Kind::kExecutability:
        {
          RuleBinding binding;
          if (current_step_ > 0 &&
              rules_.unify(rule, rule.literals[i].arguments, fluent.arguments, binding))
          {
            expandExogenous(index, binding, item);
          }
          break;
        }
        case Kind::kCost:
          break;
      }
    }
  }
  const auto ties = ties_of_.find(fluent);
  if (ties != ties_of_.end())
  {
    for (const std::size_t component : ties->second)
    {
      for (const GroundAtom& other : joined_[component])
      {
        addFluent(other, {item, "what is known of step " + std::to_string(first_step_) +
                                    " ties it to " + rules_.fluentText(fluent)});
      }
    }
  }
  const auto occurred = occurrences_of_.find(fluent);
  if (occurred == occurrences_of_.end())
  {
    return;
  }
  for (const std::size_t record : occurred->second)
  {
    Occurrence& occurrence = occurrences_.at(record);
    if (!occurrence.joined)
    {
      occurrence.joined = true;
      for (const GroundAtom& other : occurrence.fluents)
      {
        addFluent(other, {item, "the action " + toString(records_[record].action) +
                                    " occurred, which ties it to " + rules_.fluentText(fluent)});
      }
    }
  }
}

void Relevance::expandConstraint(std::size_t index, std::size_t number, int item)
{
  const GroundableRule& rule = rules_.rules()[index];
  const RuleLiteral& literal = rule.literals[number];
  RuleBinding binding;
  if (!rules_.unify(rule, literal.arguments, items_[item].atom.arguments, binding))
  {
    return;
  }
  const bool is_head = literal.role == Role::kHead;
  const bool is_default = rule.kind == Kind::kDefault;
  const bool has_head = rule.literals[0].role == Role::kHead;
  if (!is_head && !is_default && has_head && rules_.isDefined(rule.literals[0].symbol) &&
      !evidence_[rule.literals[0].symbol])
  {
    return;  // its definition says nothing about it
  }
  const std::string what =
      (is_default
           ? "the default " + rules_.description().defaults[rule.index].name.name + " ties it to "
       : is_head ? "it can bring about "
                 : "a state constraint ties it to ") +
      rules_.fluentText(items_[item].atom);
  const auto visit = [&](const RuleBinding& instance) { join(rule, instance, item, what); };
  if (is_default)
  {
    forEachLive(index, binding, Basis::kInitially, visit);
  }
  else if (is_head && planning_)
  {
    // what would bring the head about is wanted, though it be false now
    rules_.forEachInstance(
        rule, binding, {}, [](const RuleLiteral&, const RuleBinding&) { return false; }, visit);
  }
  else
  {
    forEachLive(index, binding, planning_ ? Basis::kAlways : Basis::kHistory, visit);
  }
}

void Relevance::expandLaw(std::size_t index, std::size_t number, int item)
{
  const GroundableRule& rule = rules_.rules()[index];
  RuleBinding binding;
  if (!rules_.unify(rule, rule.literals[number].arguments, items_[item].atom.arguments, binding))
  {
    return;
  }
  if (rules_.description().actions[rule.actions[0].symbol].exogenous)
  {
    if (current_step_ > 0)
    {
      expandExogenous(index, binding, item);
    }
  }
  else if (planning_ && rule.literals[number].role == Role::kEffect)
  {
    const auto nothing = [](const RuleLiteral&, const RuleBinding&) { return false; };
    rules_.forEachInstance(rule, binding, actionVariables(rule), nothing,
                           [&](const RuleBinding& instance) {
      const GroundAtom action = actionOf(rule, instance);
      addAction(action, {item, "it can change " + rules_.fluentText(items_[item].atom) + at(rule)});
      for (const RuleLiteral& literal : rule.literals)
      {
        if (literal.role != Role::kEffect)
        {
          addFluent(GroundRules::bound(literal, instance),
                    {action_item_.at(action),
                     "the effect of " + rules_.actionText(action) + " depends on it" + at(rule)});
        }
      }
    });
  }
}

/// A rule about an exogenous action: all that its instances touch may carry evidence.
void Relevance::expandExogenous(std::size_t index, const RuleBinding& binding, int item)
{
  const GroundableRule& rule = rules_.rules()[index];
  for (const RuleAction& mentioned : rule.actions)
  {
    if (!rules_.description().actions[mentioned.symbol].exogenous)
    {
      return;
    }
  }
  const std::string what = "an exogenous action ties it to " + rules_.fluentText(items_[item].atom);
  forEachLive(index, binding, Basis::kHistory, [&](const RuleBinding& instance) {
    join(rule, instance, item, what);
    for (const RuleAction& mentioned : rule.actions)
    {
      std::vector<ConstantId> arguments;
      for (const Slot& slot : mentioned.arguments)
      {
        arguments.push_back(GroundRules::bound(slot, instance));
      }
      for (const std::size_t other : rules_.rulesOfAction(mentioned.symbol))
      {
        const GroundableRule& related = rules_.rules()[other];
        RuleBinding start;
        if (related.kind != Kind::kCost && related.actions.size() == 1 &&
            rules_.unify(related, related.actions[0].arguments, arguments, start))
        {
          forEachLive(other, start, Basis::kHistory,
                      [&](const RuleBinding& deeper) { join(related, deeper, item, what); });
        }
      }
    }
  });
}

/// A useful action: its conditions, its costs, and all that it changes.
void Relevance::expandAction(int item)
{
  const GroundAtom action = items_[item].atom;
  const std::string text = rules_.actionText(action);
  std::unordered_map<GroundAtom, int, GroundAtomHash> changes;
  const auto joinLive =
      [&](std::size_t index, const RuleBinding& binding, const std::string& what) {
    forEachLive(index, binding, Basis::kAlways, [&](const RuleBinding& instance) {
      join(rules_.rules()[index], instance, item, what);
    });
  };
  for (const std::size_t index : rules_.rulesOfAction(action.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    for (const RuleAction& mentioned : rule.actions)
    {
      RuleBinding binding;
      if (mentioned.symbol != action.symbol ||
          !rules_.unify(rule, mentioned.arguments, action.arguments, binding))
      {
        continue;
      }
      if (rule.kind != Kind::kLaw)
      {
        joinLive(index, binding,
                 rule.kind == Kind::kCost ? "the cost of " + text + " depends on it"
                                          : "whether " + text + " is possible depends on it");
        continue;
      }
      forEachLive(index, binding, Basis::kAlways, [&](const RuleBinding& instance) {
        for (const RuleLiteral& literal : rule.literals)
        {
          if (literal.role == Role::kEffect)
          {
            const GroundAtom changed = GroundRules::bound(literal, instance);
            affect(changed, item);
            if (++changes[changed] > 1 || !rules_.serial())  // effects may contradict each other
            {
              addFluent(changed, {item, text + " can change it in several ways"});
            }
          }
        }
        if (std::any_of(rule.literals.begin(), rule.literals.end(), [&](const auto& literal) {
              return literal.role == Role::kEffect &&
                     isRelevant(GroundRules::bound(literal, instance));
            }))
        {
          join(rule, instance, item, "the effect of " + text + " depends on it");
        }
      });
    }
  }
  for (const std::size_t index : rules_.rulesOfAnyAction())
  {
    joinLive(index, RuleBinding(rules_.rules()[index].in_fluent.size(), kUnbound),
             "whether " + text + " is possible depends on it");
  }
}

/// Something changes a fluent: what rested on its value is looked at again.
void Relevance::affect(const GroundAtom& fluent, int from)
{
  if (!affected_.insert(fluent).second)
  {
    return;
  }
  const auto waiting = waiting_.find(fluent);
  if (waiting != waiting_.end())
  {
    queue_.insert(queue_.end(), waiting->second.begin(), waiting->second.end());
    waiting_.erase(waiting);
  }
  run([this, fluent, from] {
    for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
    {
      const GroundableRule& rule = rules_.rules()[index];
      if (rule.kind != Kind::kConstraint)
      {
        continue;
      }
      const bool has_head = rule.literals[0].role == Role::kHead;
      const bool defines = has_head && rules_.isDefined(rule.literals[0].symbol) &&
                           !evidence_[rule.literals[0].symbol];
      for (const RuleLiteral& literal : rule.literals)
      {
        RuleBinding binding;
        if (literal.symbol != fluent.symbol ||
            !rules_.unify(rule, literal.arguments, fluent.arguments, binding))
        {
          continue;
        }
        forEachLive(index, binding, Basis::kAlways, [&](const RuleBinding& instance) {
          if (planning_ && !defines)
          {
            addFluent(fluent, {from, "a change of it can violate a state constraint" + at(rule)});
          }
          if (has_head && literal.role == Role::kBody)
          {
            affect(GroundRules::bound(rule.literals[0], instance), from);
          }
        });
      }
    }
  });
}

GroundAtom Relevance::actionOf(const GroundableRule& rule, const RuleBinding& binding) const
{
  const RuleAction& action = rule.actions[0];
  GroundAtom atom{action.symbol, {}};
  for (std::size_t i = 0; i < action.arguments.size(); ++i)
  {
    atom.arguments.push_back(open_position_[action.symbol][i]
                                 ? kUnbound
                                 : GroundRules::bound(action.arguments[i], binding));
  }
  return atom;
}

std::vector<bool> Relevance::actionVariables(const GroundableRule& rule) const
{
  std::vector<bool> variables(rule.in_fluent.size(), false);
  if (rule.actions.empty())
  {
    return variables;
  }
  const RuleAction& action = rule.actions[0];
  for (std::size_t i = 0; i < action.arguments.size(); ++i)
  {
    if (action.arguments[i].is_variable && !open_position_[action.symbol][i])
    {
      variables[action.arguments[i].id] = true;
    }
  }
  return variables;
}

std::string Relevance::at(const GroundableRule& rule) const
{
  return rule.position.line == 0
             ? ""
             : " (" + rule.position.file + ":" + std::to_string(rule.position.line) + ")";
}

}  // namespace kr3::reasoner
