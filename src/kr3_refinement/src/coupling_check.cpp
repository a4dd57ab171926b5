#include "kr3_refinement/coupling_check.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include <kr3_common/error.hpp>

#include "coupling_graph.hpp"
#include "kr3_refinement/zoom.hpp"
#include "semantics.hpp"
#include "state_view.hpp"
#include "symmetry.hpp"

namespace kr3::refinement
{
namespace
{

constexpr std::size_t kFreshValues = 2;     // of each kind, beside what the action names
constexpr std::size_t kFreshArguments = 1;  // likewise

/// Texts of the literals of a coarse state.
std::vector<std::string> literals(const CoarseState& state)
{
  std::vector<std::string> result;
  for (const auto& [fluent, value] : state)
  {
    result.push_back(value == "true"    ? fluent
                     : value == "false" ? "-" + fluent
                                        : fluent + " = " + value);
  }
  return result;
}

class Checker
{
public:
  Checker(const LowLevelDomain& domain, const CouplingCheckOptions& options)
    : domain_(domain), options_(options), symmetry_(domain), high_level_(domain.highLevel())
  {
  }

  CouplingReport run()
  {
    const std::vector<GroundAction> actions = high_level_.actions();
    std::set<std::string> patterns;
    bool known = options_.action.empty();
    for (const GroundAction& action : actions)
    {
      ++report_.num_ground_actions;
      const bool asked = options_.action.empty() ||
                         normalised(options_.action) == normalised(action.name) ||
                         options_.action == action.symbol;
      known = known || asked;
      const std::string pattern = action.symbol + ":" + symmetry_.pattern(argumentsOf(action));
      if (asked && (!options_.up_to_symmetry || patterns.insert(pattern).second))
      {
        ++report_.num_checked_actions;
        checkAction(action);
      }
    }
    if (!known)
    {
      throw InvalidArgument("'" + options_.action +
                            "' is no agent action of the high level, ground or by name");
    }
    for (const auto& [key, graph] : graphs_)
    {
      for (const auto& [action, fluents] : graph->changes())
      {
        report_.changes[action].insert(fluents.begin(), fluents.end());
      }
    }
    return std::move(report_);
  }

private:
  [[nodiscard]] std::vector<std::string> argumentsOf(const GroundAction& action) const
  {
    std::vector<std::string> result;
    for (const int argument : action.arguments)
    {
      result.push_back(high_level_.vocabulary().name(argument));
    }
    return result;
  }

  /// The constants over which high-level states are tried for an action.
  [[nodiscard]] std::set<std::string> constantsFor(const GroundAction& action) const
  {
    const std::vector<std::string> arguments = argumentsOf(action);
    std::set<std::string> constants(arguments.begin(), arguments.end());
    std::set<std::string> value_sorts;
    std::set<std::string> argument_sorts;
    for (const reasoner::FluentDeclaration& fluent : domain_.highLevel().fluents)
    {
      if (fluent.kind == reasoner::FluentKind::kInertial)
      {
        if (fluent.value_sort)
        {
          value_sorts.insert(*fluent.value_sort);
        }
        argument_sorts.insert(fluent.argument_sorts.begin(), fluent.argument_sorts.end());
      }
    }
    addFresh(value_sorts, kFreshValues, arguments, constants);
    addFresh(argument_sorts, kFreshArguments, arguments, constants);
    return constants;
  }

  void addFresh(const std::set<std::string>& sorts, std::size_t count,
                const std::vector<std::string>& named, std::set<std::string>& constants) const
  {
    for (const std::string& name : sorts)
    {
      const reasoner::Sort* sort = domain_.highLevel().findSort(name);
      std::map<std::string, std::size_t> added;
      for (const std::string& element :
           sort == nullptr ? std::vector<std::string>{} : sort->elements)
      {
        const bool is_named = std::find(named.begin(), named.end(), element) != named.end();
        std::size_t& of_kind = added[symmetry_.kind(element)];
        if (!is_named && (!options_.up_to_symmetry || of_kind < count))
        {
          constants.insert(element);
          ++of_kind;
        }
      }
    }
  }

  [[nodiscard]] std::vector<Values> statesFor(const GroundAction& action, const Semantics& partial,
                                              std::size_t num_constants) const
  {
    try
    {
      return partial.states(options_.max_states);
    }
    catch (const ResourceExhausted&)
    {
      throw ResourceExhausted("checking " + action.name + " over " + std::to_string(num_constants) +
                              " constants takes more than " + std::to_string(options_.max_states) +
                              " high-level states; raise the limit, or check up to symmetry");
    }
  }

  void checkAction(const GroundAction& action)
  {
    const std::set<std::string> constants = constantsFor(action);
    const Semantics partial(domain_.highLevel(), &constants);
    const reasoner::Atom atom = reasoner::parseGroundAction(action.name, domain_.highLevel());
    bool executable = false;
    for (const Values& state : statesFor(action, partial, constants.size()))
    {
      std::vector<reasoner::Literal> before;
      for (std::size_t i = 0; i < partial.signature().numInertial(); ++i)
      {
        before.push_back(literalOf(partial, i, state[i]));
      }
      const Values values = valuesOf(high_level_, before);
      if (high_level_.forbidden(values, action))
      {
        continue;
      }
      const std::vector<Result> results = high_level_.results(values, action);
      executable = executable || !results.empty();
      if (!results.empty() && changes(values, results.front().values))
      {
        checkTransition(zoom(domain_, before, atom), values, results.front().values);
      }
    }
    if (!executable)
    {
      report_.never_executable.push_back(action.name);
    }
  }

