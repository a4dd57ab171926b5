#include "command_line.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_refinement/low_level_files.hpp"

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

void addTaskOptions(CLI::App& app, Options& options)
{
  app.add_option("--models", options.models, "numbers of the low level; without it models.yaml");
  app.add_option("--state", options.state,
                 "high-level state: literals joined by commas, as 'f(a)=b, g(c)'; "
                 "booleans not listed are false");
  app.add_option("--action", options.action, "ground high-level action, as 'act(a, b)'");
  app.add_option("--known", options.known,
                 "FLUENT=VALUE: low-level value that is certain, as 'f(a)=b_c2'");
  app.add_option("--hidden", options.hidden,
                 "FLUENT=P: its value in the state is only believed, with probability P, and the "
                 "rest is elsewhere; or FLUENT=V:P,V:P,...: over high-level values");
}

Options parse(int argc, char** argv, const std::string& purpose)
{
  Options options;
  CLI::App app{purpose};
  app.option_defaults()->always_capture_default();
  addDomainOptions(app, options);
  addTaskOptions(app, options);
  app.get_option("--state")->required();
  app.get_option("--action")->required();
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
std::vector<std::string> splitAtCommas(const std::string& text)
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

}  // namespace

LowLevelDomain loadDomain(const Options& options, Models* models, const ModelsOptions& how)
{
  const reasoner::Description high_level =
      reasoner::readDescription(options.domain + "/domain.kr3");
  const reasoner::Description refinement =
      readRefinementFile(options.domain + "/refinement.kr3", high_level);
  const ComponentMap map = mapOf(options, high_level, refinement);
  const std::string models_file =
      options.models.empty() ? options.domain + "/models.yaml" : options.models;
  std::optional<LowLevelDomain> domain;
  Refusals refusals;
  refusals.attempt([&] { domain.emplace(high_level, refinement, map); });
  if (models != nullptr)
  {
    refusals.attempt([&] {
      *models = domain ? readModels(models_file, *domain, how)
                       : readModels(models_file, namesOfLowLevel(high_level, refinement, map), how);
    });
  }
  refusals.throwIfAny();
  return std::move(*domain);
}

std::vector<reasoner::Literal> literalsOf(const std::string& text,
                                          const reasoner::Description& high_level)
{
  std::vector<reasoner::Literal> literals;
  if (text.find_first_not_of(" \t") == std::string::npos)
  {
    return literals;
  }
  for (const std::string& literal : splitAtCommas(text))
  {
    literals.push_back(reasoner::parseGroundLiteral(literal, high_level));
  }
  return literals;
}

Loaded load(const Options& options)
{
  Models models;
  LowLevelDomain domain = loadDomain(options, &models);
  const reasoner::Description& high_level = domain.highLevel();
  std::vector<reasoner::Literal> state = literalsOf(options.state, high_level);
  reasoner::Atom action;
  if (!options.action.empty())
  {
    action = reasoner::parseGroundAction(options.action, high_level);
  }
  return {std::move(domain), std::move(models), std::move(state), std::move(action)};
}

namespace
{

std::string trimmed(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? std::string()
                                    : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

double probabilityOf(const std::string& text, const std::string& option)
{
  std::size_t used = 0;
  double value = -1.0;
  try
  {
    value = std::stod(text, &used);
  }
  catch (const std::exception&)
  {
    used = 0;
  }
  if (used == 0 || used != text.size() || !(value >= 0.0 && value <= 1.0))
  {
    throw InvalidArgument(option + ": found '" + text + "', expected a probability");
  }
  return value;
}

/// The value of a fluent in the zoom's start.
std::string startValue(const Zoom& zoom, const std::string& fluent, const std::string& option)
{
  const auto squeezed = [](std::string name) {
    name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
    return name;
  };
  for (const reasoner::Literal& literal : zoom.start)
  {
    if (squeezed(reasoner::toString(literal.atom)) == squeezed(fluent))
    {
      return literal.value.name;
    }
  }
  throw InvalidArgument(option + ": the zoom's start says nothing about '" + fluent + "'");
}

}  // namespace

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
    knowledge.fine[trimmed(text.substr(0, equal))] = {{trimmed(text.substr(equal + 1)), 1.0}};
  }
  for (const std::string& text : options.hidden)
  {
    const std::string option = "--hidden " + text;
    const std::size_t equal = text.rfind('=');
    if (equal == std::string::npos)
    {
      throw InvalidArgument(option + ": expected FLUENT=P or FLUENT=VALUE:P,...");
    }
    const std::string fluent = trimmed(text.substr(0, equal));
    const std::string values = text.substr(equal + 1);
    Distribution& distribution = knowledge.coarse[fluent];
    if (values.find(':') == std::string::npos)
    {
      distribution[startValue(zoom, fluent, option)] = probabilityOf(trimmed(values), option);
      continue;
    }
    for (const std::string& part : splitAtCommas(values))
    {
      const std::size_t colon = std::min(part.find(':'), part.size());
      distribution[trimmed(part.substr(0, colon))] = probabilityOf(
          colon == part.size() ? std::string() : trimmed(part.substr(colon + 1)), option);
    }
  }
  return knowledge;
}

}  // namespace kr3::refinement::tools
