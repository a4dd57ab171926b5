#include "slice_cut.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace kr3::reasoner
{

namespace
{

using Kind = GroundableRule::Kind;
using Role = RuleLiteral::Role;

void forEachLiteral(const Formula& formula, const std::function<void(const Literal&)>& visit)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    visit(formula.literal);
  }
  for (const Formula& operand : formula.operands)
  {
    forEachLiteral(operand, visit);
  }
}

/// Keeps those elements of a vector whose numbers are marked.
template <typename Item>
std::vector<Item> marked(const std::vector<Item>& items, const std::vector<bool>& marks)
{
  std::vector<Item> kept;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    if (marks[i])
    {
      kept.push_back(items[i]);
    }
  }
  return kept;
}

bool isNumeric(const std::string& name)
{
  return name.find_first_not_of("-0123456789") == std::string::npos;
}

}  // namespace

Slicer::Cut::Cut(const Slicer& slicer, const Relevance& relevance)
  : whole_(slicer.whole_)
  , rules_(slicer.rules_)
  , records_(slicer.records_)
  , beginning_(slicer.beginning_.get())
  , num_facts_(slicer.numFacts())
  , current_step_(slicer.current_step_)
  , relevance_(relevance)
  , fluent_kept_(rules_.description().fluents.size(), false)
  , action_kept_(rules_.description().actions.size(), false)
  , rule_kept_(rules_.rules().size(), false)
  , record_kept_(records_.size(), false)
  , needed_(rules_.numConstants(), false)
  , possible_(rules_.numConstants(), false)
{
  keepItems();
  keepBeginning();
  keepOccurrences();
}

void Slicer::Cut::keepGoal(const Formula& goal)
{
  forEachLiteral(goal, [this](const Literal& literal) {
    fluent_kept_[rules_.fluentSymbol(literal.atom.name)] = true;
    needAll(rules_.ground(literal.atom, false).arguments);
    need(rules_.constant(literal.value.name));
  });
}

void Slicer::Cut::close()
{
  keepStaticRecords();
  std::size_t before = 0;
  do
  {
    before = count();
    keepRules();
  } while (count() != before);
  keepValues();
  keepRecords();
}

std::vector<std::string> Slicer::Cut::leaveOutAlike(int horizon)
{
  std::map<std::vector<bool>, std::vector<ConstantId>> alike;
  for (ConstantId constant = 0; constant < static_cast<ConstantId>(possible_.size()); ++constant)
  {
    if (possible_[constant] && !needed_[constant] && !isNumeric(rules_.name(constant)))
    {
      std::vector<bool> sorts;
      for (std::size_t sort = 0; sort < rules_.description().sorts.size(); ++sort)
      {
        sorts.push_back(rules_.inSort(constant, static_cast<int>(sort)));
      }
      alike[sorts].push_back(constant);
    }
  }
  std::vector<std::string> spares;
  if (!rules_.serial())
  {
    return spares;
  }
  for (const auto& [sorts, constants] : alike)
  {
    const std::size_t wanted = distinguishable(sorts, horizon);
    if (constants.size() <= wanted)
    {
      continue;
    }
    for (std::size_t i = 0; i < constants.size(); ++i)
    {
      if (i < wanted)
      {
        spares.push_back(rules_.name(constants[i]));
      }
      else
      {
        possible_[constants[i]] = false;
      }
    }
  }
  return spares;
}

bool Slicer::Cut::keeps(ConstantId constant) const
{
  return needed_[constant] || possible_[constant];
}

void Slicer::Cut::need(ConstantId constant)
{
  if (constant != kUnbound)
  {
    needed_[constant] = true;
  }
}

