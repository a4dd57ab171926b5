#include "kr3_executive/low_level_memory.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using refinement::Distribution;
using refinement::kElsewhere;

constexpr double kCertain = 0.999;

double sumOf(const Distribution& values)
{
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [](double sum, const auto& entry) { return sum + entry.second; });
}

bool isBoolean(const std::string& value)
{
  return value == "true" || value == "false";
}

}  // namespace

std::string coarseFluent(const refinement::LowLevelDomain& domain, const std::string& fluent)
{
  LiteralText parts = takeApart(fluent);
  for (auto& argument : parts.arguments)
    argument = domain.coarse(argument);
  return parts.fluent();
}

refinement::InitialKnowledge initialKnowledge(const refinement::LowLevelDomain& domain,
                                              const refinement::Zoom& zoom,
                                              const LowLevelMemory& memory,
                                              const SupportOf& support)
{
  refinement::InitialKnowledge knowledge;
  std::map<std::string, std::string> start;  // high-level values by fluent
  for (const auto& literal : zoom.start)
  {
    if (literal.equal)
      start[reasoner::toString(literal.atom)] = literal.value.name;
  }
  std::set<std::string> settled;
  for (const auto& [fluent, remembered] : memory)
  {
    if (domain.highLevel().findFluent(takeApart(fluent).symbol) == nullptr)
    {
      knowledge.fine[fluent] = remembered.values;  // the high level says nothing about it
      continue;
    }
    const std::string whole = coarseFluent(domain, fluent);
    const auto held = start.find(whole);
    if (held == start.end() || held->second == "false")
      continue;
    const double inside = massOf(domain, remembered.values, held->second);
    const bool of_a_part = whole != fluent;  // a part may differ from its whole
    if (inside > 0.5 || of_a_part || (remembered.assumed == held->second && inside > 0.0))
    {
      knowledge.fine[fluent] = remembered.values;
      settled.insert(whole);
    }
  }
  for (const auto& [fluent, value] : start)
  {
    if (settled.count(fluent) != 0)
      continue;
    const bool boolean = isBoolean(value);
    const std::string literal =
        boolean ? (value == "true" ? fluent : "-" + fluent) : fluent + " = " + value;
    const double probability = support(literal).probability;
    if (probability >= kCertain)
      continue;
    knowledge.coarse[fluent] = {{value, probability}};
    if (boolean)
      knowledge.coarse[fluent][value == "true" ? "false" : "true"] = 1.0 - probability;
  }
  return knowledge;
}

SightingLikelihood::SightingLikelihood(const refinement::LowLevelDomain& domain,
                                       const Sighting& sighting)
{
  const auto literal = reasoner::parseGroundLiteral(sighting.literal, domain.description());
  const auto* declared = domain.description().findFluent(literal.atom.name);
  if (declared == nullptr || declared->kind != reasoner::FluentKind::kInertial)
  {
    throw InvalidArgument("sighting '" + sighting.literal +
                          "', expected a literal of an inertial fluent");
  }
  if (!(sighting.confidence > 0.0 && sighting.confidence <= 1.0))
  {
    throw InvalidArgument("sighting '" + sighting.literal + "' with confidence " +
                          std::to_string(sighting.confidence) + ", expected (0, 1]");
  }
  fluent_ = reasoner::toString(literal.atom);
  seen_ = literal.value.name;
  values_ = declared->value_sort ? domain.description().findSort(*declared->value_sort)->elements
                                 : std::vector<std::string>{"true", "false"};
  // A belief of 1 could never be revised.
  const double confidence = std::min(sighting.confidence, kCertain);
  const auto others = static_cast<double>(std::max<std::size_t>(values_.size(), 2) - 1);
  seen_likelihood_ = literal.equal ? confidence : 1.0 - confidence;
  other_likelihood_ = literal.equal ? (1.0 - confidence) / others : confidence;
}

double SightingLikelihood::of(const std::string& value) const
{
  return value == seen_ ? seen_likelihood_ : other_likelihood_;
}

double SightingLikelihood::ofOthers(const std::vector<std::string>& listed) const
{
  double total = 0.0;
  std::size_t count = 0;
  for (const auto& value : values_)
  {
    if (std::find(listed.begin(), listed.end(), value) != listed.end())
      continue;
    total += of(value);
    ++count;
  }
  return count == 0 ? other_likelihood_ : total / static_cast<double>(count);
}

