// Domains by files alone: whole missions in each, and what the zoom must not lose.

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/transition_system.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/rule_interpreter.hpp"

namespace kr3::executive
{
namespace
{

std::string directory(const std::string& domain)
{
  return std::string(KR3_DOMAINS_DIR) + "/" + domain;
}

/// Counted work only, so that a run repeats exactly.
AbstractMissionConfig config()
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 2;
  return config;
}

class Silent : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& event) override
  {
    if (event.kind == EventKind::kLowLevelAction)
      actions.insert(event.narration.text.substr(0, event.narration.text.find('(')));
  }
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
  std::set<std::string> actions;
};

struct Case
{
  std::string domain;
  std::string goal;
  std::vector<std::vector<std::string>> truths;
};

class WholeMission : public testing::TestWithParam<Case>
{
};

TEST_P(WholeMission, ReachesItsGoalWhateverIsTrue)
{
  AbstractMissions missions(directory(GetParam().domain), config());
  for (const auto& truths : GetParam().truths)
  {
    for (const std::uint64_t seed : {1U, 2U, 3U})
    {
      Silent observer;
      const auto result = missions.run(GetParam().goal, truths, seed, observer);
      EXPECT_TRUE(result.mission.achieved && result.goal_is_true)
          << truths.front() << ", seed " << seed << ": " << result.mission.reason;
    }
  }
}

const std::string kLeak = "origin(old_town, heating, hiss) = ";

INSTANTIATE_TEST_SUITE_P(Domains, WholeMission,
                         testing::Values(Case{"office",
                                              "loc(tb1) = study_corner and not in_hand(rob1, tb1)",
                                              {{"loc(tb1) = main_library"}, {"loc(tb1) = office"}}},
                                         Case{"workbench",
                                              "resolved(hum)",
                                              {{"cause(hum) = psu"}, {"cause(hum) = amplifier"}}},
                                         Case{"waterworks",
                                              "mended(old_town, heating, hiss)",
                                              {{kLeak + "north_main", "kept(rubber_seal) = depot"},
                                               {kLeak + "south_main", "kept(rubber_seal) = depot"},
                                               {kLeak + "ring_main", "kept(rubber_seal) = van"}}},
                                         Case{"warehouse",
                                              "delivered(pallet1)",
                                              {{"stored(pallet1) = shelf_a", "blocked(a1)"},
                                               {"stored(pallet1) = shelf_b"},
                                               {"stored(pallet1) = shelf_c"}}}),
                         [](const auto& test_case) { return test_case.param.domain; });

TEST(Waterworks, ShutsTheWaterOffBeforeItMends)
{
  AbstractMissions missions(directory("waterworks"), config());
  Silent observer;
  static_cast<void>(missions.run("mended(old_town, heating, hiss)",
                                 {kLeak + "south_main", "kept(rubber_seal) = depot"}, 1, observer));
  for (const char* action : {"fetch", "listen", "shut", "mend"})
    EXPECT_EQ(observer.actions.count(action), 1U) << action;
}

/// All states that an action can lead to, by trying every choice.
std::vector<FluentValues> successors(const RuleInterpreter& laws, const FluentValues& state,
                                     const reasoner::Atom& action)
{
  std::vector<FluentValues> found;
  std::vector<std::size_t> choice;
  std::vector<std::size_t> arity;
  do
  {
    arity.clear();
    const auto next = [&](std::size_t count) {
      if (arity.size() == choice.size())
        choice.push_back(0);
      arity.push_back(count);
      return choice[arity.size() - 1];
    };
    const OutcomeChooser chooser{[&](const std::string&, const std::vector<std::string>& labels) {
      return next(labels.size());
                                 },
                                 next};
    try
    {
      found.push_back(laws.successor(state, action, chooser));
    }
    catch (const InvalidArgument&)  // effects against the constraints: not possible here
    {
    }
    choice.resize(arity.size());
    while (!choice.empty() && choice.back() + 1 == arity[choice.size() - 1])
      choice.pop_back();
    if (!choice.empty())
      ++choice.back();
  } while (!choice.empty());
  return found;
}

/// A domain with its laws as a plain interpreter reads them, and a source of chance.
class World
{
public:
  explicit World(const std::string& name)
    : missions_(directory(name), config())
    , models_(refinement::readModels(directory(name) + "/models.yaml", domain()))
    , high_laws_(domain().highLevel())
    , low_laws_(domain().description())
    , random_(17)
  {
  }

  [[nodiscard]] const refinement::LowLevelDomain& domain() const { return missions_.domain(); }
  [[nodiscard]] const refinement::Models& models() const { return models_; }
  [[nodiscard]] const RuleInterpreter& highLaws() const { return high_laws_; }
  [[nodiscard]] const RuleInterpreter& lowLaws() const { return low_laws_; }

  std::size_t below(std::size_t count)
  {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }

