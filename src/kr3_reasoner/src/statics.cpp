#include "statics.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "components.hpp"
#include "join.hpp"

namespace kr3::reasoner
{

namespace
{

bool isNegative(const Literal& literal, const FluentDeclaration& fluent)
{
  return fluent.value_sort ? !literal.equal : (literal.value.name == "true") != literal.equal;
}

std::vector<ConstantId> rowOf(const LiteralPattern& literal, const RuleBinding& binding)
{
  std::vector<ConstantId> row;
  row.reserve(literal.arguments.size() + 1);
  for (const Slot& slot : literal.arguments)
  {
    row.push_back(bound(slot, binding));
  }
  row.push_back(bound(literal.value, binding));
  return row;
}

/// Extends a binding so that the literal becomes the row.
bool unify(const LiteralPattern& literal, const std::vector<ConstantId>& row, RuleBinding& binding)
{
  const auto fits = [&](const Slot& slot, ConstantId constant) {
    if (!slot.is_variable)
    {
      return slot.id == constant;
    }
    ConstantId& value = binding[static_cast<std::size_t>(slot.id)];
    value = value == kUnbound ? constant : value;
    return value == constant;
  };
  for (std::size_t i = 0; i < literal.arguments.size(); ++i)
  {
    if (!fits(literal.arguments[i], row[i]))
    {
      return false;
    }
  }
  return fits(literal.value, row.back());
}

}  // namespace

/// An axiom that derives a static.
struct Statics::Derivation
{
  /// @param isOpen  whether a static is derived together with the head: its absence is not known
  ///                while this goes on
  template <typename IsOpen>
  Derivation(const StateConstraint& constraint, Vocabulary& vocabulary, const IsOpen& isOpen)
    : reader(vocabulary)
  {
    head = reader.literal(*constraint.head);
    for (const Condition& condition : constraint.body)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        const int symbol = vocabulary.fluentSymbol(literal->atom.name);
        if (isOpen(symbol) && isNegative(*literal, vocabulary.fluent(symbol)))
        {
          absent.push_back(reader.literal(*literal));
          continue;
        }
        reader.addStatic(*literal);
        if (isOpen(symbol))
        {
          open.push_back(reader.conditions().statics.size() - 1);
        }
      }
      else if (const auto* comparison = std::get_if<Comparison>(&condition))
      {
        reader.add(*comparison);
      }
      else
      {
        reader.add(std::get<Membership>(condition));
      }
    }
  }

  [[nodiscard]] std::vector<bool> variablesOf(const LiteralPattern& literal) const
  {
    std::vector<bool> variables(reader.conditions().numVariables(), false);
    mark(literal, variables);
    return variables;
  }

  [[nodiscard]] std::vector<bool> wanted() const
  {
    std::vector<bool> variables = variablesOf(head);
    std::for_each(absent.begin(), absent.end(),
                  [&](const LiteralPattern& literal) { mark(literal, variables); });
    return variables;
  }

  static void mark(const LiteralPattern& literal, std::vector<bool>& variables)
  {
    const auto use = [&](const Slot& slot) {
      if (slot.is_variable)
      {
        variables[static_cast<std::size_t>(slot.id)] = true;
      }
    };
    std::for_each(literal.arguments.begin(), literal.arguments.end(), use);
    use(literal.value);
  }

  ConditionReader reader;
  LiteralPattern head;
  std::vector<std::size_t> open;       // conditions on rows that are derived together with the head
  std::vector<LiteralPattern> absent;  // negative ones
};

