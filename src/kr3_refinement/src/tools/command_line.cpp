#include "command_line.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

namespace kr3::refinement::tools
{

void addDomainOptions(CLI::App& app, Options& options)
{
  app.add_option("DOMAIN_DIR", options.domain,
                 "directory with domain.kr3, refinement.kr3 and models.yaml")
      ->required();
  app.add_option("--map", options.map, "components as YAML; without it a grid is made");
  app.add_option("--cells-per-place", options.per_whole,
                 "components of each magnified element in the grid");
  app.add_option("--pitch", options.pitch_m, "m between neighbours in the grid");
}

Options parse(int argc, char** argv, const std::string& purpose)
{
  Options options;
  CLI::App app{purpose};
  app.option_defaults()->always_capture_default();
  addDomainOptions(app, options);
  app.add_option("--state", options.state, "high-level state: literals joined by commas")
      ->required();
  app.add_option("--action", options.action, "ground high-level action")->required();
  app.add_option("--known", options.known,
                 "FLUENT=VALUE: low-level value that is certain, as 'loc(rob1)=kitchen_c2'");
  app.add_option("--hidden", options.hidden,
                 "FLUENT=P: its value in the state is only believed, with probability P; the rest "
                 "is elsewhere");
  app.add_option("--pomdp", options.pomdp, "write the POMDP to this file");
  app.add_option("--solve", options.solve_s,
                 "solve it for so many seconds and simulate the policy");
  try
  {
    app.parse(argc, argv);
  }
  catch (const CLI::ParseError& error)
  {
    std::exit(app.exit(error));
  }
  return options;
}

namespace
{

/// Splits at commas that stand in no parentheses.
std::vector<std::string> literalsOf(const std::string& text)
{
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text)
  {
    depth += c == '(' ? 1 : (c == ')' ? -1 : 0);
    if (c == ',' && depth == 0)
    {
      parts.emplace_back();
    }
    else
    {
      parts.back() += c;
    }
  }
  return parts;
}

ComponentMap mapOf(const Options& options, const reasoner::Description& high_level,
                   const reasoner::Description& refinement_text)
{
  if (!options.map.empty())
  {
    return readComponentMap(options.map);
  }
  std::vector<std::string> wholes;
  for (const reasoner::Magnification& magnification : refinement_text.magnifications)
  {
    const std::vector<std::string>& elements = high_level.findSort(magnification.coarse)->elements;
    wholes.insert(wholes.end(), elements.begin(), elements.end());
  }
  return gridMap(wholes, options.per_whole, options.pitch_m);
}

std::string readText(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
  {
    throw Unavailable("cannot read '" + path + "'");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

LowLevelDomain loadDomain(const Options& options)
{
  const reasoner::Description high_level =
      reasoner::readDescription(options.domain + "/domain.kr3");
  const std::string path = options.domain + "/refinement.kr3";
  const reasoner::Description refinement =
      reasoner::parseRefinement(readText(path), path, high_level);
  return {high_level, refinement, mapOf(options, high_level, refinement)};
}

Loaded load(const Options& options)
{
  LowLevelDomain domain = loadDomain(options);
  const reasoner::Description& high_level = domain.highLevel();
  Models models = readModels(options.domain + "/models.yaml", domain.description());
  std::vector<reasoner::Literal> state;
  for (const std::string& literal : literalsOf(options.state))
  {
    state.push_back(reasoner::parseGroundLiteral(literal, high_level));
  }
  reasoner::Atom action = reasoner::parseGroundAction(options.action, high_level);
  return {std::move(domain), std::move(models), std::move(state), std::move(action)};
}

InitialKnowledge knowledgeOf(const Options& options, const Zoom& zoom)
{
  InitialKnowledge knowledge;
  for (const std::string& text : options.known)
  {
    const std::size_t equal = text.rfind('=');
    if (equal == std::string::npos)
    {
      throw InvalidArgument("--known " + text + ": expected FLUENT=VALUE");
    }
    knowledge.fine[text.substr(0, equal)] = {{text.substr(equal + 1), 1.0}};
  }
  for (const std::string& text : options.hidden)
  {
    const std::size_t equal = text.rfind('=');
    const std::string fluent = text.substr(0, equal);
    const double probability =
        equal == std::string::npos ? 0.5 : std::atof(text.c_str() + equal + 1);
    Distribution distribution;
    for (const reasoner::Literal& literal : zoom.start)
    {
      if (reasoner::toString(literal.atom) == fluent)
      {
        distribution[literal.value.name] = probability;
      }
    }
    if (distribution.empty())
    {
      throw InvalidArgument("--hidden " + text + ": the zoom's start says nothing about '" +
                            fluent + "'");
    }
    knowledge.coarse.emplace(fluent, std::move(distribution));
  }
  return knowledge;
}

}  // namespace kr3::refinement::tools