  /// A high-level state; booleans are false twice out of three times.
  FluentValues highState()
  {
    for (;;)
    {
      const FluentValues state = drawn(domain().highLevel(), [&](const reasoner::Atom& atom) {
        const auto* fluent = domain().highLevel().findFluent(atom.name);
        return fluent->value_sort
                   ? any(domain().highLevel().findSort(*fluent->value_sort)->elements)
                   : std::string(below(3) == 0 ? "true" : "false");
      });
      if (high_laws_.consistent(state))
        return state;
    }
  }

  /// A low-level state that a high-level one allows.
  FluentValues lowState(const FluentValues& coarse)
  {
    for (;;)
    {
      std::map<std::string, bool> some_part;
      const FluentValues state = drawn(domain().description(), [&](const reasoner::Atom& atom) {
        reasoner::Atom whole = atom;
        for (auto& argument : whole.arguments)
          argument.name = domain().coarse(argument.name);
        const auto held = coarse.find(reasoner::toString(whole));
        if (held == coarse.end())
          return std::string(below(2) == 0 ? "true" : "false");  // the low level's own
        if (held->second != "true" && held->second != "false")
          return any(domain().components(held->second));
        const bool is_part = reasoner::toString(whole) != reasoner::toString(atom);
        const bool value = held->second == "true" && (!is_part || below(2) == 0);
        some_part[held->first] = some_part[held->first] || value;
        return std::string(value ? "true" : "false");
      });
      const bool fits = std::all_of(some_part.begin(), some_part.end(), [&](const auto& part) {
        return part.second == (coarse.at(part.first) == "true");
      });
      if (fits && low_laws_.consistent(state))
        return state;
    }
  }

  std::vector<reasoner::Literal> literals(const FluentValues& state) const
  {
    std::vector<reasoner::Literal> result;
    for (const auto& [fluent, value] : state)
    {
      const std::string text = value == "true"    ? fluent
                               : value == "false" ? "-" + fluent
                                                  : fluent + " = " + value;
      result.push_back(reasoner::parseGroundLiteral(text, domain().highLevel()));
    }
    return result;
  }

  /// The high-level actions that a state allows and that change it.
  std::vector<reasoner::Atom> actions(const FluentValues& state) const
  {
    std::vector<reasoner::Atom> result;
    for (const auto& declared : domain().highLevel().actions)
    {
      for (const auto& atom :
           declared.exogenous ? std::vector<reasoner::Atom>{} : high_laws_.instances(declared))
      {
        if (high_laws_.executable(state, atom) &&
            successors(high_laws_, state, atom).front() != state)
          result.push_back(atom);
      }
    }
    return result;
  }

private:
  std::string any(const std::vector<std::string>& elements)
  {
    return elements[below(elements.size())];
  }

  FluentValues drawn(const reasoner::Description& description,
                     const std::function<std::string(const reasoner::Atom&)>& value) const
  {
    FluentValues state;
    for (const auto& fluent : description.fluents)
    {
      if (fluent.kind != reasoner::FluentKind::kInertial)
        continue;
      const RuleInterpreter& laws = &description == &domain().highLevel() ? high_laws_ : low_laws_;
      for (const auto& atom :
           laws.instances({fluent.name, fluent.argument_sorts, false, fluent.position}))
        state[reasoner::toString(atom)] = value(atom);
    }
    return state;
  }

  AbstractMissions missions_;
  refinement::Models models_;
  RuleInterpreter high_laws_;
  RuleInterpreter low_laws_;
  std::mt19937_64 random_;
};

class ZoomProperty : public testing::TestWithParam<const char*>
{
protected:
  static constexpr int kTransitions = 25;
};

bool keeps(const refinement::Zoom& zoom, const reasoner::Atom& atom)
{
  return std::all_of(atom.arguments.begin(), atom.arguments.end(), [&](const auto& argument) {
    return zoom.constants.count(argument.name) != 0;
  });
}

/// Relevant constants by the definition, from s1 and s2 alone: clauses 1 and 2.
std::set<std::string> changedConstants(const World& world, const FluentValues& before,
                                       const FluentValues& after, const reasoner::Atom& action)
{
  std::set<std::string> result;
  for (const auto& argument : action.arguments)
    result.insert(argument.name);
  for (const auto& literal : world.literals(before))
  {
    const std::string fluent = reasoner::toString(literal.atom);
    if (before.at(fluent) == after.at(fluent))
      continue;
    for (const auto& argument : literal.atom.arguments)
      result.insert(argument.name);
    result.insert(before.at(fluent));
    result.insert(after.at(fluent));
  }
  result.erase("true");
  result.erase("false");
  return result;
}

