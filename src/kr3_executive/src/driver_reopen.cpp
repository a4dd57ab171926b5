// The part of MissionDriver that weighs refutations, and takes one back when nothing else is left.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/driver.hpp"
#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;
using reasoner::Retraction;

constexpr double kMostCertain = 0.999;
constexpr int kMostTimesGivenUp = 2;  // what is looked for is looked for three times

/// obs(f = v, false, k) of a valued fluent: what a search in vain leaves behind.
bool isRefutation(const Record& record)
{
  if (record.kind != RecordKind::kObserved || record.value)
    return false;
  const LiteralText literal = takeApart(record.statement);
  return literal.equal && !literal.isBoolean();
}

/// What a record says, whenever it says so.
std::string saying(const std::string& statement, bool value)
{
  return statement + (value ? " is true" : " is false");
}

double logOdds(double probability)
{
  return std::log(probability / (1.0 - probability));
}

}  // namespace

MissionDriver::Refutations MissionDriver::openRefutations(const std::string& fluent) const
{
  Refutations open;
  const auto& history = knowledge_.history;
  for (std::size_t i = 0; i < history.size(); ++i)
  {
    const LiteralText literal = takeApart(history[i].statement);
    if (isRefutation(history[i]) && literal.fluent() == fluent)
      open[literal.value].push_back(i);
    const bool told = (history[i].kind == RecordKind::kObserved) && history[i].value &&
                      literal.equal && literal.fluent() == fluent;
    const bool acted = !open.empty() && history[i].kind == RecordKind::kHappened;
    if (told || (acted && settledBy(history[i], fluent)))
      open.clear();
  }
  return open;
}

bool MissionDriver::settledBy(const Record& happened, const std::string& fluent) const
{
  // An action that does not name what the fluent is about hardly depends on it.
  const std::vector<std::string> about = takeApart(fluent).arguments;
  const std::vector<std::string> arguments = takeApart(happened.statement).arguments;
  const bool concerned = std::any_of(about.begin(), about.end(), [&](const auto& name) {
    return std::find(arguments.begin(), arguments.end(), name) != arguments.end();
  });
  const auto* declared = domain_.highLevel().findFluent(takeApart(fluent).symbol);
  if (!concerned || declared == nullptr || !declared->value_sort)
    return false;
  FluentValues before;
  try
  {
    for (const auto& text : reasoner_.entailedAt(happened.step))
    {
      const LiteralText literal = takeApart(text);
      if (literal.equal)
        before[literal.fluent()] = literal.value;
    }
  }
  catch (const Error&)  // an inconsistent history, or a step that is progressed over
  {
    return false;
  }
  const auto action = reasoner::parseGroundAction(happened.statement, domain_.highLevel());
  const auto& values = domain_.highLevel().findSort(*declared->value_sort)->elements;
  const auto possible = std::count_if(values.begin(), values.end(), [&](const auto& value) {
    before[fluent] = value;
    return high_level_laws_.executable(before, action);
  });
  return possible == 1;
}

double MissionDriver::logOddsOf(const std::vector<std::size_t>& records) const
{
  double sum = 0.0;
  for (const std::size_t index : records)
    sum += std::max(logOdds(std::min(knowledge_.history[index].confidence, kMostCertain)), 0.0);
  return sum;
}

void MissionDriver::markRefuted(std::vector<CostedPlan>& plans)
{
  std::map<std::string, Refutations> open;  // by fluent
  for (const auto& record : knowledge_.history)
  {
    if (!isRefutation(record))
      continue;
    const std::string fluent = takeApart(record.statement).fluent();
    if (open.count(fluent) == 0)
      open[fluent] = openRefutations(fluent);
  }
  if (open.empty())
    return;
  for (auto& plan : plans)
  {
    for (const auto& literal : believedState(plan.plan.hypothesis))
    {
      const std::string fluent = reasoner::toString(literal.atom);
      const auto refutations = open.find(fluent);
      if (refutations == open.end())
        continue;
      const auto here = refutations->second.find(literal.value.name);
      // What is certain needs no taking back: the change is.
      const bool doubtful =
          here != refutations->second.end() &&
          std::all_of(here->second.begin(), here->second.end(), [&](std::size_t index) {
            return knowledge_.history[index].confidence < 1.0;
          });
      plan.refuted =
          plan.refuted || (doubtful && stepThatChecks(plan.plan, fluent) < plan.plan.steps.size());
    }
  }
}

