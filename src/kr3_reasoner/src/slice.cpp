#include "slice.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_set>
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

ProblemSize sizeOf(const Description& description, std::size_t num_records)
{
  ProblemSize size;
  std::unordered_set<std::string> constants;
  std::map<std::string, std::size_t> elements;
  for (const Sort& sort : description.sorts)
  {
    constants.insert(sort.elements.begin(), sort.elements.end());
    elements[sort.name] = sort.elements.size();
  }
  const auto count = [&](const std::vector<std::string>& sorts) {
    std::size_t product = 1;
    for (const std::string& sort : sorts)
    {
      product *= elements[sort];
    }
    return product;
  };
  for (const FluentDeclaration& fluent : description.fluents)
  {
    size.fluents += fluent.kind == FluentKind::kStatic ? 0 : count(fluent.argument_sorts);
  }
  for (const ActionDeclaration& action : description.actions)
  {
    size.actions += action.exogenous ? 0 : count(action.argument_sorts);
  }
  size.constants = constants.size();
  size.records = num_records;
  return size;
}

/// One slice in the making: the symbols, rules, constants and records that it keeps.
class Slicer::Cut
{
public:
  Cut(const Slicer& slicer, const Relevance& relevance)
    : rules_(slicer.rules_)
    , records_(slicer.records_)
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
    keepOccurrences();
  }

  /// Keeps a goal's statics and constants.
  void keepGoal(const Formula& goal)
  {
    forEachLiteral(goal, [this](const Literal& literal) {
      fluent_kept_[rules_.fluentSymbol(literal.atom.name)] = true;
      needAll(rules_.ground(literal.atom, false).arguments);
      need(rules_.constant(literal.value.name));
    });
  }

  /// Closes the kept rules and constants. No relevant instance of a rule mentions other symbols
  /// than the relevant ones, so that rules which do can go.
  void close()
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

  /// Leaves out constants that are alike, but for as many as a plan of so many steps can tell apart
  /// from the rest.
  std::vector<std::string> leaveOutAlike(int horizon)
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

  [[nodiscard]] bool keeps(ConstantId constant) const
  {
    return needed_[constant] || possible_[constant];
  }
  [[nodiscard]] bool keepsRecord(std::size_t record) const { return record_kept_[record]; }
  void need(ConstantId constant)
  {
    if (constant != kUnbound)
    {
      needed_[constant] = true;
    }
  }

  [[nodiscard]] Slice take() const
  {
    const Description& whole = rules_.description();
    Slice slice;
    Description& part = slice.description;
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
    slice.size = sizeOf(part, slice.records.size());
    return slice;
  }

private:
  void needAll(const std::vector<ConstantId>& constants)
  {
    for (const ConstantId constant : constants)
    {
      need(constant);
    }
  }

  void keepItems()
  {
    for (const Relevance::Item& item : relevance_.items())
    {
      (item.is_action ? action_kept_ : fluent_kept_)[item.atom.symbol] = true;
      needAll(item.atom.arguments);
    }
  }

  void keepOccurrences()
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

  void keepStaticRecords()
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

  [[nodiscard]] std::size_t count() const
  {
    return std::count(needed_.begin(), needed_.end(), true) +
           std::count(rule_kept_.begin(), rule_kept_.end(), true) +
           std::count(fluent_kept_.begin(), fluent_kept_.end(), true);
  }

  /// Whether all constants in arguments of fluents and actions are kept.
  [[nodiscard]] bool isOverKept(const GroundableRule& rule) const
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
                 std::all_of(action.arguments.begin(), action.arguments.end(),
                             [&](const Slot& slot) {
        const auto i = static_cast<std::size_t>(&slot - action.arguments.data());
        return kept(slot) || relevance_.isOpenPosition(action.symbol, i);
                 });
        });
  }

  void keepRules()
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

  /// Preferences are transitive: what stands between two defaults that are kept is kept.
  void keepPreferred()
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

  /// The elements that variables of statics stand for: what facts say about them distinguishes
  /// them.
  void needVariables(const GroundableRule& rule, bool derives_static)
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

  [[nodiscard]] bool isChoice(const GroundableRule& rule, const RuleLiteral& effect) const
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

  /// What fluents that are kept, and open arguments of actions, can be.
  void keepValues()
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

  /// Observations of relevant fluents, and what is known initially about others that are left.
  void keepRecords()
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

  /// How many constants that are alike, elements of these sorts, a plan can tell apart: those that
  /// its actions mention, that the variables of one rule stand for, and that fluents have as
  /// values.
  [[nodiscard]] std::size_t distinguishable(const std::vector<bool>& sorts, int horizon) const
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

  void copyRule(const GroundableRule& rule, Description& part) const
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

  const GroundRules& rules_;
  const std::vector<CheckedRecord>& records_;
  int current_step_;
  const Relevance& relevance_;
  std::vector<bool> fluent_kept_;  // statics too
  std::vector<bool> action_kept_;
  std::vector<bool> rule_kept_;
  std::vector<bool> record_kept_;
  std::vector<bool> needed_;    // constants that something names
  std::vector<bool> possible_;  // and those that are mere values
};

Slicer::Slicer(const GroundRules& rules, const std::vector<CheckedRecord>& records,
               int current_step)
  : rules_(rules), records_(records), current_step_(current_step)
{
}

