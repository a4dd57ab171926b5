/// kr3_replay: computes recorded missions again and compares the decisions. Needs no ROS.

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_executive/recorded_mission.hpp"
#include "kr3_executive/replay.hpp"
#include "tool_options.hpp"

namespace
{

using namespace kr3::executive;

constexpr int kDiffers = 1;

struct Options
{
  std::string file;
  std::size_t mission = 0;
  std::vector<std::string> changes;
  ReplayOptions replay;
  bool check = false;
  bool any_numbers = false;
};

void addOptions(CLI::App& app, Options& options)
{
  app.add_option("FILE", options.file, "inputs, one JSON object a line; - for standard input")
      ->required();
  app.add_option("--mission", options.mission, "number of the mission, from 1; default: all");
  app.add_option("--set", options.changes,
                 "change an input first: NUMBER.FIELD=VALUE, as in 12.observation=false");
  app.add_option("--domain", options.replay.domain,
                 "directory of files to use instead of the recorded ones, which is told");
  app.add_option("--continue", options.replay.continue_with_seed,
                 "go on in the abstract world, with this seed, where nothing is recorded any more");
  app.add_option("--true", options.replay.truths,
                 "literal that is true in that world, such as \"loc(tb1) = kitchen\"");
  app.add_flag("--any-numbers", options.any_numbers,
               "the same choices from other numbers count as the same: costs, bounds and beliefs "
               "may differ in their last digits between machines");
  app.add_flag("--check", options.check, "print the verdict and the first difference only");
}

std::vector<RecordedInput> readFile(const std::string& path)
{
  if (path == "-")
    return readInputs(std::cin, "standard input");
  std::ifstream file(path);
  if (!file)
    throw kr3::Unavailable("cannot read '" + path + "'");
  return readInputs(file, path);
}

std::string inWords(std::string kind)
{
  for (char& c : kind)
    c = c == '_' ? ' ' : c;
  return kind;
}

std::string inWords(const ReportedDecision& decision, bool with_basis)
{
  std::string text = inWords(decision.kind);
  for (std::size_t i = 0; i < decision.details.size(); ++i)
    text += (i == 0 ? ": " : "; ") + decision.details[i];
  if (with_basis)
  {
    for (const auto& number : decision.basis)
      text += " [" + number + "]";
  }
  return text;
}

void print(const ReplayedDecision& decision)
{
  const std::string indent(34, ' ');
  std::cout << std::setw(5) << decision.sequence << "  step " << std::left << std::setw(4)
            << decision.hl_step << std::setw(15) << toString(decision.verdict) << std::right;
  const bool other_basis = decision.verdict == Verdict::kOtherBasis;
  switch (decision.verdict)
  {
    case Verdict::kSame:
    case Verdict::kNew:
      std::cout << inWords(*decision.replayed, false) << "\n";
      break;
    case Verdict::kOtherBasis:
    case Verdict::kDiffers:
      std::cout << (decision.hl_action.empty() ? "" : "during " + decision.hl_action) << "\n"
                << indent << "then  "
                << (decision.recorded ? inWords(*decision.recorded, other_basis) : "nothing")
                << "\n"
                << indent << "now   "
                << (decision.replayed ? inWords(*decision.replayed, other_basis) : "nothing")
                << "\n";
  }
}

/// @return whether all decisions are the same
bool run(const Options& options, const std::vector<RecordedInput>& inputs, std::size_t number)
{
  std::vector<RecordedInput> changed = inputs;
  for (const auto& change : options.changes)
    alter(changed, change);
  const RecordedMission mission = readMission(changed);
  ReplayOptions how = options.replay;
  std::cout << "mission " << number << ": " << mission.start.goal << "\n";
  if (!options.check)
    how.on_decision = print;
  const ReplayResult result = replay(mission, how);
  const ReplayedDecision* difference = result.firstDifference();
  const ReplayedDecision* choice = result.firstOtherChoice();
  if (options.check && difference != nullptr)
    print(*difference);
  if (options.check && choice != nullptr && choice != difference)
    print(*choice);
  if (!result.reason.empty())
    std::cout << result.reason << "\n";
  for (const auto& doubt : result.not_promised)
    std::cout << "not promised to repeat: " << doubt << "\n";
  std::cout << result.decisions.size() << " decisions, ";
  if (difference == nullptr)
    std::cout << "all the same";
  else if (choice == nullptr)
    std::cout << "all the same choices, other numbers from input " << difference->sequence << " on";
  else
    std::cout << "another choice at input " << choice->sequence << ", step " << choice->hl_step;
  std::cout << (mission.isComplete() ? "" : " (the recording does not reach the mission's end)")
            << "\n";
  return options.any_numbers ? choice == nullptr : difference == nullptr;
}

int run(const Options& options)
{
  const auto missions = splitMissions(readFile(options.file));
  if (options.mission > missions.size())
    throw kr3::InvalidArgument("mission " + std::to_string(options.mission) + ": there are " +
                               std::to_string(missions.size()));
  if (!options.changes.empty() && options.mission == 0 && missions.size() > 1)
    throw kr3::InvalidArgument("which of the " + std::to_string(missions.size()) +
                               " missions is to be changed? Give --mission");
  bool same = true;
  for (std::size_t i = 0; i < missions.size(); ++i)
  {
    if (options.mission == 0 || options.mission == i + 1)
      same = run(options, missions[i], i + 1) && same;
  }
  return same ? EXIT_SUCCESS : kDiffers;
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app{
      "Computes recorded missions again and compares each decision. Exit code: 0 all the "
      "same, 1 one differs, 2 the recording cannot be used."};
  Options options;
  addOptions(app, options);
  return runTool(app, "kr3_replay", argc, argv, [&] { return run(options); });
}