Distribution SightingLikelihood::applied(const Distribution& prior) const
{
  Distribution posterior = prior;
  const auto elsewhere = posterior.find(kElsewhere);
  if (posterior.count(seen_) == 0 && elsewhere != posterior.end())
  {
    std::size_t unlisted = 0;
    for (const auto& value : values_)
      unlisted += posterior.count(value) == 0 ? 1 : 0;
    const double share =
        elsewhere->second / static_cast<double>(std::max<std::size_t>(unlisted, 1));
    elsewhere->second -= share;
    posterior[seen_] = share;
  }
  double sum = 0.0;
  for (auto& [value, probability] : posterior)
  {
    probability *= value == kElsewhere ? other_likelihood_ : of(value);
    sum += probability;
  }
  if (!(sum > 0.0))  // all mass was on values that it excludes: what was seen last counts
    return {{seen_, seen_likelihood_}, {kElsewhere, 1.0 - seen_likelihood_}};
  for (auto& entry : posterior)
    entry.second /= sum;
  return posterior;
}

Distribution unknownValue()
{
  return {{kElsewhere, 1.0}};
}

std::vector<std::string> highLevelValues(const refinement::LowLevelDomain& domain,
                                         const std::string& fluent)
{
  const auto* declared = domain.highLevel().findFluent(takeApart(fluent).symbol);
  return declared == nullptr || !declared->value_sort
             ? std::vector<std::string>{}
             : domain.highLevel().findSort(*declared->value_sort)->elements;
}

double massOf(const refinement::LowLevelDomain& domain, const Distribution& values,
              const std::string& value)
{
  double sum = 0.0;
  for (const auto& component : domain.components(value))
  {
    const auto entry = values.find(component);
    sum += entry == values.end() ? 0.0 : entry->second;
  }
  return sum;
}

std::size_t numUnlisted(const refinement::LowLevelDomain& domain, const std::string& fluent,
                        const Distribution& values)
{
  const std::vector<std::string> whole = highLevelValues(domain, fluent);
  return static_cast<std::size_t>(std::count_if(whole.begin(), whole.end(), [&](const auto& value) {
    const auto components = domain.components(value);
    return std::none_of(components.begin(), components.end(),
                        [&values](const auto& part) { return values.count(part) != 0; });
  }));
}

Distribution weighed(const refinement::LowLevelDomain& domain, const RememberedFluent& remembered)
{
  Distribution values = remembered.values;
  for (auto& [value, probability] : values)
  {
    if (value != kElsewhere && domain.coarse(value) == remembered.assumed)
      probability *= remembered.odds;
  }
  return values;
}

std::vector<double> probabilitiesOf(const refinement::LowLevelDomain& domain,
                                    const LowLevelMemory& memory, const std::string& fluent,
                                    const std::vector<std::string>& values)
{
  std::vector<double> result(values.size(), 1.0 / static_cast<double>(values.size()));
  const auto found = memory.find(fluent);
  if (found == memory.end())
    return result;
  const Distribution known = weighed(domain, found->second);
  const auto massOf = [&known](const std::string& value) {
    const auto entry = known.find(value);
    return entry == known.end() ? 0.0 : entry->second;
  };
  std::vector<bool> listed(values.size(), false);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    result[i] = 0.0;
    for (const auto& component : domain.components(values[i]))
    {
      listed[i] = listed[i] || known.count(component) != 0;
      result[i] += massOf(component);
    }
  }
  // `elsewhere` is of all that are not listed, asked for or not.
  const std::size_t unlisted = std::max<std::size_t>(numUnlisted(domain, fluent, known), 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (!listed[i])
      result[i] = massOf(kElsewhere) / static_cast<double>(unlisted);
    sum += result[i];
  }
  for (auto& probability : result)
    probability = sum > 0.0 ? probability / sum : 1.0 / static_cast<double>(values.size());
  return result;
}

void forget(const refinement::LowLevelDomain& domain, LowLevelMemory& memory,
            const std::string& fluent, const std::string& value)
{
  const auto found = memory.find(fluent);
  if (found == memory.end())
    return;
  Distribution& values = found->second.values;
  for (const auto& component : domain.components(value))
    values.erase(component);
  // It is as likely now as the others are in the mean.
  const std::size_t whole = highLevelValues(domain, fluent).size();
  const auto elsewhere = values.find(kElsewhere);
  if (elsewhere != values.end() && whole > 0)
  {
    elsewhere->second += sumOf(weighed(domain, found->second)) /
                         static_cast<double>(std::max<std::size_t>(whole - 1, 1));
  }
  const double kept = sumOf(values);
  if (!(kept > 0.0))
  {
    memory.erase(found);
    return;
  }
  for (auto& entry : values)
    entry.second /= kept;
  if (found->second.assumed == value)
  {
    found->second.assumed.clear();
    found->second.odds = 1.0;
  }
}

}  // namespace kr3::executive