Statics::Statics(Vocabulary& vocabulary, const SearchLimit& limit)
  : vocabulary_(vocabulary), limit_(limit)
{
  const Description& description = vocabulary.description();
  relations_.resize(description.fluents.size());
  for (std::size_t i = 0; i < relations_.size(); ++i)
  {
    const std::size_t columns = description.fluents[i].argument_sorts.size() + 1;
    relations_[i].by_constant.resize(columns);
    relations_[i].num_constants.resize(columns, 0);
  }
  for (const Literal& fact : description.static_facts)
  {
    if (!fact.equal || fact.value.name == "false")
    {
      continue;
    }
    std::vector<ConstantId> row;
    for (const Term& argument : fact.atom.arguments)
    {
      row.push_back(vocabulary.add(argument.name));
    }
    row.push_back(vocabulary.add(fact.value.name));
    insert(vocabulary.fluentSymbol(fact.atom.name), std::move(row));
  }
  derive();
}

bool Statics::insert(int symbol, std::vector<ConstantId> row)
{
  Relation& relation = relations_[symbol];
  if (!relation.known.insert(row).second)
  {
    return false;
  }
  const auto number = static_cast<std::uint32_t>(relation.rows.size());
  for (std::size_t column = 0; column < row.size(); ++column)
  {
    auto& lists = relation.by_constant[column];
    const auto constant = static_cast<std::size_t>(row[column]);
    if (lists.size() <= constant)
    {
      lists.resize(constant + 1);
    }
    relation.num_constants[column] += lists[constant].empty() ? 1 : 0;
    lists[constant].push_back(number);
  }
  relation.rows.push_back(std::move(row));
  return true;
}

void Statics::derive()
{
  const Description& description = vocabulary_.description();
  std::vector<std::vector<std::size_t>> edges(relations_.size());
  std::vector<const StateConstraint*> axioms;
  for (const StateConstraint& constraint : description.constraints)
  {
    const int head = constraint.head ? vocabulary_.fluentSymbol(constraint.head->atom.name) : -1;
    if (head < 0 || !vocabulary_.isStatic(head))
    {
      continue;
    }
    axioms.push_back(&constraint);
    for (const Condition& condition : constraint.body)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        edges[static_cast<std::size_t>(head)].push_back(
            static_cast<std::size_t>(vocabulary_.fluentSymbol(literal->atom.name)));
      }
    }
  }
  if (axioms.empty())
  {
    return;
  }
  const Components components(edges);
  for (std::size_t component = 1; component <= components.numComponents(); ++component)
  {
    const auto isInside = [&](int symbol) {
      return components.component(static_cast<std::size_t>(symbol)) == component;
    };
    std::vector<std::unique_ptr<Derivation>> owned;
    Derivations rules;
    std::vector<int> symbols;
    bool negation = false;
    for (const StateConstraint* axiom : axioms)
    {
      const int head = vocabulary_.fluentSymbol(axiom->head->atom.name);
      if (isInside(head))
      {
        owned.push_back(std::make_unique<Derivation>(*axiom, vocabulary_, isInside));
        rules.push_back(owned.back().get());
        symbols.push_back(head);
        negation = negation || !rules.back()->absent.empty();
      }
    }
    if (negation)
    {
      deriveWithNegation(rules, symbols);
    }
    else if (!rules.empty())
    {
      deriveAll(rules, {});
    }
  }
}

/// The alternating fixpoint (Van Gelder 1993): what is derived when as little, then as much as
/// possible is absent, until what must be in does not grow.
void Statics::deriveWithNegation(const Derivations& rules, const std::vector<int>& symbols)
{
  const std::vector<Relation> facts = relations_;
  std::vector<Relation> certain = facts;
  const auto derivedFrom = [&](const std::vector<Relation>& assumed) {
    for (const int symbol : symbols)
    {
      relations_[symbol] = facts[symbol];
    }
    deriveAll(rules, assumed);
    return relations_;
  };
  for (bool grown = true; grown;)
  {
    const std::vector<Relation> possible = derivedFrom(certain);
    std::vector<Relation> next = derivedFrom(possible);
    grown = std::any_of(symbols.begin(), symbols.end(), [&](int symbol) {
      return next[symbol].rows.size() > certain[symbol].rows.size();
    });
    certain = std::move(next);
  }
}