Description Slicer::Cut::description() const
{
  const Description& whole = rules_.description();
  Description part;
  for (const Sort& sort : whole.sorts)
  {
    part.sorts.push_back({sort.name, {}, sort.member_sorts, sort.position});
    for (const ConstantId element : rules_.elements(rules_.sortIndex(sort.name)))
    {
      if (keeps(element))
      {
        part.sorts.back().elements.push_back(rules_.name(element));
      }
    }
  }
  part.fluents = marked(whole.fluents, fluent_kept_);
  part.actions = marked(whole.actions, action_kept_);
  for (const Literal& fact : whole.static_facts)
  {
    const GroundAtom atom = rules_.ground(fact.atom, false);
    if (fluent_kept_[atom.symbol] && keeps(rules_.constant(fact.value.name)) &&
        std::all_of(atom.arguments.begin(), atom.arguments.end(),
                    [this](ConstantId argument) { return keeps(argument); }))
    {
      part.static_facts.push_back(fact);
    }
  }
  for (std::size_t i = 0; i < rule_kept_.size(); ++i)
  {
    if (rule_kept_[i])
    {
      copyRule(rules_.rules()[i], part);
    }
  }
  for (const Executability& rule : whole.executabilities)
  {
    const bool any_two = rule.actions.size() == 2 &&
                         std::holds_alternative<Term>(rule.actions[0]) &&
                         std::holds_alternative<Term>(rule.actions[1]) && rule.body.size() == 1 &&
                         std::holds_alternative<Comparison>(rule.body[0]);
    if (any_two)
    {
      part.executabilities.push_back(rule);
    }
  }
  for (const Preference& preference : whole.preferences)
  {
    const auto has = [&](const Atom& name) {
      return std::any_of(part.defaults.begin(), part.defaults.end(),
                         [&](const Default& rule) { return rule.name.name == name.name; });
    };
    if (has(preference.better) && has(preference.worse))
    {
      part.preferences.push_back(preference);
    }
  }
  return part;
}

/// What decides over the content.
SliceStore::Key Slicer::Cut::key() const
{
  SliceStore::Key key;
  for (const auto* kept : {&fluent_kept_, &action_kept_, &rule_kept_})
  {
    key.insert(key.end(), kept->begin(), kept->end());
  }
  for (std::size_t constant = 0; constant < needed_.size(); ++constant)
  {
    key.push_back(keeps(static_cast<ConstantId>(constant)));
  }
  return key;
}

Slice Slicer::Cut::take() const
{
  const Description& whole = rules_.description();
  Slice slice;
  slice.domain = whole_.slices().find(
      key(), [this] { return std::make_shared<DomainKnowledge>(description(), whole_.options()); });
  slice.records = marked(records_, record_kept_);
  for (const Relevance::Item& item : relevance_.items())
  {
    if (!item.is_action)
    {
      Literal literal;
      literal.atom.name = whole.fluents[item.atom.symbol].name;
      for (const ConstantId argument : item.atom.arguments)
      {
        literal.atom.arguments.push_back({false, rules_.name(argument)});
      }
      slice.relevant.push_back(std::move(literal));
    }
  }
  slice.num_facts = static_cast<std::size_t>(std::count(
      record_kept_.begin(), record_kept_.begin() + static_cast<std::ptrdiff_t>(num_facts_), true));
  slice.beginning = beginning();
  slice.size = slice.domain->size(slice.records.size() - slice.num_facts);
  return slice;
}

void Slicer::Cut::needAll(const std::vector<ConstantId>& constants)
{
  for (const ConstantId constant : constants)
  {
    need(constant);
  }
}

void Slicer::Cut::keepItems()
{
  for (const Relevance::Item& item : relevance_.items())
  {
    (item.is_action ? action_kept_ : fluent_kept_)[item.atom.symbol] = true;
    needAll(item.atom.arguments);
  }
}

void Slicer::Cut::keepOccurrences()
{
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (records_[i].isAction() && relevance_.concerns(i))
    {
      record_kept_[i] = true;
      const GroundAtom action = rules_.ground(records_[i].action, true);
      action_kept_[action.symbol] = true;
      needAll(action.arguments);
    }
  }
  const Description& description = rules_.description();
  for (std::size_t i = 0; current_step_ > 0 && i < rules_.rules().size(); ++i)
  {
    const GroundableRule& rule = rules_.rules()[i];
    if (rule.kind == Kind::kLaw && description.actions[rule.actions[0].symbol].exogenous)
    {
      for (const RuleLiteral& literal : rule.literals)
      {
        if (literal.role == Role::kEffect && fluent_kept_[literal.symbol])
        {
          action_kept_[rule.actions[0].symbol] = true;
        }
      }
    }
  }
}

void Slicer::Cut::keepStaticRecords()
{
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    const CheckedRecord& checked = records_[i];
    if (checked.isAction() || !rules_.isStatic(rules_.fluentSymbol(checked.literal.atom.name)))
    {
      continue;
    }
    record_kept_[i] = true;
    fluent_kept_[rules_.fluentSymbol(checked.literal.atom.name)] = true;
    needAll(rules_.ground(checked.literal.atom, false).arguments);
    need(rules_.constant(checked.literal.value.name));
  }
}

std::size_t Slicer::Cut::count() const
{
  return std::count(needed_.begin(), needed_.end(), true) +
         std::count(rule_kept_.begin(), rule_kept_.end(), true) +
         std::count(fluent_kept_.begin(), fluent_kept_.end(), true);
}

