#include "kr3_executive/routes.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <kr3_reasoner/reasoner.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

/// Of a law with several outcomes.
const OutcomeChooser kFirst{[](const auto&, const auto&) { return std::size_t{0}; },
                            [](std::size_t) { return std::size_t{0}; }};

std::set<std::string> changedFluents(const FluentValues& before, const FluentValues& after)
{
  std::set<std::string> changed;
  for (const auto& [fluent, value] : after)
  {
    const auto old = before.find(fluent);
    if (old == before.end() || old->second != value)
      changed.insert(fluent);
  }
  for (const auto& entry : before)
  {
    if (after.count(entry.first) == 0)
      changed.insert(entry.first);
  }
  return changed;
}

/// Breadth first from one state to another, by actions that change nothing but given fluents.
class Search
{
public:
  Search(const RuleInterpreter& laws, FluentValues start, FluentValues end)
    : laws_(laws)
    , start_(std::move(start))
    , end_(std::move(end))
    , may_change_(changedFluents(start_, end_))
  {
    for (const auto& declaration : laws_.description().actions)
    {
      if (declaration.exogenous)
        continue;
      for (auto& action : laws_.instances(declaration))
        actions_.push_back({action, reasoner::toString(action), true});
    }
  }

  std::vector<std::vector<std::vector<std::string>>> run(const std::string& avoided,
                                                         const Forbidden& forbidden,
                                                         std::size_t most)
  {
    using Way = std::vector<std::vector<std::string>>;
    struct Node
    {
      FluentValues state;
      std::vector<Way> ways;  // all the shortest ones
    };
    std::vector<Node> level{{start_, {{}}}};
    std::set<FluentValues> seen{start_};
    while (!level.empty())
    {
      std::map<FluentValues, std::vector<Way>> next;
      for (const auto& node : level)
      {
        for (auto& action : actions_)
        {
          if ((node.state == start_ && action.text == avoided) ||
              forbidden(node.state, action.text))
            continue;
          const auto after = successor(node.state, action);
          if (!after || seen.count(*after) > 0)
            continue;
          std::vector<Way>& ways = next[*after];
          for (const auto& way : node.ways)
          {
            if (ways.size() == most)
              break;
            ways.push_back(way);
            ways.back().push_back({action.text});
          }
        }
      }
      if (const auto found = next.find(end_); found != next.end())
        return found->second;
      level.clear();
      for (auto& [state, ways] : next)
      {
        seen.insert(state);
        level.push_back({state, std::move(ways)});
      }
    }
    return {};
  }

private:
  struct Action
  {
    reasoner::Atom atom;
    std::string text;
    bool useful = true;  ///< it changed nothing else so far
  };

  std::optional<FluentValues> successor(const FluentValues& state, Action& action) const
  {
    if (!action.useful || !laws_.executable(state, action.atom))
      return std::nullopt;
    FluentValues after = laws_.successor(state, action.atom, kFirst);
    for (const auto& fluent : changedFluents(state, after))
      action.useful = action.useful && may_change_.count(fluent) > 0;
    if (!action.useful)
      return std::nullopt;
    return after;
  }

  const RuleInterpreter& laws_;
  FluentValues start_;
  FluentValues end_;
  std::set<std::string> may_change_;
  std::vector<Action> actions_;
};

}  // namespace

FluentValues valuesOf(const std::vector<reasoner::Literal>& state)
{
  FluentValues values;
  for (const auto& literal : state)
  {
    if (literal.equal)
      values[reasoner::toString(literal.atom)] = literal.value.name;
  }
  return values;
}

std::string situationOf(const FluentValues& state, const std::string& action)
{
  const std::vector<std::string> about = takeApart(action).arguments;
  std::string text;
  for (const auto& [fluent, value] : state)
  {
    const std::vector<std::string> arguments = takeApart(fluent).arguments;
    const bool concerned =
        std::all_of(arguments.begin(), arguments.end(), [&](const std::string& argument) {
          return std::find(about.begin(), about.end(), argument) != about.end();
        });
    if (concerned && value != "false")
      text += (text.empty() ? "" : ", ") + fluent + " = " + value;
  }
  return text;
}

std::vector<std::vector<std::vector<std::string>>> detours(const RuleInterpreter& laws,
                                                           const FluentValues& state,
                                                           const std::string& action,
                                                           const Forbidden& forbidden,
                                                           std::size_t most)
{
  const auto atom = reasoner::parseGroundAction(action, laws.description());
  if (most == 0 || !laws.executable(state, atom))
    return {};
  return Search(laws, state, laws.successor(state, atom, kFirst)).run(action, forbidden, most);
}

}  // namespace kr3::executive
