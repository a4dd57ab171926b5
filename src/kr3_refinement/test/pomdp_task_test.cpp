#include "kr3_refinement/pomdp_task.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include <kr3_pomdp/pomdp_format.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using Names = std::vector<std::string>;
using test::Domain;
using test::expectError;
using StateKind = PomdpTask::StateKind;

const Names kInLibrary{"loc(rob1) = main_library", "loc(tb1) = main_library"};

InitialKnowledge searching(double here)
{
  return {{{"loc(rob1)", {{"main_library_c0", 1.0}}}}, {{"loc(tb1)", {{"main_library", here}}}}};
}

PomdpTask graspTask(double here = 0.8)
{
  return test::office().task("grasp(rob1, tb1)", kInLibrary, searching(here));
}

double transition(const PomdpTask& task, const std::string& action, const std::string& from,
                  const std::string& to)
{
  const pomdp::Model& model = task.model();
  double result = 0.0;
  for (const pomdp::SparseEntry& entry :
       model.transitions(*model.findAction(action), *model.findState(from)))
  {
    result += entry.index == *model.findState(to) ? entry.probability : 0.0;
  }
  return result;
}

double observation(const PomdpTask& task, const std::string& action, const std::string& state,
                   const std::string& seen)
{
  const pomdp::Model& model = task.model();
  double result = 0.0;
  for (const pomdp::SparseEntry& entry :
       model.observations(*model.findAction(action), *model.findState(state)))
  {
    result += entry.index == *model.findObservation(seen) ? entry.probability : 0.0;
  }
  return result;
}

double reward(const PomdpTask& task, const std::string& action, const std::string& state)
{
  return task.model().reward(*task.model().findAction(action), *task.model().findState(state));
}

std::string state(const std::string& robot, const std::string& object,
                  const std::string& held = "false")
{
  return "loc(rob1)=main_library_" + robot +
         ",loc(tb1)=" + (object == kElsewhere ? object : "main_library_" + object) +
         ",in_hand(rob1,tb1)=" + held;
}

TEST(GraspTask, HasTheStatesOfARoomSearch)
{
  const PomdpTask task = graspTask();
  EXPECT_EQ(task.model().numStates(),
            4U * (5U + 1U) + 2U);  // in hand: the book is where the robot is
  EXPECT_EQ(task.model().numActions(), 4U + 4U + 1U + 1U + 1U);
  EXPECT_EQ(task.actionText(task.finishAction()), "finish");
  EXPECT_EQ(task.kind(task.boundaryState()), StateKind::kBoundary);
  EXPECT_EQ(task.kind(task.doneState()), StateKind::kDone);
  EXPECT_EQ(task.fluents().size(), 3U);
  EXPECT_EQ(task.fluents()[1].values.back(), kElsewhere);
  const std::size_t search = *task.model().findAction("search(rob1,main_library_c1,tb1)");
  EXPECT_EQ(task.actionSymbol(search), "search");
  EXPECT_EQ(task.actionText(search), "search(rob1, main_library_c1, tb1)");
  EXPECT_EQ(task.actionArguments(search), (Names{"rob1", "main_library_c1", "tb1"}));
}