bool Slicer::Cut::isOverKept(const GroundableRule& rule) const
{
  const auto kept = [this](const Slot& slot) { return slot.is_variable || needed_[slot.id]; };
  return std::all_of(
             rule.literals.begin(), rule.literals.end(),
             [&](const RuleLiteral& literal) {
    return fluent_kept_[literal.symbol] &&
           std::all_of(literal.arguments.begin(), literal.arguments.end(), kept);
             }) &&
      std::all_of(rule.actions.begin(), rule.actions.end(), [&](const RuleAction& action) {
        return action_kept_[action.symbol] &&
               std::all_of(action.arguments.begin(), action.arguments.end(), [&](const Slot& slot) {
                 const auto i = static_cast<std::size_t>(&slot - action.arguments.data());
                 return kept(slot) || relevance_.isOpenPosition(action.symbol, i);
               });
      });
}

void Slicer::Cut::keepRules()
{
  for (std::size_t i = 0; i < rules_.rules().size(); ++i)
  {
    const GroundableRule& rule = rules_.rules()[i];
    const bool derives_static =
        rule.literals.empty() && !rule.statics.empty() && rule.statics[0].role == Role::kHead;
    if (rule_kept_[i] ||
        (derives_static ? !fluent_kept_[rule.statics[0].symbol] : !isOverKept(rule)))
    {
      continue;
    }
    rule_kept_[i] = true;
    const auto needSlot = [this](const Slot& slot) {
      if (!slot.is_variable)
      {
        need(slot.id);
      }
    };
    for (const RuleLiteral& literal : rule.literals)
    {
      needSlot(literal.value);
    }
    for (const RuleAction& action : rule.actions)
    {
      std::for_each(action.arguments.begin(), action.arguments.end(), needSlot);
    }
    for (const auto& relation : rule.relations)
    {
      needSlot(relation.left);
      needSlot(relation.right);
    }
    for (const RuleLiteral& literal : rule.statics)
    {
      fluent_kept_[literal.symbol] = true;
      std::for_each(literal.arguments.begin(), literal.arguments.end(), needSlot);
      needSlot(literal.value);
    }
    needVariables(rule, derives_static);
  }
  keepPreferred();
}

void Slicer::Cut::keepPreferred()
{
  const auto rulesOf = [this](const Atom& name) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < rules_.rules().size(); ++i)
    {
      const GroundableRule& rule = rules_.rules()[i];
      if (rule.kind == Kind::kDefault &&
          rules_.description().defaults[rule.index].name.name == name.name)
      {
        found.push_back(i);
      }
    }
    return found;
  };
  for (const Preference& preference : rules_.description().preferences)
  {
    std::vector<std::size_t> both = rulesOf(preference.better);
    const std::vector<std::size_t> worse = rulesOf(preference.worse);
    both.insert(both.end(), worse.begin(), worse.end());
    const bool any = std::any_of(both.begin(), both.end(),
                                 [this](std::size_t rule) { return rule_kept_[rule]; });
    for (std::size_t i = 0; any && i < both.size(); ++i)
    {
      for (const RuleLiteral& literal : rules_.rules()[both[i]].literals)
      {
        fluent_kept_[literal.symbol] = true;
      }
    }
  }
}

void Slicer::Cut::needVariables(const GroundableRule& rule, bool derives_static)
{
  std::vector<bool> in_static(rule.in_fluent.size(), derives_static);
  for (const RuleLiteral& literal : rule.statics)
  {
    for (const Slot& slot : literal.arguments)
    {
      if (slot.is_variable)
      {
        in_static[slot.id] = true;
      }
    }
    if (literal.value.is_variable)
    {
      in_static[literal.value.id] = true;
    }
  }
  for (const RuleLiteral& literal : rule.literals)
  {
    if (literal.role == Role::kEffect && literal.value.is_variable && rule.kind == Kind::kLaw &&
        isChoice(rule, literal))
    {
      in_static[literal.value.id] = true;  // each may come out
    }
  }
  for (std::size_t variable = 0; variable < in_static.size(); ++variable)
  {
    if (in_static[variable] && (derives_static || !rule.in_fluent[variable]))
    {
      for (const int sort : rule.variable_sorts[variable])
      {
        needAll(rules_.elements(sort));
      }
    }
  }
}

bool Slicer::Cut::isChoice(const GroundableRule& rule, const RuleLiteral& effect) const
{
  for (const Outcome& outcome : rules_.description().causal_laws[rule.index].outcomes)
  {
    for (const Effect& candidate : outcome.effects)
    {
      if (candidate.is_choice && rules_.fluentSymbol(candidate.fluent.name) == effect.symbol)
      {
        return true;
      }
    }
  }
  return false;
}

