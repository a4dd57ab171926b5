// Questions about a domain description and a history, from the command line. Needs no ROS.

#include <cstdlib>
#include <exception>
#include <iostream>
#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "commands.hpp"
#include "text_output.hpp"

namespace
{

using kr3::reasoner::tool::Arguments;
using kr3::reasoner::tool::Json;
using kr3::reasoner::tool::Reply;

constexpr int kExitInput = 1;
constexpr int kExitUsage = 2;
constexpr int kExitLimit = 3;
constexpr int kExitNegative = 4;

const char* const kFooter = R"text(
Several FILEs are one description, such as a domain and the objects of a building.
A FORMULA is made of literals: "on(red) and not (dim or colour(blue) = 3)".

Exit codes: 0 answered, whatever the answer (a plan, "no plan", "false")
            1 an error in a file or in the question; it is told with its place
            2 wrong usage
            3 a limit of time or memory was reached
            4 only with --exit-code: answered, but not entailed, no plan or inconsistent

`kr3_reason COMMAND --help` explains a command.)text";

using Command = Reply (*)(const Arguments&);

/// The command line. Callbacks refer to `arguments`, which outlives it.
class CommandLine
{
public:
  explicit CommandLine(Arguments& arguments) : arguments_(arguments)
  {
    namespace tool = kr3::reasoner::tool;
    app_.footer(kFooter);

    CLI::App& check = add("check", "Check a description, a refinement or a history", tool::check,
                          "kr3_reason check domain.kr3 objects.kr3\n"
                          "kr3_reason check refinement.kr3 --base domain.kr3");
    check.add_option("--base", arguments_.base, "the description that FILE refines");
    addHistory(check);

    CLI::App& translate =
        add("translate", "Print the answer set program, for plain clingo", tool::translate,
            "kr3_reason translate domain.kr3 --history day.hist > day.lp && clingo "
            "--project=show day.lp 0\n"
            "kr3_reason translate domain.kr3 --goal \"on(red)\" > plan.lp && clingo plan.lp");
    addHistory(translate);
    addPrices(translate);
    addPlanning(translate)->description("look for plans that reach this formula");
    translate
        .add_option("--length", arguments_.length, "steps of the plan (default: the shortest)")
        ->check(CLI::Range(0, kMaxSteps));

    CLI::App& entails =
        add("entails", "Is a literal true, false or unknown? Without one: all that is entailed",
            tool::entails,
            "kr3_reason entails domain.kr3 --history day.hist --literal \"on(red)\" --step 2\n"
            "kr3_reason entails domain.kr3 --assume \"obs(on(red), false, 1)\"");
    addLiteral(entails);

    CLI::App& explain = add("explain", "Why is a literal entailed?", tool::explain,
                            "kr3_reason explain domain.kr3 --history day.hist --literal \"-dim\"");
    require(explain, addLiteral(explain));

    CLI::App& models = add("models", "List the models of a history: how it may have been",
                           tool::models, "kr3_reason models domain.kr3 --history day.hist --all");
    addHistory(models);
    addPrices(models);
    models.add_option("--limit", arguments_.limit, "list at most so many")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    models.add_flag("--all", arguments_.all, "list all, however many there are");

    CLI::App& diagnose =
        add("diagnose", "The minimal explanations of a history, or what in it conflicts",
            tool::diagnose,
            "kr3_reason diagnose domain.kr3 --history day.hist --exogenous --exogenous-weight 3");
    addHistory(diagnose);
    addPrices(diagnose);

    CLI::App& plan = add("plan", "Shortest plans for a goal, one for each hypothesis", tool::plan,
                         "kr3_reason plan domain.kr3 --history day.hist --goal \"on(red)\"");
    addHistory(plan);
    addPrices(plan);
    require(plan, addPlanning(plan));
    plan.add_option("--prefer", arguments_.preference,
                    "which plans: shortest, cheapest-shortest (of the shortest the cheapest), "
                    "cheapest (up to --max-horizon)")
        ->capture_default_str()
        ->check(CLI::IsMember({"shortest", "cheapest-shortest", "cheapest"}));
    plan.add_flag_callback(
        "--cost", [this] { arguments_.preference = "cheapest"; }, "the same as --prefer cheapest");
    plan.add_flag("--all", arguments_.all, "all plans that are equally good");
    plan.add_option("--max-plans", arguments_.max_plans,
                    "with --all: at most so many for a hypothesis")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    plan.add_flag("--whole", arguments_.whole,
                  "plan on the whole description, also on what cannot matter to the goal");

    CLI::App& relevant =
        add("relevant", "The part of a description and a history that can matter to a goal",
            tool::relevant, "kr3_reason relevant domain.kr3 --history day.hist --goal \"on(red)\"");
    addHistory(relevant);
    require(relevant, relevant.add_option("--goal", arguments_.goal, "a FORMULA over literals"));

    CLI::App& import_sparc =
        add("import-sparc", "Bring a SPARC program of the common subset to this language",
            tool::importSparc,
            "kr3_reason import-sparc program.sp > domain.kr3\n"
            "kr3_reason import-sparc program.sp --part history > start.history");
    import_sparc
        .add_option("--part", arguments_.part,
                    "what to print as text: description, history or goals")
        ->capture_default_str()
        ->check(CLI::IsMember({"description", "history", "goals"}));
  }

  [[nodiscard]] CLI::App& app() { return app_; }
  [[nodiscard]] Command chosen() const { return command_; }

private:
  static constexpr int kMaxSteps = 10000;