// The numbers of domains/office/models.yaml, worked out by hand.
TEST(GraspTask, HasTheModelsNumbers)
{
  const PomdpTask task = graspTask();
  EXPECT_NEAR(transition(task, "move(rob1,main_library_c3)", state("c0", "c2"), state("c3", "c2")),
              0.95, 1e-12);
  EXPECT_NEAR(transition(task, "move(rob1,main_library_c3)", state("c0", "c2"), state("c1", "c2")),
              0.025, 1e-12);
  EXPECT_NEAR(reward(task, "move(rob1,main_library_c3)", state("c0", "c2")), -(1.0 + 2.0 * 2.0),
              1e-12);
  EXPECT_NEAR(observation(task, "move(rob1,main_library_c3)", state("c1", "c2"), "main_library_c1"),
              1.0, 1e-12);
  EXPECT_NEAR(transition(task, "grasp(rob1,tb1)", state("c2", "c2"), state("c2", "c2", "true")),
              0.9, 1e-12);
  EXPECT_NEAR(transition(task, "grasp(rob1,tb1)", state("c2", "c2"), state("c2", "c2")), 0.1,
              1e-12);
  EXPECT_NEAR(observation(task, "grasp(rob1,tb1)", state("c2", "c2"), "false"), 1.0, 1e-12);
  EXPECT_NEAR(observation(task, "search(rob1,main_library_c2,tb1)", state("c2", "c2"), "true"), 0.9,
              1e-12);
  EXPECT_NEAR(observation(task, "search(rob1,main_library_c2,tb1)", state("c2", "c1"), "true"),
              0.05, 1e-12);
  EXPECT_NEAR(
      observation(task, "search(rob1,main_library_c2,tb1)", state("c2", kElsewhere), "true"), 0.05,
      1e-12);
  EXPECT_NEAR(reward(task, "finish", state("c1", "c1", "true")), 100.0, 1e-12);
  EXPECT_NEAR(reward(task, "finish", state("c1", kElsewhere)), 20.0, 1e-12);
  EXPECT_NEAR(reward(task, "finish", state("c1", "c2")), -100.0, 1e-12);
}

TEST(GraspTask, ImpossibleActionsChangeAndTellNothing)
{
  const PomdpTask task = graspTask();
  for (const std::string& object : {std::string("c2"), kElsewhere})
  {
    EXPECT_NEAR(transition(task, "grasp(rob1,tb1)", state("c0", object), state("c0", object)), 1.0,
                1e-12);
    EXPECT_NEAR(reward(task, "grasp(rob1,tb1)", state("c0", object)), -12.0, 1e-12);
    // Looking into a cell from another one.
    EXPECT_NEAR(observation(task, "search(rob1,main_library_c2,tb1)", state("c0", object), "true"),
                0.05, 1e-12);
  }
}

TEST(GraspTask, CarriesAlongWhatIsHeld)
{
  const PomdpTask task = graspTask();
  EXPECT_NEAR(transition(task, "move(rob1,main_library_c1)", state("c0", "c0", "true"),
                         state("c1", "c1", "true")),
              0.95, 1e-12);
}

TEST(GraspTask, StartsFromTheKnowledge)
{
  const PomdpTask task = graspTask(0.8);
  const pomdp::Belief& start = task.model().initialBelief();
  EXPECT_NEAR(start[*task.model().findState(state("c0", "c3"))], 0.2, 1e-12);
  EXPECT_NEAR(task.coarseMarginal(start, "loc(tb1)").at("main_library"), 0.8, 1e-12);
  EXPECT_NEAR(task.coarseMarginal(start, "loc(tb1)").at(kElsewhere), 0.2, 1e-12);
  EXPECT_NEAR(task.fineMarginal(start, "loc(tb1)").at("main_library_c1"), 0.2, 1e-12);
  EXPECT_NEAR(task.coarseMarginal(start, "in_hand(rob1,tb1)").at("false"), 1.0, 1e-12);
  EXPECT_NEAR(task.successProbability(start), 0.0, 1e-12);
  EXPECT_NEAR(task.hopelessProbability(start), 0.2, 1e-12);
  EXPECT_EQ(task.summary(start).find("loc(rob1) = main_library_c0; loc(tb1): "), 0U)
      << task.summary(start);
  EXPECT_EQ(task.coarseFluents(), (Names{"in_hand(rob1, tb1)", "loc(rob1)", "loc(tb1)"}));
}

