// Questions about a domain description and a history, from the command line. Needs no ROS.

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"

namespace
{

using kr3::reasoner::Answer;
using kr3::reasoner::Description;
using kr3::reasoner::Reasoner;
using nlohmann::json;

struct Arguments
{
  std::string file;
  std::string base;
  std::string history;
  std::string goal;
  std::string literal;
  std::string format = "text";
  int step = -1;
  int max_horizon = 12;
  bool exogenous = false;
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
  kr3::reasoner::ReasonerOptions options;
  options.diagnose_exogenous = arguments.exogenous;
  Reasoner reasoner(kr3::reasoner::readDescription(arguments.file), options);
  if (!arguments.history.empty())
  {
    reasoner.setHistory(kr3::reasoner::parseHistory(contentsOf(arguments.history),
                                                    arguments.history, reasoner.description()));
  }
  return reasoner;
}

int stepFor(const Arguments& arguments, const Reasoner& reasoner)
{
  return arguments.step < 0 ? reasoner.currentStep() : arguments.step;
}

json check(const Arguments& arguments)
{
  Description description;
  if (arguments.base.empty())
  {
    description = kr3::reasoner::readDescription(arguments.file);
  }
  else
  {
    description = kr3::reasoner::parseRefinement(contentsOf(arguments.file), arguments.file,
                                                 kr3::reasoner::readDescription(arguments.base));
  }
  return {{"sorts", description.sorts.size()},
          {"fluents", description.fluents.size()},
          {"actions", description.actions.size()},
          {"axioms", description.causal_laws.size() + description.constraints.size() +
                         description.executabilities.size()},
          {"defaults", description.defaults.size()}};
}

json entails(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const int step = stepFor(arguments, reasoner);
  const Answer answer = reasoner.entails(arguments.literal, step);
  return {{"literal", arguments.literal},
          {"step", step},
          {"answer", answer == Answer::kTrue    ? "true"
                     : answer == Answer::kFalse ? "false"
                                                : "unknown"},
          {"possible", reasoner.possible(arguments.literal, step)}};
}

json explain(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const auto explanation = reasoner.explain(arguments.literal, stepFor(arguments, reasoner));
  return {{"entailed", explanation.entailed},
          {"reasons", explanation.reasons},
          {"records", explanation.records}};
}

json models(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  json steps = json::object();
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    std::vector<std::string> literals;
    for (const auto& literal : reasoner.entailedAt(step))
    {
      literals.push_back(toString(literal));
    }
    steps["step " + std::to_string(step)] = literals;
  }
  return steps;
}

json diagnose(const Arguments& arguments)
{
  const auto diagnosis = reasonerFor(arguments).diagnose();
  return {{"consistent", diagnosis.consistent},
          {"cost", diagnosis.cost},
          {"explanations", diagnosis.explanations},
          {"in_words", diagnosis.in_words},
          {"conflict", diagnosis.conflict}};
}

json plan(const Arguments& arguments)
{
  kr3::reasoner::PlanOptions options;
  options.max_horizon = arguments.max_horizon;
  const auto result = reasonerFor(arguments).plan(arguments.goal, options);
  json plans = json::array();
  for (const auto& found : result.plans)
  {
    plans.push_back({{"hypothesis", found.hypothesis}, {"steps", found.steps}});
  }
  return {{"goal_entailed", result.goal_entailed},
          {"plans", plans},
          {"reason", result.reason},
          {"cpu_s", result.cpu_s}};
}

/// `key: value` lines; what is nested is indented.
void printText(const json& value, const std::string& indent)
{
  for (const auto& [key, item] : value.items())
  {
    const std::string name = value.is_array() ? "-" : key + ":";
    if (item.is_primitive())
    {
      std::cout << indent << name << " "
                << (item.is_string() ? item.get<std::string>() : item.dump()) << "\n";
    }
    else
    {
      std::cout << indent << name << (item.empty() ? " none" : "") << "\n";
      printText(item, indent + "  ");
    }
  }
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app("Questions about a domain description and a history.");
  app.require_subcommand(1);
  Arguments arguments;
  json (*question)(const Arguments&) = nullptr;
  bool translate = false;
  const auto add = [&](const char* name, const char* help, json (*answer)(const Arguments&)) {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("file", arguments.file, "the domain description")->required();
    command->add_option("--format", arguments.format, "text or json")
        ->check(CLI::IsMember({"text", "json"}));
    command->callback([&question, answer] { question = answer; });
    return command;
  };
  const auto withHistory = [&](CLI::App* command) {
    command->add_option("--history", arguments.history, "a history file");
    command->add_flag("--exogenous", arguments.exogenous,
                      "exogenous actions compete with exceptions to defaults from the start");
    return command;
  };
  const auto withLiteral = [&](CLI::App* command) {
    command->add_option("--literal", arguments.literal, "a ground literal")->required();
    command->add_option("--step", arguments.step, "the step; the current one if not given");
    return withHistory(command);
  };
  add("check", "check a description, or a refinement", check)
      ->add_option("--base", arguments.base, "the description that FILE refines");
  withHistory(add("translate", "print the answer set program", nullptr))->callback([&] {
    translate = true;
  });
  withLiteral(add("entails", "is a literal true, false or unknown?", entails));
  withLiteral(add("explain", "why is a literal entailed?", explain));
  withHistory(add("models", "everything that is entailed, step by step", models));
  withHistory(add("diagnose", "the minimal explanations of a history", diagnose));
  CLI::App* planning = withHistory(add("plan", "shortest plans for a goal", plan));
  planning->add_option("--goal", arguments.goal, "a formula over literals")->required();
  planning->add_option("--max-horizon", arguments.max_horizon, "the longest plan that is tried");
  CLI11_PARSE(app, argc, argv);
  try
  {
    if (translate)
    {
      std::cout << reasonerFor(arguments).translation();
      return EXIT_SUCCESS;
    }
    const json answer = question(arguments);
    if (arguments.format == "json")
    {
      std::cout << answer.dump(2) << "\n";
    }
    else
    {
      printText(answer, "");
    }
  }
  catch (const std::exception& e)
  {
    std::cerr << e.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