Relevance Slicer::relevanceOf(const Formula& goal) const
{
  Relevance relevance(rules_, records_, current_step_, Relevance::Purpose::kPlan);
  relevance.addGoal(goal);
  relevance.close();
  return relevance;
}

/// Asks for all fluents over a share of the constants that do not matter; these constants.
std::vector<ConstantId> Slicer::addShare(Relevance& relevance, const Formula& goal,
                                         double share) const
{
  Cut cut(*this, relevance);
  cut.keepGoal(goal);
  cut.close();
  static_cast<void>(cut.leaveOutAlike(1));
  std::vector<bool> extra(rules_.numConstants(), false);
  std::vector<ConstantId> added;
  double due = 0.0;
  for (std::size_t i = 0; i < extra.size(); ++i)
  {
    const auto constant = static_cast<ConstantId>(i);
    if (!cut.keeps(constant) && !isNumeric(rules_.name(constant)))
    {
      due += share;
      extra[i] = due >= 1.0;
      due -= extra[i] ? 1.0 : 0.0;
      if (extra[i])
      {
        added.push_back(constant);
      }
    }
  }
  const Description& description = rules_.description();
  for (std::size_t symbol = 0; symbol < description.fluents.size(); ++symbol)
  {
    const FluentDeclaration& fluent = description.fluents[symbol];
    if (fluent.kind == FluentKind::kStatic)
    {
      continue;
    }
    GroundAtom atom{static_cast<int>(symbol), {}};
    const std::function<void(bool)> extend = [&](bool has_extra) {
      const std::size_t position = atom.arguments.size();
      if (position == fluent.argument_sorts.size())
      {
        if (has_extra)
        {
          relevance.addFluent(atom, {-1, "a share of what does not matter was asked for"});
        }
        return;
      }
      for (const ConstantId element :
           rules_.elements(rules_.sortIndex(fluent.argument_sorts[position])))
      {
        if (extra[element] || cut.keeps(element))
        {
          atom.arguments.push_back(element);
          extend(has_extra || extra[element]);
          atom.arguments.pop_back();
        }
      }
    };
    extend(false);
  }
  relevance.close();
  return added;
}

Slice Slicer::forGoal(const Formula& goal, std::optional<int> horizon, double extra_share) const
{
  Relevance relevance = relevanceOf(goal);
  std::vector<ConstantId> extra;
  if (extra_share > 0.0)
  {
    extra = addShare(relevance, goal, extra_share);
  }
  Cut cut(*this, relevance);
  cut.keepGoal(goal);
  for (const ConstantId constant : extra)
  {
    cut.need(constant);
  }
  cut.close();
  std::vector<std::string> spares;
  if (horizon)
  {
    spares = cut.leaveOutAlike(*horizon);
  }
  Slice slice = cut.take();
  slice.spares = std::move(spares);
  return slice;
}

std::optional<Slice> Slicer::forRest(const Formula& goal) const
{
  const Relevance relevance = relevanceOf(goal);
  Relevance rest(rules_, records_, current_step_, Relevance::Purpose::kExplain);
  bool any = false;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (!relevance.concerns(i) && !relevance.isPlainFact(i))
    {
      rest.addRecord(i);
      any = true;
    }
  }
  if (!any)
  {
    return std::nullopt;
  }
  rest.close();
  Cut cut(*this, rest);
  cut.close();
  return cut.take();
}

RelevantPart Slicer::report(const Formula& goal, int horizon) const
{
  const Relevance relevance = relevanceOf(goal);
  const std::vector<Relevance::Item>& items = relevance.items();
  const auto text = [this](const Relevance::Item& item) {
    return item.is_action ? rules_.actionText(item.atom) : rules_.fluentText(item.atom);
  };
  const auto why = [&](std::size_t number) {
    std::vector<std::string> chain;
    for (int i = static_cast<int>(number); i >= 0; i = items[i].origin.from)
    {
      chain.push_back(text(items[i]) + ": " + items[i].origin.because);
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  };
  RelevantPart part;
  std::unordered_set<std::string> explained;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    (items[i].is_action ? part.actions : part.fluents).push_back({text(items[i]), why(i)});
    for (const ConstantId argument : items[i].atom.arguments)
    {
      if (argument != kUnbound && explained.insert(rules_.name(argument)).second)
      {
        part.constants.push_back({rules_.name(argument), why(i)});
        part.constants.back().why.push_back(rules_.name(argument) + ": an argument of " +
                                            text(items[i]));
      }
    }
  }
  const Slice slice = forGoal(goal, horizon, 0.0);
  const std::set<std::string> spares(slice.spares.begin(), slice.spares.end());
  for (const Sort& sort : slice.description.sorts)
  {
    for (const std::string& element : sort.elements)
    {
      if (explained.insert(element).second)
      {
        part.constants.push_back(
            {element,
             {element + (spares.count(element) > 0
                             ? ": stands for others like it, which nothing tells apart"
                             : ": what is relevant can have it as its value or argument")}});
      }
    }
  }
  for (const CheckedRecord& checked : slice.records)
  {
    part.records.push_back(checked.record);
  }
  part.considered = slice.size;
  part.whole = wholeSize();
  return part;
}

ProblemSize Slicer::wholeSize() const
{
  return sizeOf(rules_.description(), records_.size());
}

}  // namespace kr3::reasoner