TEST(GraspTask, PutsOtherPlacesElsewhere)
{
  const Domain office = test::office();
  const PomdpTask task = office.task("grasp(rob1, tb1)", kInLibrary,
                                     {{{"loc(rob1)", {{"main_library_c0", 1.0}}}},
                                      {{"loc(tb1)", {{"main_library", 0.5}, {"office", 0.3}}}}});
  EXPECT_NEAR(task.coarseMarginal(task.model().initialBelief(), "loc(tb1)").at(kElsewhere), 0.5,
              1e-12);
  const PomdpTask again =
      office.task("grasp(rob1, tb1)", kInLibrary,
                  {{{"loc(rob1)", {{"main_library_c0", 1.0}}},
                    {"loc(tb1)", {{"main_library_c1", 0.6}, {"office_c0", 0.4}}}},
                   {}});
  EXPECT_NEAR(again.fineMarginal(again.model().initialBelief(), "loc(tb1)").at(kElsewhere), 0.4,
              1e-12);
}

TEST(GraspTask, CanBeWrittenAndReadBack)
{
  const PomdpTask task = graspTask();
  std::stringstream text;
  pomdp::writePomdp(text, task.model());
  const pomdp::Model model = pomdp::readPomdp(text, "grasp.pomdp");
  EXPECT_EQ(model.numStates(), task.model().numStates());
  EXPECT_EQ(model.actionName(0), task.model().actionName(0));
}

TEST(GraspTask, IsSolvedAndEndsWell)
{
  const PomdpTask task = graspTask(0.8);
  pomdp::SolverLimits limits;
  limits.max_backups = 3000;
  const pomdp::Policy policy = pomdp::solve(task.model(), limits).policy;
  std::mt19937_64 random(7);
  constexpr int kTrials = 1000;
  int right = 0;
  int absent = 0;
  int absent_given_up = 0;
  for (int trial = 0; trial < kTrials; ++trial)
  {
    pomdp::Belief belief = task.model().initialBelief();
    std::size_t now = pomdp::sampleState(belief, random);
    const bool is_absent = task.isHopeless(now);
    absent += is_absent ? 1 : 0;
    for (int step = 0; step < 500; ++step)
    {
      const std::size_t action = policy.actionAt(belief);
      if (action == task.finishAction())
      {
        right += (is_absent ? task.isHopeless(now) : task.isSuccess(now)) ? 1 : 0;
        absent_given_up += is_absent ? 1 : 0;
        break;
      }
      const pomdp::SampledStep next = pomdp::sampleStep(task.model(), now, action, random);
      belief = pomdp::updated(task.model(), belief, action, next.observation).posterior;
      now = next.next_state;
    }
  }
  EXPECT_GE(right, kTrials * 95 / 100);
  EXPECT_EQ(absent_given_up, absent);
}

TEST(MoveTask, IsOverWhenTheRobotIsInTheRoom)
{
  const PomdpTask task = test::office().task("move(rob1, kitchen)", {"loc(rob1) = office"}, {});
  EXPECT_EQ(task.model().numStates(), 8U + 2U);
  const pomdp::Belief& start = task.model().initialBelief();
  EXPECT_NEAR(task.fineMarginal(start, "loc(rob1)").at("office_c3"), 0.25, 1e-12);
  std::size_t successes = 0;
  for (std::size_t i = 0; i < task.model().numStates(); ++i)
  {
    successes += task.isSuccess(i) ? 1 : 0;
  }
  EXPECT_EQ(successes, 4U);
}