void Slicer::Cut::keepValues()
{
  const Description& description = rules_.description();
  const auto all = [this](const std::string& sort) {
    for (const ConstantId element : rules_.elements(rules_.sortIndex(sort)))
    {
      possible_[element] = true;
    }
  };
  for (std::size_t i = 0; i < fluent_kept_.size(); ++i)
  {
    const FluentDeclaration& fluent = description.fluents[i];
    if (fluent_kept_[i] && fluent.value_sort)
    {
      all(*fluent.value_sort);
    }
  }
  for (std::size_t i = 0; i < action_kept_.size(); ++i)
  {
    const ActionDeclaration& action = description.actions[i];
    for (std::size_t j = 0; action_kept_[i] && j < action.argument_sorts.size(); ++j)
    {
      if (relevance_.isOpenPosition(static_cast<int>(i), j))
      {
        all(action.argument_sorts[j]);
      }
    }
  }
  need(rules_.constant("true"));
  need(rules_.constant("false"));
}

void Slicer::Cut::keepRecords()
{
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    const CheckedRecord& checked = records_[i];
    if (record_kept_[i] || checked.isAction())
    {
      continue;
    }
    const GroundAtom fluent = rules_.ground(checked.literal.atom, false);
    const bool over_kept = fluent_kept_[fluent.symbol] &&
                           std::all_of(fluent.arguments.begin(), fluent.arguments.end(),
                                       [this](ConstantId argument) { return keeps(argument); });
    if (over_kept && (relevance_.isRelevant(fluent) || relevance_.isPlainFact(i)))
    {
      record_kept_[i] = true;
      need(rules_.constant(checked.literal.value.name));
    }
  }
}

std::size_t Slicer::Cut::distinguishable(const std::vector<bool>& sorts, int horizon) const
{
  const Description& description = rules_.description();
  const auto among = [&](const std::string& sort) { return sorts[rules_.sortIndex(sort)]; };
  std::size_t in_rule = 0;
  for (std::size_t i = 0; i < rule_kept_.size(); ++i)
  {
    const auto& variables = rules_.rules()[i].variable_sorts;
    const auto count = std::count_if(variables.begin(), variables.end(), [&](const auto& of) {
      return std::all_of(of.begin(), of.end(), [&](int sort) { return sorts[sort]; });
    });
    in_rule = std::max(in_rule, rule_kept_[i] ? static_cast<std::size_t>(count) : 0);
  }
  std::size_t in_action = 0;
  bool exogenous = false;
  for (std::size_t i = 0; i < action_kept_.size(); ++i)
  {
    const ActionDeclaration& action = description.actions[i];
    const auto count =
        std::count_if(action.argument_sorts.begin(), action.argument_sorts.end(), among);
    in_action = std::max(in_action, action_kept_[i] ? static_cast<std::size_t>(count) : 0);
    exogenous = exogenous || (action_kept_[i] && action.exogenous);
  }
  std::size_t values = 0;
  for (std::size_t i = 0; i < fluent_kept_.size(); ++i)
  {
    const FluentDeclaration& fluent = description.fluents[i];
    std::size_t instances =
        fluent_kept_[i] && fluent.value_sort && among(*fluent.value_sort) ? 1 : 0;
    for (const std::string& name : fluent.argument_sorts)
    {
      const auto& elements = rules_.elements(rules_.sortIndex(name));
      instances *= std::count_if(elements.begin(), elements.end(),
                                 [this](ConstantId element) { return bool{needed_[element]}; });
    }
    values += instances;
  }
  return in_action * static_cast<std::size_t>(horizon) + in_rule +
         values * (exogenous ? static_cast<std::size_t>(current_step_) + 1 : 1);
}

void Slicer::Cut::copyRule(const GroundableRule& rule, Description& part) const
{
  const Description& whole = rules_.description();
  switch (rule.kind)
  {
    case Kind::kConstraint:
      part.constraints.push_back(whole.constraints[rule.index]);
      break;
    case Kind::kLaw:
      part.causal_laws.push_back(whole.causal_laws[rule.index]);
      break;
    case Kind::kExecutability:
      part.executabilities.push_back(whole.executabilities[rule.index]);
      break;
    case Kind::kDefault:
      part.defaults.push_back(whole.defaults[rule.index]);
      break;
    case Kind::kCost:
      part.costs.push_back(whole.costs[rule.index]);
      break;
  }
}

}  // namespace kr3::reasoner
