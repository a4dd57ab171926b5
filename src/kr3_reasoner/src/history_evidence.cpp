#include <algorithm>
#include <functional>
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

/// The founded closure of what is known initially, from the evidence only, as inferences.
std::vector<int> HistoryTheory::closure(const Evidence& evidence,
                                        const std::vector<GroundDefault>& excepted)
{
  using Key = std::pair<int, std::pair<int, bool>>;
  std::map<Key, int> known;
  std::vector<int> conclusions;
  const auto keyOf = [&](const FiniteLiteral& literal) {
    return Key{literal.variable, {literal.value, literal.equal}};
  };
  const auto canonical = [&](FiniteLiteral literal) {
    if (values_[*meaning(literal.variable).fluent].size() == 2 && !literal.equal)
    {
      literal.value = 1 - literal.value;
      literal.equal = true;
    }
    return literal;
  };
  const std::function<int(const Literal&)> find = [&](const Literal& open) {
    const FiniteLiteral literal = canonical(at(open, 0));
    const auto found = known.find(keyOf(literal));
    if (found != known.end() || literal.equal)
    {
      return found == known.end() ? -1 : found->second;
    }
    const std::size_t fluent = *fluentIndex(open.atom);
    for (std::size_t value = 0; value < values_[fluent].size(); ++value)
    {
      const FiniteLiteral other{literal.variable, static_cast<int>(value), true, 0};
      const auto equal = known.find(keyOf(other));
      if (equal != known.end() && other.value != literal.value)
      {
        return propagation_.addInference({literal, Inference::kImplied, {equal->second}, {0}});
      }
    }
    return -1;
  };
  const auto add = [&](const Literal& open, int origin, std::vector<int> antecedents) {
    if (!fluentIndex(open.atom) || find(open) >= 0)
    {
      return false;
    }
    std::vector<int> used_at(antecedents.size(), 0);
    const FiniteLiteral literal = canonical(at(open, 0));
    conclusions.push_back(
        propagation_.addInference({literal, origin, std::move(antecedents), std::move(used_at)}));
    known[keyOf(literal)] = conclusions.back();
    return true;
  };
  const auto findAll = [&](const std::vector<Literal>& body) {
    std::vector<int> found;
    for (const Literal& literal : body)
    {
      found.push_back(find(literal));
    }
    const bool all = std::find(found.begin(), found.end(), -1) == found.end();
    return all ? std::make_optional(found) : std::nullopt;
  };
  const auto close = [&] {
    for (bool grown = true; grown;)
    {
      grown = false;
      for (const GroundRule& rule : rules_.rules())
      {
        const auto body = rule.head ? findAll(rule.body) : std::nullopt;
        if (body && find(*rule.head) < 0)
        {
          ClauseOrigin origin;
          origin.kind = ReasonKind::kConstraint;
          origin.position = rule.position;
          origin.law = rule.law;
          grown = add(*rule.head, addOrigin(std::move(origin)), *body) || grown;
        }
      }
    }
  };
  const auto applied =
      [&](const GroundDefault& instance, const std::vector<int>& body, ReasonKind kind) {
    ClauseOrigin origin;
    origin.kind = kind;
    origin.position = instance.rule->position;
    origin.default_name = instance.name;
    return add(instance.head, addOrigin(std::move(origin)), body);
  };
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    const bool initial = !records_[i].isAction() && records_[i].record.step == 0;
    const bool right = std::none_of(
        world_.assumed.begin(), world_.assumed.end(),
        [&](const Clingo::Symbol& assumed) { return words_.wrongRecord(assumed) == i; });
    if (initial && right && may(evidence.records, i))
    {
      add(records_[i].literal, originOf(i), {});
    }
  }
  close();
  for (std::size_t i = 0; i < world_.assumed.size(); ++i)
  {
    if (!words_.isException(world_.assumed[i]) || !may(evidence.assumed, i))
    {
      continue;
    }
    const Literal literal = words_.exception(world_.assumed[i]);
    const bool opposed =
        std::any_of(excepted.begin(), excepted.end(), [&](const GroundDefault& instance) {
          return toString(contrary(instance.head, description_)) == toString(literal);
        });
    if (!opposed)
    {
      ClauseOrigin origin;
      origin.kind = ReasonKind::kException;
      origin.assumed = i;
      add(literal, addOrigin(std::move(origin)), {});
      close();
    }
  }
  for (bool grown = true; grown;)
  {
    grown = false;
    for (const GroundDefault& instance : rules_.defaults())
    {
      // what the exception opens does not apply when it is taken back
      const bool opposed =
          std::any_of(excepted.begin(), excepted.end(), [&](const GroundDefault& other) {
            return toString(other.head.atom) == toString(instance.head.atom);
          });
      if (opposed || !may(evidence.defaults, instance.name) || !world_.knows(instance.head) ||
          world_.knows(contrary(instance.head, description_)) || find(instance.head) >= 0)
      {
        continue;
      }
      const auto body = findAll(instance.body);
      if (body && applied(instance, *body, ReasonKind::kDefault))
      {
        close();
        grown = true;
        break;
      }
    }
  }
  for (const GroundDefault& instance : excepted)
  {
    if (!fluentIndex(instance.head.atom) ||
        !std::all_of(instance.body.begin(), instance.body.end(),
                     [&](const Literal& literal) { return fluentIndex(literal.atom); }))
    {
      continue;
    }
    if (const auto body = findAll(instance.body))
    {
      applied(instance, *body, ReasonKind::kSupposed);
      close();
    }
  }
  return conclusions;
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