/// REBA, definition of the zoom: <s1(T), a, s2(T)> is a transition of D_H(T). A state with a value
/// that is not relevant has no projection there; `elsewhere` is KR3's answer to that.
TEST_P(ZoomProperty, TheRestrictedTransitionIsOneOfTheRestrictedHighLevel)
{
  World world(GetParam());
  int checked = 0;
  for (int i = 0; i < kTransitions; ++i)
  {
    const FluentValues before = world.highState();
    const auto actions = world.actions(before);
    if (actions.empty())
      continue;
    const reasoner::Atom action = actions[world.below(actions.size())];
    const FluentValues after = successors(world.highLaws(), before, action).front();
    const auto zoom = refinement::zoom(world.domain(), world.literals(before), action);
    std::set<std::string> relevant;
    for (const auto& constant : zoom.relevant)
    {
      relevant.insert(constant.name);
      EXPECT_FALSE(constant.reason.empty()) << constant.name;
    }
    for (const auto& constant : changedConstants(world, before, after, action))
      EXPECT_EQ(relevant.count(constant), 1U) << constant << " of " << zoom.action;

    const reasoner::TransitionSystem restricted(
        reasoner::restricted(world.domain().highLevel(), relevant));
    const auto find = [&](const FluentValues& state) {
      for (std::size_t s = 0; s < restricted.states().size(); ++s)
      {
        bool same = true;
        for (std::size_t f = 0; f < restricted.fluents().size() && same; ++f)
        {
          const auto& fluent = restricted.fluents()[f];
          const auto value = state.find(fluent.name);
          same =
              value == state.end() ||
              fluent.values[static_cast<std::size_t>(restricted.states()[s][f])] == value->second;
        }
        if (same)
          return s;
      }
      return restricted.states().size();
    };
    const std::size_t s1 = find(before);
    if (s1 == restricted.states().size())
      continue;
    ++checked;
    const auto& names = restricted.actions();
    const auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), zoom.action) -
                                                names.begin());
    ASSERT_LT(index, names.size()) << zoom.action;
    ASSERT_TRUE(restricted.executable(s1, index)) << zoom.action;
    const auto& next = restricted.successors(s1, index);
    EXPECT_TRUE(std::any_of(next.begin(), next.end(), [s2 = find(after)](const auto& successor) {
      return successor.state == s2;
    })) << zoom.action;
  }
  EXPECT_GT(checked, kTransitions / 4);
}

/// Nothing that matters is lost: from every low-level state that s1 allows, the actions of the zoom
/// lead in the POMDP exactly where they lead in the whole low level, seen through the zoom. An
/// action other than the high level's may be impossible for a reason that the zoom leaves out.
TEST_P(ZoomProperty, ZoomedPathsArePathsOfTheWholeLowLevel)
{
  World world(GetParam());
  int steps = 0;
  for (int i = 0; i < kTransitions / 3; ++i)
  {
    const FluentValues before = world.highState();
    const auto actions = world.actions(before);
    if (actions.empty())
      continue;
    const reasoner::Atom action = actions[world.below(actions.size())];
    const auto zoom = refinement::zoom(world.domain(), world.literals(before), action);
    refinement::InitialKnowledge knowledge;
    for (const auto& literal : zoom.start)
    {
      const std::string& value = literal.value.name;
      if (value != "true" && value != "false" && keeps(zoom, literal.atom))
        knowledge.coarse[reasoner::toString(literal.atom)] = {{value, 1.0}};
    }
    const auto task =
        refinement::generatePomdp(world.domain(), world.models(), zoom, knowledge, {});
    std::map<reasoner::State, std::size_t> index;
    for (std::size_t s = 0; s < task.boundaryState(); ++s)
      index[task.physicalState(s)] = s;
    const auto seen = [&](const FluentValues& state) {
      reasoner::State values;
      for (const auto& fluent : task.fluents())
      {
        auto at = std::find(fluent.values.begin(), fluent.values.end(), state.at(fluent.name));
        at = at == fluent.values.end()
                 ? std::find(fluent.values.begin(), fluent.values.end(), refinement::kElsewhere)
                 : at;
        values.push_back(static_cast<int>(at - fluent.values.begin()));
      }
      const auto found = index.find(values);
      return found == index.end() ? task.boundaryState() : found->second;
    };
    FluentValues state = world.lowState(before);
    for (int step = 0; step < 4; ++step)
    {
      const std::size_t s = seen(state);
      ASSERT_LT(s, task.boundaryState());
      std::vector<FluentValues> inside;
      for (std::size_t a = 0; a < task.finishAction(); ++a)
      {
        const auto atom =
            reasoner::parseGroundAction(task.actionText(a), world.domain().description());
        std::set<std::size_t> expected{s};
        if (world.lowLaws().executable(state, atom))
        {
          expected.clear();
          for (const auto& next : successors(world.lowLaws(), state, atom))
          {
            expected.insert(seen(next));
            if (seen(next) != task.boundaryState())
              inside.push_back(next);
          }
        }
        else if (atom.name != action.name)
        {
          continue;  // clause 3 keeps what the high-level action depends on, not what others do
        }
        std::set<std::size_t> found;
        for (const auto& entry : task.model().transitions(a, s))
          found.insert(entry.index);
        EXPECT_EQ(found, expected) << task.actionText(a) << " in " << task.model().stateName(s);
        ++steps;
      }
      if (inside.empty())
        break;
      state = inside[world.below(inside.size())];
    }
  }
  EXPECT_GT(steps, 30);
}

INSTANTIATE_TEST_SUITE_P(Domains, ZoomProperty,
                         testing::Values("office", "workbench", "waterworks"));

}  // namespace
}  // namespace kr3::executive
