#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/zoom.hpp"

namespace CLI
{
class App;
}

/// What the package's command-line tools share.
namespace kr3::refinement::tools
{

struct Options
{
  std::string domain;
  std::string state;
  std::string action;
  std::string map;
  std::string models;  ///< empty: the domain's own
  std::size_t per_whole = 4;
  double pitch_m = 1.0;
  std::vector<std::string> known;
  std::vector<std::string> hidden;
  double solve_s = 0.0;
};

/// Adds the options that say which domain: its directory, its map or the grid made for it.
void addDomainOptions(CLI::App& app, Options& options);

/// Adds the options that say which task: the state, the action, what is known at the start.
void addTaskOptions(CLI::App& app, Options& options);

/// @param models  receives models.yaml, unless null
/// @throws InvalidArgument  what is wrong with any of the files that are read
[[nodiscard]] LowLevelDomain loadDomain(const Options& options, Models* models = nullptr,
                                        const ModelsOptions& how = {});

/// Domain, task and `--solve`. Exits when the arguments are wrong or ask for help.
[[nodiscard]] Options parse(int argc, char** argv, const std::string& purpose);

/// A domain directory with the state and the action asked about.
struct Loaded
{
  LowLevelDomain domain;
  Models models;
  std::vector<reasoner::Literal> state;
  reasoner::Atom action;  ///< without a name when none is given
};

[[nodiscard]] Loaded load(const Options& options);

/// @param text  ground literals of the high level, joined by commas
[[nodiscard]] std::vector<reasoner::Literal> literalsOf(const std::string& text,
                                                        const reasoner::Description& high_level);

/// What `--known` and `--hidden` say. @throws InvalidArgument  one of them is malformed
[[nodiscard]] InitialKnowledge knowledgeOf(const Options& options, const Zoom& zoom);

}  // namespace kr3::refinement::tools
