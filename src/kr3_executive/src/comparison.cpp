#include "kr3_executive/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <random>
#include <set>
#include <sstream>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

constexpr double kNormal95 = 1.959963984540054;

void valuedFluents(const reasoner::Formula& formula, std::set<std::string>& fluents)
{
  for (const auto& operand : formula.operands)
    valuedFluents(operand, fluents);
  if (formula.kind == reasoner::Formula::Kind::kLiteral && formula.literal.value.name != "true" &&
      formula.literal.value.name != "false")
    fluents.insert(reasoner::toString(formula.literal.atom));
}

std::string shown(const Estimate& estimate, int digits)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << estimate.value << " (" << estimate.low << ", "
       << estimate.high << ")";
  return text.str();
}

template <typename Get>
std::vector<double> column(const MethodTrials& trials, Get get)
{
  std::vector<double> values;
  std::transform(trials.results.begin(), trials.results.end(), std::back_inserter(values), get);
  return values;
}

bool succeeded(const TrialResult& result)
{
  return result.mission.achieved && result.goal_is_true;
}

}  // namespace

Estimate shareOf(std::uint64_t successes, std::uint64_t trials)
{
  if (trials == 0)
    throw InvalidArgument("a share of no trials");
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double z2 = kNormal95 * kNormal95;
  const double centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half =
      kNormal95 * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n)) / (1.0 + z2 / n);
  return {share, std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

Estimate meanOf(const std::vector<double>& values)
{
  if (values.empty())
    throw InvalidArgument("a mean of no values");
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values)
    mean += value / n;
  double squares = 0.0;
  for (const double value : values)
    squares += (value - mean) * (value - mean);
  const double half = n > 1.0 ? kNormal95 * std::sqrt(squares / (n - 1.0) / n) : 0.0;
  return {mean, mean - half, mean + half};
}

std::uint64_t drawnApart(std::uint64_t seed)
{
  return seed ^ 0x9e3779b97f4a7c15ULL;
}

std::vector<std::string> drawnTruths(const AbstractMissions& missions, const std::string& goal,
                                     std::uint64_t seed)
{
  const auto& high_level = missions.domain().highLevel();
  std::set<std::string> fluents;
  valuedFluents(reasoner::parseGoal(goal, high_level), fluents);
  for (const auto& record : missions.scenario().initial_records)
  {
    if (record.value && record.step == 0)
      fluents.erase(takeApart(record.statement).fluent());
  }
  std::mt19937_64 random(drawnApart(seed));
  std::vector<std::string> truths;
  for (const auto& fluent : fluents)
  {
    const auto* declared = high_level.findFluent(takeApart(fluent).symbol);
    const auto& values = high_level.findSort(*declared->value_sort)->elements;
    truths.push_back(
        fluent + " = " +
        values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random)]);
  }
  return truths;
}

void printComparison(std::ostream& out, const std::vector<MethodTrials>& methods)
{
  if (methods.empty())
    throw InvalidArgument("no methods to compare");
  const std::size_t trials = methods.front().results.size();
  const auto seconds = [](const TrialResult& result) { return result.mission.duration_s; };
  const std::vector<double> reference = column(methods.front(), seconds);
  const auto print = [&out](const std::string& method, const std::string& success,
                            const std::string& wrong, const std::string& actions,
                            const std::string& duration, const std::string& difference,
                            const std::string& wall) {
    out << std::left << std::setw(14) << method << std::setw(22) << success << std::setw(8) << wrong
        << std::setw(24) << actions << std::setw(26) << duration << std::setw(26) << difference
        << wall << "\n";
  };
  out << trials << " trials each, the same worlds and seeds; 95 % intervals\n";
  print("method", "success", "false", "low-level actions", "simulated s",
        "s more than " + std::string(toString(methods.front().method)), "wall s a trial");
  for (const MethodTrials& method : methods)
  {
    if (method.results.size() != trials)
      throw InvalidArgument("methods with different numbers of trials");
    const auto good = static_cast<std::uint64_t>(
        std::count_if(method.results.begin(), method.results.end(), succeeded));
    const auto wrong = std::count_if(
        method.results.begin(), method.results.end(),
        [](const TrialResult& result) { return result.mission.achieved && !result.goal_is_true; });
    std::vector<double> difference = column(method, seconds);
    for (std::size_t i = 0; i < trials; ++i)
      difference[i] -= reference[i];
    std::ostringstream wall;
    wall << std::fixed << std::setprecision(3) << method.wall_s / static_cast<double>(trials);
    print(toString(method.method), shown(shareOf(good, trials), 3), std::to_string(wrong),
          shown(meanOf(column(
                    method,
                    [](const TrialResult& result) {
      return static_cast<double>(result.mission.ll_actions);
                    })),
                1),
          shown(meanOf(column(method, seconds)), 1), shown(meanOf(difference), 1), wall.str());
  }
}

}  // namespace kr3::executive