TEST(MoveTask, GoesToTheBoundaryWhenItLeavesTheZoom)
{
  ComponentMapData data;
  for (const char* place :
       {"office", "main_library", "aux_library", "kitchen", "study_corner", "corridor"})
  {
    data.components.push_back({std::string(place) + "_c0", place});
  }
  data.neighbors = {{3, 5}, {}, {}, {0}, {}, {0}};
  const Domain office = test::domainOf("office", ComponentMap(data));
  const PomdpTask task = office.task("move(rob1, office)", {"loc(rob1) = kitchen"}, {});
  const std::string move = "move(rob1,office_c0)";
  EXPECT_NEAR(transition(task, move, "loc(rob1)=kitchen_c0", "loc(rob1)=office_c0"), 0.95, 1e-12);
  EXPECT_NEAR(transition(task, move, "loc(rob1)=kitchen_c0", "loc(rob1)=kitchen_c0"), 0.025, 1e-12);
  EXPECT_NEAR(transition(task, move, "loc(rob1)=kitchen_c0", "boundary"), 0.025, 1e-12);
  EXPECT_NEAR(observation(task, move, "boundary", "outside"), 1.0, 1e-12);
  EXPECT_TRUE(task.isHopeless(task.boundaryState()));
}

TEST(PutdownTask, HasNoPlaces)
{
  const PomdpTask task = test::office().task(
      "putdown(rob1, tb1)", {"loc(rob1) = office", "loc(tb1) = office", "in_hand(rob1, tb1)"}, {});
  EXPECT_EQ(task.model().numStates(), 2U + 2U);
  EXPECT_NEAR(
      transition(task, "putdown(rob1,tb1)", "in_hand(rob1,tb1)=true", "in_hand(rob1,tb1)=false"),
      1.0, 1e-12);
}

TEST(WorkbenchTask, FindsTheFaultyModule)
{
  const Domain workbench = test::workbench();
  const PomdpTask task =
      workbench.task("replace(tech1, psu, hum)", {"opened(psu)", "cause(hum) = psu"},
                     {{}, {{"cause(hum)", {{"psu", 0.6}, {"amplifier", 0.3}}}}});
  EXPECT_EQ(task.model().numStates(), 4U * 8U * 2U + 2U);  // cause, three covers, resolved
  const pomdp::Belief& start = task.model().initialBelief();
  EXPECT_NEAR(task.coarseMarginal(start, "cause(hum)").at(kElsewhere), 0.4, 1e-12);
  EXPECT_NEAR(task.coarseMarginal(start, "opened(psu)").at("true"), 1.0, 1e-12);
  EXPECT_NEAR(task.fineMarginal(start, "opened(rectifier)").at("true"), 4.0 / 7.0,
              1e-12);  // some cover is open
  EXPECT_NEAR(task.hopelessProbability(start), 0.4, 1e-12);
}

TEST(EveryTask, IsAProbabilityModel)
{
  const Domain office = test::office(9);
  const Domain workbench = test::workbench();
  const std::vector<PomdpTask> tasks{
      office.task("move(rob1, kitchen)",
                  {"loc(rob1) = office", "loc(mug1) = office", "in_hand(rob1, mug1)"}, {}),
      office.task("grasp(rob1, tb1)", kInLibrary, {{}, {{"loc(tb1)", {{"main_library", 0.7}}}}}),
      workbench.task("unscrew(tech1, tuner)", {"cause(hum) = psu"}, {})};
  for (const PomdpTask& task : tasks)
  {
    const pomdp::Model& model = task.model();
    for (std::size_t action = 0; action < model.numActions(); ++action)
    {
      std::set<std::size_t> given;
      for (std::size_t i = 0; i < model.numStates(); ++i)
      {
        double to = 0.0;
        double seen = 0.0;
        for (const pomdp::SparseEntry& entry : model.transitions(action, i))
        {
          to += entry.probability;
        }
        for (const pomdp::SparseEntry& entry : model.observations(action, i))
        {
          seen += entry.probability;
          given.insert(entry.index);
        }
        EXPECT_NEAR(to, 1.0, 1e-9);
        EXPECT_NEAR(seen, 1.0, 1e-9);
        EXPECT_LE(model.reward(action, i), action == task.finishAction() ? 1e9 : 0.0);
      }
      for (const std::size_t listed : task.observationsOf(action))
      {
        EXPECT_EQ(given.count(listed), 1U);
      }
    }
  }
}