std::vector<Retraction> MissionDriver::retractable()
{
  // Records that contradict each other come before what was only looked for in vain.
  std::vector<Retraction> found = reasoner_.retractions({}, state_.step);
  if (!found.empty())
  {
    const auto again = [&](const Retraction& retraction) {
      return std::all_of(retraction.records.begin(), retraction.records.end(), [&](auto index) {
        const Record& record = knowledge_.history.at(index);
        return given_up_.count(saying(record.statement, record.value)) > 0;
      });
    };
    found.erase(std::remove_if(found.begin(), found.end(), again), found.end());
    return found;
  }
  std::set<std::string> fluents;
  for (const auto& record : knowledge_.history)
  {
    if (isRefutation(record))
      fluents.insert(takeApart(record.statement).fluent());
  }
  for (const auto& fluent : fluents)
  {
    for (const auto& [value, records] : openRefutations(fluent))
    {
      const auto before = given_up_.find(saying(fluent + " = " + value, false));
      if (before != given_up_.end() && before->second.times >= kMostTimesGivenUp)
        continue;  // it was looked at again and again, in vain
      const double given_up = before == given_up_.end() ? 0.0 : before->second.log_odds;
      std::string literal = fluent + " = " + value;
      auto more = reasoner_.retractions(literal, state_.step);
      // That it was looked for in vain before was true all the same.
      for (auto& retraction : more)
        retraction.log_odds += given_up;
      found.insert(found.end(), more.begin(), more.end());
      const bool doubtful = std::all_of(records.begin(), records.end(), [&](std::size_t index) {
        return knowledge_.history[index].confidence < 1.0;
      });
      // It is possible, by a change that nobody saw.
      if (more.empty() && doubtful)
        found.push_back({records, logOddsOf(records) + given_up, std::move(literal), {}});
    }
  }
  return found;
}

double MissionDriver::surpriseWithout(const std::vector<std::size_t>& records)
{
  std::vector<Record> rest;
  for (std::size_t i = 0; i < knowledge_.history.size(); ++i)
  {
    if (std::find(records.begin(), records.end(), i) == records.end())
      rest.push_back(knowledge_.history[i]);
  }
  reasoner_.suppose(rest);
  const reasoner::Diagnosis diagnosis = reasoner_.minimalExplanations();
  if (!diagnosis.consistent)
    return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const auto& text :
       diagnosis.explanations.empty() ? std::vector<std::string>{} : diagnosis.explanations.front())
  {
    const std::string symbol = text.substr(0, text.find('('));
    const auto* action = domain_.highLevel().findAction(symbol);
    if (action != nullptr && action->exogenous)
      sum += logOdds(1.0 - config_.change_probability);
    else if (symbol == "init")
      sum += logOdds(config_.default_probability);
  }
  return sum;
}

std::string MissionDriver::sayingOf(const Retraction& retraction) const
{
  std::string all;
  for (const std::size_t index : retraction.records)
  {
    const Record& record = knowledge_.history.at(index);
    all += saying(record.statement, record.value) + "; ";
  }
  return all;
}

std::vector<std::size_t> MissionDriver::recordsToGiveUp()
{
  std::vector<Retraction> found = retractable();
  const auto leastCertainFirst = [](const auto& a, const auto& b) {
    return a.log_odds < b.log_odds;
  };
  std::stable_sort(found.begin(), found.end(), leastCertainFirst);
  constexpr std::size_t kMostCompared = 12;
  if (found.size() > kMostCompared)
    found.resize(kMostCompared);
  if (found.size() <= 1)
    return found.empty() ? std::vector<std::size_t>{} : found.front().records;
  // The belief behind a record is about one value. To compare values, what is to be assumed if the
  // record is wrong counts too. It takes long to find out, and grows as more is observed: only of
  // what may be the least one it has to be known what it is now.
  std::set<std::string> known_now;
  for (;;)
  {
    const Retraction* best = nullptr;
    std::string said;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& retraction : found)
    {
      std::string saying = sayingOf(retraction);
      const auto before = surprises_without_.find(saying);
      const double sum =
          retraction.log_odds + (before == surprises_without_.end() ? 0.0 : before->second);
      if (best != nullptr && sum >= least)
        continue;
      best = &retraction;
      least = sum;
      said = std::move(saying);
    }
    if (!known_now.insert(said).second)
      return best->records;
    surprises_without_[said] = surpriseWithout(best->records);
  }
}

Event MissionDriver::performReopen()
{
  std::vector<std::size_t> indices = recordsToGiveUp();
  if (indices.empty())
    return RefutationReopened{false};
  auto& history = knowledge_.history;
  std::sort(indices.rbegin(), indices.rend());
  std::vector<Record> given_up;
  std::set<std::string> counted;
  for (const std::size_t index : indices)
  {
    const std::string said = saying(history.at(index).statement, history[index].value);
    GivenUp& so_far = given_up_[said];
    so_far.times += counted.insert(said).second ? 1 : 0;
    so_far.log_odds += logOddsOf({index});
    given_up.push_back(history[index]);
    history.erase(history.begin() + static_cast<std::ptrdiff_t>(index));
  }
  forgetAnswers();
  reasoner_.setHistory(history);
  for (const auto& record : given_up)
  {
    const LiteralText literal = takeApart(record.statement);
    forget(domain_, knowledge_.memory, literal.fluent(), literal.value);
    report(EventKind::kRecord, [&] {
      Narration narration = narrator_.record(record, false);
      narration.text = "taken back as the least certain record: " + narration.text;
      return narration;
    });
  }
  if (!interest_.narration)
    return RefutationReopened{true};
  const reasoner::Diagnosis diagnosis = reasoner_.minimalExplanations();
  exceptions_ = diagnosis.consistent && !diagnosis.explanations.empty()
                    ? diagnosis.explanations.front()
                    : std::vector<std::string>{};
  return RefutationReopened{true};
}

}  // namespace kr3::executive
