#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "history_theory.hpp"

// What the history and the defaults add to the clauses of a HistoryTheory.
namespace kr3::reasoner
{

namespace
{

template <typename Item>
bool may(const std::set<Item>* allowed, const Item& item)
{
  return allowed == nullptr || allowed->count(item) > 0;
}

}  // namespace

int HistoryTheory::originOf(std::size_t record)
{
  const auto known = record_origins_.find(record);
  if (known != record_origins_.end())
  {
    return known->second;
  }
  ClauseOrigin origin;
  origin.kind = records_[record].isAction() ? ReasonKind::kHappened : ReasonKind::kObserved;
  origin.step = records_[record].record.step;
  origin.position = records_[record].record.position;
  origin.record = record;
  return record_origins_[record] = addOrigin(std::move(origin));
}

void HistoryTheory::assumeRecords(const Evidence& evidence)
{
  const auto assume = [&](const FiniteLiteral& literal, int origin) {
    propagation_.assume(propagation_.addInference({literal, origin, {}, {}}));
  };
  std::set<std::size_t> wrong;
  for (const Clingo::Symbol& assumed : world_.assumed)
  {
    wrong.insert(words_.wrongRecord(assumed));
  }
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    const CheckedRecord& checked = records_[i];
    if (!checked.isAction() && may(evidence.records, i) && wrong.count(i) == 0 &&
        fluentIndex(checked.literal.atom))
    {
      assume(at(checked.literal, checked.record.step), originOf(i));
    }
  }
  for (std::size_t i = 0; i < rules_.occurrences().size(); ++i)
  {
    const Occurrence& occurrence = rules_.occurrences()[i];
    const FiniteLiteral happens{occurrence_variables_[i], 1, !occurrence.failed, occurrence.step};
    if (occurrence.assumed)
    {
      if (may(evidence.assumed, *occurrence.assumed))
      {
        ClauseOrigin origin;
        origin.kind = ReasonKind::kAssumed;
        origin.step = occurrence.step;
        origin.assumed = occurrence.assumed;
        origin.record = occurrence.record;
        assume(happens, addOrigin(std::move(origin)));
      }
    }
    else if (may(evidence.records, occurrence.record))
    {
      assume(happens, originOf(occurrence.record));
    }
  }
}

/// Grows from records, assumed exceptions and defaults, in this order, each time with what the
/// rules make of it.
class HistoryTheory::InitialClosure
{
public:
  InitialClosure(HistoryTheory& theory, const Evidence& evidence,
                 const std::vector<GroundDefault>& excepted)
    : theory_(theory), evidence_(evidence), excepted_(excepted)
  {
  }

  std::vector<int> conclusions() &&
  {
    addRecords();
    addExceptions();
    addDefaults();
    addExcepted();
    return std::move(conclusions_);
  }

private:
  using Key = std::pair<int, std::pair<int, bool>>;

  static Key keyOf(const FiniteLiteral& literal)
  {
    return {literal.variable, {literal.value, literal.equal}};
  }
  [[nodiscard]] FiniteLiteral canonical(const Literal& open) const;
  /// The inference of a literal that is known, or -1.
  int find(const Literal& literal);
  std::optional<std::vector<int>> findAll(const std::vector<Literal>& body);
  bool add(const Literal& literal, int origin, std::vector<int> antecedents);
  bool apply(const GroundDefault& instance, const std::vector<int>& body, ReasonKind kind);
  void close();
  void addRecords();
  void addExceptions();
  void addDefaults();
  bool addOneDefault();
  /// Defaults that are supposed to have applied nevertheless.
  void addExcepted();

  HistoryTheory& theory_;
  const Evidence& evidence_;
  const std::vector<GroundDefault>& excepted_;
  std::map<Key, int> known_;
  std::vector<int> conclusions_;
};

FiniteLiteral HistoryTheory::InitialClosure::canonical(const Literal& open) const
{
  FiniteLiteral literal = theory_.at(open, 0);
  if (theory_.values_[*theory_.meaning(literal.variable).fluent].size() == 2 && !literal.equal)
  {
    literal.value = 1 - literal.value;
    literal.equal = true;
  }
  return literal;
}

int HistoryTheory::InitialClosure::find(const Literal& open)
{
  const FiniteLiteral literal = canonical(open);
  const auto found = known_.find(keyOf(literal));
  if (found != known_.end() || literal.equal)
  {
    return found == known_.end() ? -1 : found->second;
  }
  const std::size_t num_values = theory_.values_[*theory_.fluentIndex(open.atom)].size();
  for (std::size_t value = 0; value < num_values; ++value)
  {
    const FiniteLiteral other{literal.variable, static_cast<int>(value), true, 0};
    const auto equal = known_.find(keyOf(other));
    if (equal != known_.end() && other.value != literal.value)
    {
      return theory_.propagation_.addInference(
          {literal, Inference::kImplied, {equal->second}, {0}});
    }
  }
  return -1;
}

std::optional<std::vector<int>> HistoryTheory::InitialClosure::findAll(
    const std::vector<Literal>& body)
{
  std::vector<int> found;
  for (const Literal& literal : body)
  {
    found.push_back(find(literal));
  }
  const bool all = std::find(found.begin(), found.end(), -1) == found.end();
  return all ? std::make_optional(found) : std::nullopt;
}

