#include "kr3_executive/initial_belief.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;
using refinement::Distribution;

/// What a history entails about fluents.
struct Entailed
{
  std::map<std::string, std::string> values;
  std::map<std::string, std::set<std::string>> excluded;
};

Entailed entailedBy(HighLevelReasoner& reasoner, int step)
{
  Entailed result;
  for (const auto& text : reasoner.entailedAt(step))
  {
    const LiteralText literal = takeApart(text);
    if (literal.equal)
      result.values[literal.fluent()] = literal.value;
    else
      result.excluded[literal.fluent()].insert(literal.value);
  }
  return result;
}

std::string literalOf(const std::string& fluent, const std::string& value)
{
  return value == "true" ? fluent : (value == "false" ? "-" + fluent : fluent + " = " + value);
}

/// The confidence of the latest record that says so; 1 when none does.
double confidenceIn(const std::string& fluent, const std::string& value,
                    const std::vector<Record>& history)
{
  double confidence = 1.0;
  for (const auto& record : history)
  {
    if (record.kind != RecordKind::kObserved && record.kind != RecordKind::kInitially)
      continue;
    const LiteralText literal = takeApart(record.statement);
    if (literal.fluent() != fluent)
      continue;
    const bool says =
        literal.isBoolean()
            ? (literal.value == "true") == record.value ? value == "true" : value == "false"
            : record.value && literal.value == value;
    confidence = says ? record.confidence : confidence;
  }
  return confidence;
}

class Spreader
{
public:
  Spreader(HighLevelReasoner& reasoner, const refinement::DomainTask& task,
           const std::vector<Record>& history)
    : reasoner_(reasoner)
    , task_(task)
    , history_(history)
    , step_(currentStep(history))
    , entailed_(entailedBy(reasoner, step_))
  {
  }

  /// The distribution of a fluent; empty for a boolean one that is false.
  Distribution of(const std::string& fluent, std::optional<double> default_probability)
  {
    const auto known = entailed_.values.find(fluent);
    const std::vector<std::string> values = valuesOf(fluent);
    Distribution result;
    if (known == entailed_.values.end())
    {
      if (!values.empty())
        spread(result, values, entailed_.excluded[fluent], 1.0);
      return result;
    }
    double rest = 1.0;
    if (default_probability && isByDefault(fluent, known->second))
      rest = followDefaults(fluent, known->second, *default_probability, result);
    else
    {
      const double confidence = confidenceIn(fluent, known->second, history_);
      result[known->second] = confidence;
      rest -= confidence;
    }
    if (rest > 0.0)
    {
      std::vector<std::string> others = values;
      if (others.empty())
        others = {"false", "true"};
      std::set<std::string> excluded = entailed_.excluded[fluent];
      if (entailed_.values.count(fluent) != 0)
        excluded.clear();  // every other value is excluded only because one is entailed
      for (const auto& entry : result)
        excluded.insert(entry.first);
      spread(result, others, excluded, rest);
    }
    double total = 0.0;
    for (const auto& entry : result)
      total += entry.second;
    for (auto& entry : result)
      entry.second /= total;
    return result;
  }

private:
  /// The values of a valued fluent on the high level; none for a boolean one.
  [[nodiscard]] std::vector<std::string> valuesOf(const std::string& fluent) const
  {
    return highLevelValues(task_.domain(), fluent);
  }

  static void spread(Distribution& result, const std::vector<std::string>& values,
                     const std::set<std::string>& excluded, double mass)
  {
    std::vector<std::string> left;
    std::copy_if(values.begin(), values.end(), std::back_inserter(left),
                 [&](const std::string& value) { return excluded.count(value) == 0; });
    for (const auto& value : left)
      result[value] += mass / static_cast<double>(left.size());
  }

  [[nodiscard]] bool isByDefault(const std::string& fluent, const std::string& value)
  {
    return reasoner_.restsOnDefault(literalOf(fluent, value), step_);
  }

  /// @return what is left of the mass
  double followDefaults(const std::string& fluent, std::string value, double probability,
                        Distribution& result)
  {
    double rest = 1.0;
    std::vector<Record> supposed = history_;
    try
    {
      while (result.count(value) == 0)
      {
        result[value] = rest * probability;
        rest -= result[value];
        const bool boolean = value == "true" || value == "false";
        Record contrary{RecordKind::kInitially,
                        boolean ? fluent : fluent + " = " + value,
                        value == "false",
                        0,
                        1.0,
                        "supposed"};
        supposed.push_back(std::move(contrary));
        reasoner_.setHistory(supposed);
        const Entailed next = entailedBy(reasoner_, step_);
        const auto found = next.values.find(fluent);
        if (found == next.values.end() || !isByDefault(fluent, found->second))
          break;
        value = found->second;
      }
    }
    catch (const FailedPrecondition&)  // the history leaves no other value
    {
      rest = 0.0;
    }
    reasoner_.setHistory(history_);
    return rest;
  }

  HighLevelReasoner& reasoner_;
  const refinement::DomainTask& task_;
  const std::vector<Record>& history_;
  int step_;
  Entailed entailed_;
};

}  // namespace

std::set<std::string> constantsFor(const refinement::LowLevelDomain& domain,
                                   const std::string& goal, const std::vector<Record>& history)
{
  reasoner::Description description = domain.highLevel();
  description.defaults.clear();
  description.preferences.clear();
  reasoner::Reasoner reasoner(std::move(description));
  reasoner.setHistory(history);
  std::set<std::string> constants;
  const auto keep = [&](const std::string& constant) {
    constants.insert(constant);
    for (const auto& component : domain.components(constant))
      constants.insert(component);
  };
  for (const auto& item : reasoner.relevant(goal).constants)
    keep(item.name);
  for (const auto& sort : domain.highLevel().sorts)
  {
    for (const auto& element : sort.elements)
    {
      if (domain.isMagnified(element))
        keep(element);
    }
  }
  return constants;
}

refinement::InitialKnowledge knowledgeOf(HighLevelReasoner& reasoner,
                                         const refinement::DomainTask& task,
                                         const std::vector<Record>& history,
                                         const LowLevelMemory& memory,
                                         std::optional<double> default_probability)
{
  refinement::InitialKnowledge knowledge;
  for (const auto& fluent : task.space().fluents())
  {
    if (const auto known = memory.find(fluent.name);
        known != memory.end() && known->second.values.count(refinement::kElsewhere) == 0)
      knowledge.fine[fluent.name] = known->second.values;
  }
  Spreader spreader(reasoner, task, history);
  for (const auto& entry : task.coarseFluents())
  {
    Distribution values = spreader.of(entry.first, default_probability);
    if (!values.empty())
      knowledge.coarse[entry.first] = std::move(values);
  }
  return knowledge;
}

}  // namespace kr3::executive