  [[nodiscard]] bool changes(const Values& before, const Values& after) const
  {
    const auto last = static_cast<std::ptrdiff_t>(high_level_.signature().numInertial());
    return !std::equal(before.begin(), before.begin() + last, after.begin());
  }

  void checkTransition(const Zoom& zoom, const Values& before, const Values& after)
  {
    const CouplingGraph& graph = graphOf(zoom, before, after);
    const CoarseState start = coarseState(graph, before);
    const CoarseState goal = coarseState(graph, after);
    if (!checked_.insert({&graph, start, goal}).second)
    {
      return;
    }
    ++report_.num_transitions;
    const CouplingGraph::Paths paths = graph.paths(start, goal, options_.direct);
    report_.num_low_level_states += paths.num_compatible - paths.failing.size();
    if (paths.num_compatible > 0 && paths.failing.empty())
    {
      return;
    }
    ++report_.num_failures;
    if (report_.counterexamples.size() == options_.max_counterexamples)
    {
      return;
    }
    CouplingCounterexample example{zoom.action, literals(start), literals(goal), {}, {}, 0, 0};
    example.num_compatible = paths.num_compatible;
    example.num_failing = paths.failing.size();
    if (!paths.failing.empty())
    {
      example.low_level_state = graph.literals(paths.failing.front());
      for (const CoarseState& state : graph.reachable(paths.failing.front()))
      {
        example.reachable.push_back(literals(state));
      }
    }
    report_.counterexamples.push_back(std::move(example));
  }

  /// A value outside the zoom is `elsewhere` in its states.
  const CouplingGraph& graphOf(const Zoom& zoom, const Values& before, const Values& after)
  {
    std::set<std::string> outside;
    for (std::size_t i = 0; i < high_level_.signature().numInertial(); ++i)
    {
      for (const int value : {before[i], after[i]})
      {
        const bool kept = value == Vocabulary::kNone || isBoolean(i) ||
                          zoom.constants.count(high_level_.vocabulary().name(value)) > 0;
        if (!kept)
        {
          outside.insert(high_level_.fluents()[i].name);
        }
      }
    }
    std::unique_ptr<CouplingGraph>& graph = graphs_[{zoom.constants, outside}];
    if (!graph)
    {
      graph =
          std::make_unique<CouplingGraph>(domain_, zoom.constants, outside, options_.max_states);
    }
    return *graph;
  }

  [[nodiscard]] bool isBoolean(std::size_t fluent) const
  {
    return high_level_.signature().symbols()[high_level_.fluents()[fluent].symbol].boolean;
  }

  /// A high-level state as the graph's zoom sees it.
  [[nodiscard]] CoarseState coarseState(const CouplingGraph& graph, const Values& values) const
  {
    CoarseState state;
    for (const std::string& name : graph.coarseFluents())
    {
      const std::optional<std::size_t> fluent = high_level_.signature().findFluent(name);
      if (fluent && values[*fluent] != Vocabulary::kNone)
      {
        const std::string& value = high_level_.vocabulary().name(values[*fluent]);
        state[name] = isBoolean(*fluent) || graph.keeps(value) ? value : kElsewhere;
      }
    }
    return state;
  }

  const LowLevelDomain& domain_;
  const CouplingCheckOptions& options_;
  Symmetry symmetry_;
  Semantics high_level_;
  std::map<std::pair<std::set<std::string>, std::set<std::string>>, std::unique_ptr<CouplingGraph>>
      graphs_;
  std::set<std::tuple<const CouplingGraph*, CoarseState, CoarseState>> checked_;
  CouplingReport report_;
};

std::string joined(const std::vector<std::string>& literals)
{
  std::string result;
  for (const std::string& literal : literals)
  {
    result += (result.empty() ? "" : ", ") + literal;
  }
  return result.empty() ? "nothing" : result;
}

}  // namespace

CouplingReport checkCoupling(const LowLevelDomain& domain, const CouplingCheckOptions& options)
{
  return Checker(domain, options).run();
}

std::string toString(const CouplingReport& report)
{
  std::ostringstream out;
  out << (report.passed() ? "The levels fit" : "The levels do not fit") << ": "
      << report.num_transitions << " transitions of " << report.num_checked_actions
      << " actions (standing for " << report.num_ground_actions << "), "
      << report.num_low_level_states << " low-level starts with a path";
  if (!report.passed())
  {
    out << ", " << report.num_failures << " transitions without";
  }
  out << ".\n";
  for (const CouplingCounterexample& example : report.counterexamples)
  {
    out << "\n"
        << example.action << "\n  from " << joined(example.before) << "\n  to   "
        << joined(example.after) << "\n";
    if (example.num_compatible == 0)
    {
      out << "  No low-level state is compatible with the first.\n";
      continue;
    }
    out << "  " << example.num_failing << " of " << example.num_compatible
        << " low-level states have no path, such as\n    " << joined(example.low_level_state)
        << "\n  From there the low level leads only to\n";
    for (const std::vector<std::string>& state : example.reachable)
    {
      out << "    " << joined(state) << "\n";
    }
  }
  if (!report.never_executable.empty())
  {
    out << "\nNever executable, so not checked: " << joined(report.never_executable) << ".\n";
  }
  out << "\nLow-level actions and the fluents that they change:\n";
  for (const auto& [action, fluents] : report.changes)
  {
    out << "  " << action << ": " << joined({fluents.begin(), fluents.end()}) << "\n";
  }
  return out.str();
}

}  // namespace kr3::refinement