/// Laws whose heads have variables that stand nowhere else: they hold for all things of the sort.
Domain sweeping()
{
  LowLevelDomain low_level = test::composed(
      R"(
sorts
  tray = {left, right}.
  item = {a, b}.
fluents
  inertial on(item) : tray.
  inertial clean(item).
actions
  sweep(tray).
  soil(item).
axioms
  sweep(T) causes on(X) = T.
  sweep(T) causes clean(X) if on(b) = T.
  soil(X) causes -clean(X).
  -clean(X) if on(a) = right, on(b) = left.
)",
      "magnify tray into slot by of_tray.\n", gridMap({"left", "right"}, 2, 1.0));
  Models models = parseModels(R"(
actions:
  sweep(T): {cost: {base_s: 1.0, impossible_s: 2.0}}
  soil(X): {cost: {base_s: 1.0, impossible_s: 2.0}}
)",
                              "models.yaml", low_level.description());
  return {std::move(low_level), std::move(models)};
}

// The other implementation of the same semantics, by answer sets, is the oracle.
TEST(EveryTask, HasTheTransitionsOfTheActionLanguage)
{
  struct Case
  {
    Domain domain;
    std::string action;
    Names state;
  };
  const std::vector<Case> cases{
      {test::office(), "grasp(rob1, tb1)", kInLibrary},
      {test::office(),
       "move(rob1, kitchen)",
       {"loc(rob1) = office", "loc(mug1) = office", "in_hand(rob1, mug1)"}},
      {test::workbench(), "unscrew(tech1, tuner)", {}},
      {sweeping(), "sweep(left)", {"on(a) = right", "on(b) = left"}}};
  for (const Case& c : cases)
  {
    const PomdpTask task = c.domain.task(c.action, c.state, {});
    const reasoner::TransitionSystem oracle(zoomedDescription(c.domain.low_level, task.zoom()));
    const auto project = [&](const reasoner::State& values) {
      std::map<std::string, std::string> result;
      for (std::size_t i = 0; i < values.size(); ++i)
      {
        const reasoner::GroundFluent& fluent = oracle.fluents()[i];
        if (fluent.kind == reasoner::FluentKind::kInertial)
        {
          result[fluent.name] = fluent.values[static_cast<std::size_t>(values[i])];
        }
      }
      return result;
    };
    using Projected = std::map<std::string, std::string>;
    std::map<Projected, std::size_t> index;
    for (std::size_t i = 0; i < task.boundaryState(); ++i)
    {
      Projected projected;
      for (std::size_t f = 0; f < task.fluents().size(); ++f)
      {
        projected[task.fluents()[f].name] =
            task.fluents()[f].values[static_cast<std::size_t>(task.physicalState(i)[f])];
      }
      index[projected] = i;
    }
    std::set<Projected> seen;
    for (std::size_t s = 0; s < oracle.states().size(); ++s)
    {
      const Projected from = project(oracle.states()[s]);
      seen.insert(from);
      ASSERT_EQ(index.count(from), 1U);
      for (std::size_t a = 0; a < oracle.actions().size(); ++a)
      {
        std::string name = oracle.actions()[a];
        name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
        std::set<std::size_t> expected;
        for (const auto& successor : oracle.successors(s, a))
        {
          expected.insert(index.at(project(oracle.states()[successor.state])));
        }
        if (!oracle.executable(s, a))
        {
          expected = {index.at(from)};
        }
        std::set<std::size_t> found;
        for (const pomdp::SparseEntry& entry :
             task.model().transitions(*task.model().findAction(name), index.at(from)))
        {
          found.insert(entry.index);
        }
        EXPECT_EQ(found, expected) << name;
      }
    }
    EXPECT_EQ(seen.size(), index.size());
  }
}