bool HistoryTheory::InitialClosure::add(const Literal& open, int origin,
                                        std::vector<int> antecedents)
{
  if (!theory_.fluentIndex(open.atom) || find(open) >= 0)
  {
    return false;
  }
  std::vector<int> used_at(antecedents.size(), 0);
  const FiniteLiteral literal = canonical(open);
  conclusions_.push_back(theory_.propagation_.addInference(
      {literal, origin, std::move(antecedents), std::move(used_at)}));
  known_[keyOf(literal)] = conclusions_.back();
  return true;
}

bool HistoryTheory::InitialClosure::apply(const GroundDefault& instance,
                                          const std::vector<int>& body, ReasonKind kind)
{
  ClauseOrigin origin;
  origin.kind = kind;
  origin.position = instance.rule->position;
  origin.default_name = instance.name;
  return add(instance.head, theory_.addOrigin(std::move(origin)), body);
}

void HistoryTheory::InitialClosure::close()
{
  for (bool grown = true; grown;)
  {
    grown = false;
    for (const GroundRule& rule : theory_.rules_.rules())
    {
      const auto body = rule.head ? findAll(rule.body) : std::nullopt;
      if (!body || find(*rule.head) >= 0)
      {
        continue;
      }
      ClauseOrigin origin;
      origin.kind = ReasonKind::kConstraint;
      origin.position = rule.position;
      origin.law = rule.law;
      grown = add(*rule.head, theory_.addOrigin(std::move(origin)), *body) || grown;
    }
  }
}

void HistoryTheory::InitialClosure::addRecords()
{
  const auto& assumed = theory_.world_.assumed;
  for (std::size_t i = 0; i < theory_.records_.size(); ++i)
  {
    const CheckedRecord& checked = theory_.records_[i];
    const bool right = std::none_of(assumed.begin(), assumed.end(), [&](const auto& symbol) {
      return theory_.words_.wrongRecord(symbol) == i;
    });
    if (!checked.isAction() && checked.record.step == 0 && right && may(evidence_.records, i))
    {
      add(checked.literal, theory_.originOf(i), {});
    }
  }
  close();
}

void HistoryTheory::InitialClosure::addExceptions()
{
  const auto& assumed = theory_.world_.assumed;
  for (std::size_t i = 0; i < assumed.size(); ++i)
  {
    if (!theory_.words_.isException(assumed[i]) || !may(evidence_.assumed, i))
    {
      continue;
    }
    const Literal literal = theory_.words_.exception(assumed[i]);
    const bool opposed =
        std::any_of(excepted_.begin(), excepted_.end(), [&](const GroundDefault& instance) {
          return toString(contrary(instance.head, theory_.description_)) == toString(literal);
        });
    if (!opposed)
    {
      ClauseOrigin origin;
      origin.kind = ReasonKind::kException;
      origin.assumed = i;
      add(literal, theory_.addOrigin(std::move(origin)), {});
      close();
    }
  }
}

void HistoryTheory::InitialClosure::addDefaults()
{
  while (addOneDefault())
  {
    close();
  }
}

bool HistoryTheory::InitialClosure::addOneDefault()
{
  const InitialWorld& world = theory_.world_;
  for (const GroundDefault& instance : theory_.rules_.defaults())
  {
    // what the exception opens does not apply when it is taken back
    const bool opposed =
        std::any_of(excepted_.begin(), excepted_.end(), [&](const GroundDefault& other) {
          return toString(other.head.atom) == toString(instance.head.atom);
        });
    if (opposed || !may(evidence_.defaults, instance.name) || !world.knows(instance.head) ||
        world.knows(contrary(instance.head, theory_.description_)) || find(instance.head) >= 0)
    {
      continue;
    }
    const auto body = findAll(instance.body);
    if (body && apply(instance, *body, ReasonKind::kDefault))
    {
      return true;
    }
  }
  return false;
}

void HistoryTheory::InitialClosure::addExcepted()
{
  for (const GroundDefault& instance : excepted_)
  {
    if (!theory_.fluentIndex(instance.head.atom) ||
        !std::all_of(instance.body.begin(), instance.body.end(), [&](const Literal& literal) {
          return theory_.fluentIndex(literal.atom).has_value();
        }))
    {
      continue;
    }
    if (const auto body = findAll(instance.body))
    {
      apply(instance, *body, ReasonKind::kSupposed);
      close();
    }
  }
}

std::vector<int> HistoryTheory::closure(const Evidence& evidence,
                                        const std::vector<GroundDefault>& excepted)
{
  return InitialClosure(*this, evidence, excepted).conclusions();
}

int HistoryTheory::prove(const Literal& literal, int step, const Evidence& evidence, int max_cases)
{
  if (!fluentIndex(literal.atom))
  {
    return -1;
  }
  constexpr int kFewCases = 8;
  propagation_.returnTo(base_);
  assumeRecords(evidence);
  const int observed = propagation_.prove(at(literal, step), std::min(kFewCases, max_cases));
  if (observed >= 0)
  {
    return observed;
  }
  for (const int conclusion : closure(evidence, {}))
  {
    propagation_.assume(conclusion);
  }
  return propagation_.prove(at(literal, step), max_cases);
}

int HistoryTheory::refute(const Evidence& evidence, const std::vector<GroundDefault>& excepted,
                          int max_cases)
{
  propagation_.returnTo(base_);
  assumeRecords(evidence);
  for (const int conclusion : closure(evidence, excepted))
  {
    propagation_.assume(conclusion);
  }
  return propagation_.refute(max_cases);
}

}  // namespace kr3::reasoner