  CLI::App& add(const std::string& name, const std::string& help, Command command,
                const std::string& examples)
  {
    CLI::App* sub = app_.add_subcommand(name, help);
    sub->add_option("FILE", arguments_.files, "the description")->required();
    sub->add_option("--format", arguments_.format, "text, or json for programs")
        ->capture_default_str()
        ->check(CLI::IsMember({"text", "json"}));
    sub->add_option("--time-limit", arguments_.time_limit_s,
                    "seconds that a question may take (default: none; a plan: 60)")
        ->check(CLI::PositiveNumber);
    sub->add_flag("--exit-code", arguments_.exit_code,
                  "exit with 4 when the answer is negative (see kr3_reason --help)");
    sub->footer("\nFor example:\n  " + indented(examples));
    sub->callback([this, sub, name, command] {
      const auto required = required_.find(sub);
      if (required != required_.end() && required->second->count() == 0)
      {
        throw CLI::RequiredError(required->second->get_name());
      }
      arguments_.command = name;
      command_ = command;
    });
    return *sub;
  }

  /// CLI11 itself would call a missing option first and hide the misspelt one.
  void require(CLI::App& command, CLI::Option* option)
  {
    option->description(option->get_description() + " (required)");
    required_[&command] = option;
  }

  static std::string indented(std::string lines)
  {
    for (std::size_t at = lines.find('\n'); at != std::string::npos; at = lines.find('\n', at + 1))
    {
      lines.insert(at + 1, "  ");
    }
    return lines;
  }

  void addHistory(CLI::App& command)
  {
    command.add_option("--history", arguments_.histories, "a history file (may be repeated)")
        ->allow_extra_args(false);
    command
        .add_option("--progress", arguments_.progress,
                    "let the history begin at this step; earlier records are not kept")
        ->check(CLI::Range(0, kMaxSteps));
    command
        .add_option("--assume", arguments_.assumed,
                    "what if: one more record, as \"obs(on(red), false, 1)\" (may be repeated)")
        ->allow_extra_args(false);
  }

  void addPrices(CLI::App& command)
  {
    command.add_flag("--exogenous", arguments_.exogenous,
                     "exogenous actions compete with exceptions to defaults from the start");
    command
        .add_option("--exception-weight", arguments_.exception_weight,
                    "price of an exception to a default")
        ->capture_default_str()
        ->check(CLI::Range(1, kMaxSteps));
    command
        .add_option("--exogenous-weight", arguments_.exogenous_weight,
                    "price of an exogenous action or a failed attempt")
        ->capture_default_str()
        ->check(CLI::Range(1, kMaxSteps));
    command
        .add_option("--default-weight", arguments_.default_weights,
                    "NAME=PRICE of an exception to one default (may be repeated)")
        ->allow_extra_args(false);
  }

  CLI::Option* addLiteral(CLI::App& command)
  {
    addHistory(command);
    addPrices(command);
    command.add_option("--step", arguments_.step, "the step (default: the current one)")
        ->check(CLI::Range(0, kMaxSteps));
    return command.add_option("--literal", arguments_.literal, "a ground literal");
  }

  CLI::Option* addPlanning(CLI::App& command)
  {
    command.add_option("--max-horizon", arguments_.max_horizon, "steps of the longest plan to try")
        ->capture_default_str()
        ->check(CLI::Range(1, kMaxSteps));
    return command.add_option("--goal", arguments_.goal, "a FORMULA over literals");
  }

  CLI::App app_{
      "Questions about a domain description and a history: kr3_reason COMMAND FILE... "
      "[--history FILE]",
      "kr3_reason"};
  Arguments& arguments_;
  Command command_ = nullptr;
  std::map<const CLI::App*, const CLI::Option*> required_;
};

/// Tells an error on stderr, and with --format json as an object on stdout too.
int fail(const Arguments& arguments, const std::string& code, const std::string& message, int exit)
{
  std::cerr << message << "\n";
  if (arguments.format == "json")
  {
    Json json = {{"command", arguments.command}};
    json["error"] = {{"code", code}, {"message", message}};
    std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
  }
  return exit;
}

int answer(const Arguments& arguments, Command command)
{
  const Reply reply = command(arguments);
  if (arguments.format == "json")
  {
    Json json = {{"command", arguments.command}};
    json.update(reply.json);
    std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
  }
  else
  {
    std::cout << kr3::reasoner::tool::textOf(arguments, reply.json);
  }
  std::cout.flush();
  if (!std::cout)
  {
    throw kr3::Unavailable("cannot write the answer");
  }
  return arguments.exit_code && !reply.positive ? kExitNegative : EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CommandLine line(arguments);
  try
  {
    line.app().parse(argc, argv);
    if (line.chosen() == nullptr)
    {
      throw CLI::RequiredError("A command");
    }
  }
  catch (const CLI::ParseError& e)
  {
    return line.app().exit(e) == 0 ? EXIT_SUCCESS : kExitUsage;
  }
  try
  {
    return answer(arguments, line.chosen());
  }
  catch (const kr3::Error& e)
  {
    const bool limit = e.code() == kr3::ErrorCode::kDeadlineExceeded ||
                       e.code() == kr3::ErrorCode::kResourceExhausted;
    return fail(arguments, kr3::toString(e.code()), e.what(), limit ? kExitLimit : kExitInput);
  }
  catch (const std::bad_alloc&)
  {
    return fail(arguments, "RESOURCE_EXHAUSTED", "out of memory", kExitLimit);
  }
  catch (const std::exception& e)
  {
    return fail(arguments, "INTERNAL", e.what(), kExitInput);
  }
}