/// Derives all rows of statics that rest on one another.
/// @param assumed  by symbol: the rows that absence is decided by
void Statics::deriveAll(const Derivations& rules, const std::vector<Relation>& assumed)
{
  struct NewRow
  {
    int symbol;
    std::vector<ConstantId> row;
  };
  std::vector<NewRow> open;
  const auto isAbsent = [&](const LiteralPattern& literal, const RuleBinding& binding) {
    std::vector<ConstantId> row = rowOf(literal, binding);
    row.back() = row.back() == Vocabulary::kFalse ? Vocabulary::kTrue : row.back();
    return assumed[literal.symbol].known.count(row) == 0;
  };
  const auto run = [&](const Derivation& rule, const RuleBinding& start, Join& join) {
    std::vector<std::vector<ConstantId>> derived;
    join.forEach(start, [&](const RuleBinding& binding) {
      if (std::all_of(rule.absent.begin(), rule.absent.end(),
                      [&](const auto& literal) { return isAbsent(literal, binding); }))
      {
        derived.push_back(rowOf(rule.head, binding));
      }
    });
    for (std::vector<ConstantId>& row : derived)
    {
      if (insert(rule.head.symbol, row))
      {
        open.push_back({rule.head.symbol, std::move(row)});
      }
    }
  };
  struct Continuation
  {
    const Derivation* rule;
    const LiteralPattern* literal;
    Join join;
  };
  std::vector<Continuation> continuations;
  for (const Derivation* rule : rules)
  {
    const Conditions& conditions = rule->reader.conditions();
    const std::vector<bool> wanted = rule->wanted();
    const std::vector<bool> none(conditions.numVariables(), false);
    Join join(conditions, *this, none, wanted, limit_);
    run(*rule, RuleBinding(conditions.numVariables(), kUnbound), join);
    for (const std::size_t i : rule->open)
    {
      const LiteralPattern& literal = conditions.statics[i];
      continuations.push_back(
          {rule, &literal, Join(conditions, *this, rule->variablesOf(literal), wanted, limit_)});
    }
  }
  for (std::size_t next = 0; next < open.size(); ++next)
  {
    const NewRow row = open[next];
    for (Continuation& continuation : continuations)
    {
      RuleBinding start(continuation.rule->reader.conditions().numVariables(), kUnbound);
      if (continuation.literal->symbol == row.symbol &&
          unify(*continuation.literal, row.row, start))
      {
        run(*continuation.rule, start, continuation.join);
      }
    }
  }
}

bool Statics::holds(int symbol, const std::vector<ConstantId>& arguments, ConstantId value,
                    bool equal) const
{
  std::vector<ConstantId> row = arguments;
  const bool negative = value == Vocabulary::kFalse && !vocabulary_.fluent(symbol).value_sort;
  row.push_back(negative ? Vocabulary::kTrue : value);
  return (relations_[symbol].known.count(row) > 0) == (equal != negative);
}

bool Statics::holds(const LiteralPattern& literal, const RuleBinding& binding) const
{
  std::vector<ConstantId> arguments;
  arguments.reserve(literal.arguments.size() + 1);
  for (const Slot& slot : literal.arguments)
  {
    arguments.push_back(bound(slot, binding));
  }
  return holds(literal.symbol, arguments, bound(literal.value, binding), literal.equal);
}

const std::vector<std::uint32_t>& Statics::rowsWith(int symbol, std::size_t column,
                                                    ConstantId constant) const
{
  static const std::vector<std::uint32_t> none;
  const auto& lists = relations_[symbol].by_constant[column];
  return static_cast<std::size_t>(constant) < lists.size() ? lists[constant] : none;
}

double Statics::rowsPerConstant(int symbol, std::size_t column) const
{
  const Relation& relation = relations_[symbol];
  return relation.rows.empty() ? 0.0
                               : static_cast<double>(relation.rows.size()) /
                                     static_cast<double>(relation.num_constants[column]);
}

}  // namespace kr3::reasoner
