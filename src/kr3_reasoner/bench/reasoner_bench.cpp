// One question of the reasoner's benchmark, as a process of its own; bench_reasoner.py starts it
// and measures its CPU time. The answer and, for repeated questions, the median CPU time go to
// stdout as JSON.

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <clingo.hh>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"
#include "mission_bench.hpp"

namespace
{

using kr3::reasoner::PlanOptions;
using kr3::reasoner::PlanResult;
using kr3::reasoner::Reasoner;
using kr3::reasoner::Record;
using nlohmann::json;

struct Arguments
{
  std::string domain;
  std::string history;
  std::string goal;
  std::string literal;
  std::string record;
  int repetitions = 20;
  int steps = 1000;
  int window = 0;
  bool all_knowledge = false;
  double extra_share = 0.0;
};

std::string contentsOf(const std::string& path)
{
  std::ifstream stream(path);
  if (!stream)
  {
    throw kr3::NotFound("cannot read '" + path + "'");
  }
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

Reasoner reasonerFor(const Arguments& arguments)
{
  Reasoner reasoner(kr3::reasoner::readDescription(arguments.domain));
  reasoner.setHistory(kr3::reasoner::parseHistory(contentsOf(arguments.history), arguments.history,
                                                  reasoner.description()));
  return reasoner;
}

PlanResult planned(const Reasoner& reasoner, const Arguments& arguments)
{
  PlanOptions options;
  options.time_limit = std::chrono::minutes(10);
  options.relevant_only = !arguments.all_knowledge;
  options.extra_share = arguments.extra_share;
  return reasoner.plan(arguments.goal, options);
}

json answerOf(const PlanResult& result)
{
  return {{"plans", result.plans.size()},
          {"steps", result.plans.empty() ? 0 : result.plans.front().steps.size()},
          {"constants", result.considered.constants}};
}

json plan(const Arguments& arguments)
{
  return answerOf(planned(reasonerFor(arguments), arguments));
}

/// One more record to a new plan, again and again in one process. The record is taken back each
/// time, which is not counted.
json replan(const Arguments& arguments)
{
  Reasoner reasoner = reasonerFor(arguments);
  const std::vector<Record> history = reasoner.history();
  const std::vector<Record> more =
      kr3::reasoner::parseHistory(arguments.record, "record", reasoner.description());
  PlanResult result = planned(reasoner, arguments);
  std::vector<double> seconds;
  for (int i = 0; i < arguments.repetitions; ++i)
  {
    reasoner.setHistory(history);
    const std::clock_t start = std::clock();
    reasoner.addRecords(more);
    result = planned(reasoner, arguments);
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::sort(seconds.begin(), seconds.end());
  json answer = answerOf(result);
  answer["cpu_s"] = seconds[seconds.size() / 2];
  return answer;
}

json entails(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const int step = reasoner.currentStep();
  return {{"answer", static_cast<int>(reasoner.entails(arguments.literal, step))}, {"step", step}};
}

json diagnose(const Arguments& arguments)
{
  const auto diagnosis = reasonerFor(arguments).diagnose();
  return {{"cost", diagnosis.cost}, {"explanations", diagnosis.explanations.size()}};
}

json mission(const Arguments& arguments)
{
  return kr3::reasoner::bench::mission(arguments.domain, arguments.history, arguments.steps,
                                       arguments.window);
}

/// Grounds and solves an answer set program at one go.
json ground(const Arguments& arguments)
{
  Clingo::Control control{{"--opt-strategy=usc", "--warn=none"}};
  control.add("base", {}, contentsOf(arguments.domain).c_str());
  control.ground({{"base", {}}});
  json cost;
  for (const Clingo::Model& model : control.solve())
  {
    cost = model.cost();
  }
  return {{"cost", cost}};
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app("One question of the reasoner's benchmark.");
  app.require_subcommand(1);
  Arguments arguments;
  json (*question)(const Arguments&) = nullptr;
  const auto add = [&](const char* name, const char* help, json (*answer)(const Arguments&)) {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("domain", arguments.domain, "the description")->required();
    command->callback([&question, answer] { question = answer; });
    return command;
  };
  const auto withHistory = [&](CLI::App* command) {
    command->add_option("history", arguments.history, "the history")->required();
    return command;
  };
  const auto withGoal = [&](CLI::App* command) {
    command->add_option("goal", arguments.goal, "the goal")->required();
    command->add_flag("--all-knowledge", arguments.all_knowledge, "not only what is relevant");
    command->add_option("--extra-share", arguments.extra_share,
                        "of what is not relevant, in [0, 1]");
    return command;
  };
  withGoal(withHistory(add("plan", "plan once", plan)));
  CLI::App* again = withGoal(withHistory(add("replan", "plan anew after one more record", replan)));
  again->add_option("record", arguments.record, "the record")->required();
  again->add_option("--repetitions", arguments.repetitions, "how often");
  withHistory(add("entails", "ask for a literal at the current step", entails))
      ->add_option("literal", arguments.literal, "the literal")
      ->required();
  withHistory(add("diagnose", "explain the history", diagnose));
  CLI::App* walk = withHistory(add("mission", "ask at each step of a long mission", mission));
  walk->add_option("--steps", arguments.steps, "how many")->check(CLI::PositiveNumber);
  walk->add_option("--window", arguments.window, "steps that are kept; 0: all")
      ->check(CLI::NonNegativeNumber);
  add("ground", "solve an answer set program", ground);
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::cout << question(arguments).dump() << "\n";
  }
  catch (const std::exception& e)
  {
    std::cerr << e.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