TEST(FlatTask, IsTheSameGenerator)
{
  const Domain office = test::domainOf("office", gridMap({"office", "main_library", "aux_library",
                                                          "kitchen", "study_corner", "corridor"},
                                                         1, 1.0));
  std::set<std::string> constants{"rob1", "tb1"};
  for (const Component& component : office.low_level.map().components())
  {
    constants.insert(component.part_of);
  }
  const reasoner::Description high_level =
      reasoner::restricted(office.low_level.highLevel(), constants);
  const LowLevelDomain domain = test::composed(
      toString(high_level), test::textOf(test::domainFile("office", "refinement.kr3")),
      office.low_level.map());
  const auto literal = [&](const std::string& text) {
    return reasoner::parseGroundLiteral(text, domain.highLevel());
  };
  const Zoom zoom =
      wholeDomain(domain, {literal("loc(rob1) = office")}, {literal("in_hand(rob1, tb1)")});
  Distribution anywhere;
  for (const Component& component : domain.map().components())
  {
    anywhere[component.part_of] = 1.0 / static_cast<double>(domain.map().size());
  }
  const PomdpTask task = generatePomdp(domain, office.models, zoom, {{}, {{"loc(tb1)", anywhere}}});
  EXPECT_EQ(task.model().numStates(), 6U * (7U + 1U) + 2U);
  EXPECT_NEAR(task.coarseMarginal(task.model().initialBelief(), "loc(tb1)").at("kitchen"),
              1.0 / 6.0, 1e-12);
}

TEST(GeneratePomdp, SaysWhatIsWrong)
{
  const Domain office = test::office();
  const auto rejects =
      [&](ErrorCode code, const std::string& part, const InitialKnowledge& knowledge) {
    expectError(code, part, [&] { (void)office.task("grasp(rob1, tb1)", kInLibrary, knowledge); });
  };
  rejects(ErrorCode::kInvalidArgument, "'lco(tb1)': no such fluent on the low level",
          {{{"lco(tb1)", {{"x", 1.0}}}}, {}});
  rejects(ErrorCode::kInvalidArgument, "'lco(tb1)': no such fluent on the high level",
          {{}, {{"lco(tb1)", {{"x", 1.0}}}}});
  rejects(ErrorCode::kInvalidArgument, "sum to 0.5",
          {{{"loc(rob1)", {{"main_library_c0", 0.5}}}}, {}});
  rejects(ErrorCode::kInvalidArgument, "sum to 1.2",
          {{}, {{"loc(tb1)", {{"main_library", 0.7}, {"office", 0.5}}}}});
  rejects(ErrorCode::kInvalidArgument, "probability -0.1",
          {{}, {{"loc(tb1)", {{"main_library", -0.1}}}}});
  rejects(ErrorCode::kFailedPrecondition, "fits the initial knowledge",
          {{{"loc(rob1)", {{"main_library_c0", 1.0}}},
            {"loc(tb1)", {{"main_library_c1", 1.0}}},
            {"in_hand(rob1, tb1)", {{"true", 1.0}}}},
           {}});
  const Zoom zoom = office.zoomOn("grasp(rob1, tb1)", kInLibrary);
  expectError(ErrorCode::kResourceExhausted, "more than 10 states",
              [&] { (void)generatePomdp(office.low_level, office.models, zoom, {}, {10}); });
  expectError(ErrorCode::kResourceExhausted,
              "2 of loc with 4 values each, 1 of in_hand with 2 values",
              [&] { (void)generatePomdp(office.low_level, office.models, zoom, {}, {10}); });
  const PomdpTask task = graspTask();
  expectError(ErrorCode::kNotFound, "no low-level fluent 'loc(tb9)'",
              [&] { (void)task.fineMarginal(task.model().initialBelief(), "loc(tb9)"); });
  std::vector<double> done(task.model().numStates(), 0.0);
  done.back() = 1.0;
  expectError(ErrorCode::kFailedPrecondition, "finished",
              [&] { (void)task.coarseMarginal(pomdp::Belief(done), "loc(tb1)"); });
}

}  // namespace
}  // namespace kr3::refinement
