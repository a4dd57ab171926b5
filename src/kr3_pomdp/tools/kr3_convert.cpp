// Converts models and policies between formats.

#include <cstddef>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/policy_graph.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "tool.hpp"

namespace
{

using namespace kr3::pomdp;

const std::vector<std::string> kInputs = {"auto", "pomdp", "pomdpx", "kr3", "appl"};
const std::vector<std::string> kOutputs = {"auto", "pomdp", "pomdpx", "kr3", "appl", "dot"};

struct Options
{
  std::string input;
  std::string output;
  std::string from = "auto";
  std::string to = "auto";
  std::string model;
  std::string nodes = "beliefs";
  PolicyGraphLimits graph;
};

/// By what is in the file.
std::string formatOfInput(const Options& options)
{
  if (options.from != "auto")
  {
    return options.from;
  }
  std::ifstream in(options.input, std::ios::binary);
  if (!in)
  {
    throw kr3::Unavailable("cannot open '" + options.input + "'");
  }
  std::string head(4096, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.rfind("kr3_policy", 0) == 0)
  {
    return "kr3";
  }
  const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string::npos || head[first] != '<')
  {
    return "pomdp";
  }
  return head.find("<Policy") != std::string::npos ? "appl" : "pomdpx";
}

/// By the name of the file.
std::string formatOfOutput(const Options& options)
{
  if (options.to != "auto")
  {
    return options.to;
  }
  const std::size_t dot = options.output.rfind('.');
  const std::string ending = dot == std::string::npos ? "" : options.output.substr(dot + 1);
  if (ending == "pomdp" || ending == "pomdpx" || ending == "dot")
  {
    return ending;
  }
  if (ending == "gv")
  {
    return "dot";
  }
  if (ending == "policy")
  {
    return "kr3";
  }
  throw kr3::InvalidArgument("the name '" + options.output +
                             "' does not tell a format, expected an end in .pomdp, .pomdpx, "
                             ".policy, .dot or .gv, or --to");
}

void convertModel(const Options& options, const std::string& from, const std::string& to,
                  std::ostream& out)
{
  if (from == "pomdpx" && to == "pomdpx")
  {
    writePomdpx(out, loadPomdpx(options.input));
  }
  else if (to == "pomdpx")
  {
    writePomdpx(out, loadPomdp(options.input));
  }
  else
  {
    const Model model = from == "pomdpx" ? loadModel(options.input) : loadPomdp(options.input);
    for (const std::string& kind : writePomdpNumbered(out, model))
    {
      std::cerr << "note: the " << kind
                << "s are numbered, their names do not fit the format (comments tell them)\n";
    }
  }
}

void convertPolicy(const Options& options, const std::string& from, const std::string& to,
                   std::ostream& out)
{
  if (options.model.empty())
  {
    throw kr3::InvalidArgument("a policy is converted with its model, expected --model");
  }
  const Model model = loadModel(options.model);
  const Policy policy =
      loadPolicy(options.input, model, from == "appl" ? PolicyFormat::kAppl : PolicyFormat::kKr3);
  if (to == "kr3")
  {
    policy.write(out);
  }
  else if (to == "appl")
  {
    writeApplPolicy(out, policy, model, options.model);
  }
  else
  {
    const PolicyGraphNodes nodes =
        options.nodes == "vectors" ? PolicyGraphNodes::kVectors : PolicyGraphNodes::kBeliefs;
    writeDot(out, policyGraph(model, policy, options.graph, nodes), model);
  }
}

void run(const Options& options)
{
  const std::string from = formatOfInput(options);
  const std::string to = formatOfOutput(options);
  const auto isModel = [](const std::string& format) {
    return format == "pomdp" || format == "pomdpx";
  };
  if (isModel(from) != isModel(to))
  {
    throw kr3::InvalidArgument("'" + options.input + "' is in the format " + from +
                               ", which cannot become " + to +
                               ", expected a model to a model, or a policy to a policy or dot");
  }
  tool::OutputFile output(options.output);
  if (isModel(from))
  {
    convertModel(options, from, to, output.stream());
  }
  else
  {
    convertPolicy(options, from, to, output.stream());
  }
  output.finish();
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app(
      "Converts a model (.pomdp, .pomdpx), or a policy (kr3, appl) also to a graph (dot).");
  app.add_option("input", options.input, "file to read")->required();
  app.add_option("output", options.output, "file to write; - = the standard output")->required();
  app.add_option("--from", options.from, "format of the input; auto: by what it holds")
      ->check(CLI::IsMember(kInputs))
      ->capture_default_str();
  app.add_option("--to", options.to, "format of the output; auto: by its name")
      ->check(CLI::IsMember(kOutputs))
      ->capture_default_str();
  app.add_option("--model", options.model, "the policy's model");
  app.add_option("--nodes", options.nodes, "of a graph: beliefs, or vectors (smaller, coarser)")
      ->check(CLI::IsMember({"beliefs", "vectors"}))
      ->capture_default_str();
  app.add_option("--max-nodes", options.graph.max_nodes, "of a graph, the likeliest ones")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-depth", options.graph.max_depth, "actions from the start of a graph")
      ->capture_default_str();
  app.add_option("--min-probability", options.graph.min_probability,
                 "of coming to a branch from the start of a graph")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  return tool::runTool(app, argc, argv, [&] { run(options); });
}
