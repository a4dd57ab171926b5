#include <numeric>

#include <kr3_pomdp/model.hpp>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::Domain;
using test::expectError;

/// A thing slides between shelves of two racks; a gauge reads on which shelf it is, and can err.
Domain racks(double right)
{
  LowLevelDomain low_level = test::composed(
      R"(
sorts
  rack = {near, far}.
  thing = {box}.
fluents
  inertial on(thing) : rack.
  inertial tagged(thing).
actions
  push(thing, rack).
  tag(thing).
axioms
  push(X, K) causes on(X) = K.
  tag(X) causes tagged(X).
  impossible tag(X) if on(X) = far.
)",
      "magnify rack into shelf by of_rack.\nactions\n  gauge(thing).\nobservations\n  gauge(X) "
      "observes on(X).\n"
      "  gauge(X) observes tagged(X).\n",
      gridMap({"near", "far"}, 3, 1.0));
  Models models = parseModels(R"(
actions:
  push(X, K): {cost: {base_s: 1.0, impossible_s: 2.0}}
  tag(X): {cost: {base_s: 1.0, impossible_s: 2.0}}
  gauge(X):
    observations:
      on: {true_positive: )" + std::to_string(right) +
                                  R"(, source: hand-written}
      tagged: exact
    cost: {base_s: 1.0, impossible_s: 2.0}
)",
                              "models.yaml", low_level.description());
  return {std::move(low_level), std::move(models)};
}

double told(const PomdpTask& task, const std::string& state, const std::string& observation)
{
  const pomdp::Model& model = task.model();
  for (const pomdp::SparseEntry& entry :
       model.observations(*model.findAction("gauge(box)"), *model.findState(state)))
  {
    if (model.observationName(entry.index) == observation)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

// Six shelves in the domain, three in the zoom: an error is any of the other five.
TEST(ValueSensor, ErrsByAnyValueOfTheWholeDomain)
{
  const PomdpTask task =
      racks(0.9).task("tag(box)", {"on(box) = near"}, {{}, {{"on(box)", {{"near", 0.5}}}}});
  const std::string at_c0 = "on(box)=near_c0,tagged(box)=false";
  EXPECT_NEAR(told(task, at_c0, "near_c0,false"), 0.9, 1e-12);
  EXPECT_NEAR(told(task, at_c0, "near_c1,false"), 0.02, 1e-12);
  EXPECT_NEAR(told(task, at_c0, "outside,false"), 0.06, 1e-12);
  const std::string elsewhere = "on(box)=elsewhere,tagged(box)=true";
  EXPECT_NEAR(told(task, elsewhere, "near_c1,true"), 0.02, 1e-12);
  EXPECT_NEAR(told(task, elsewhere, "outside,true"), 0.94, 1e-12);
  EXPECT_FALSE(task.model().findObservation("elsewhere,true"));  // no sensor says so
}

TEST(ValueSensor, SeesThatAThingIsOutsideWhenItIsExact)
{
  const PomdpTask task =
      racks(1.0).task("tag(box)", {"on(box) = near"}, {{}, {{"on(box)", {{"near", 0.5}}}}});
  EXPECT_NEAR(told(task, "on(box)=elsewhere,tagged(box)=false", "outside,false"), 1.0, 1e-12);
  EXPECT_NEAR(told(task, "on(box)=near_c2,tagged(box)=false", "near_c2,false"), 1.0, 1e-12);
}

TEST(PomdpTask, SaysWhatAnActionObservesAndWhereItCanBeDone)
{
  const PomdpTask task = test::office().task(
      "grasp(rob1, tb1)", {"loc(rob1) = main_library", "loc(tb1) = main_library"},
      {{{"loc(rob1)", {{"main_library_c0", 1.0}}}}, {{"loc(tb1)", {{"main_library", 0.8}}}}});
  const pomdp::Model& model = task.model();
  const std::size_t search = *model.findAction("search(rob1,main_library_c0,tb1)");
  EXPECT_EQ(task.observedFluents(search), std::vector<std::string>{"loc(tb1)"});
  EXPECT_TRUE(task.observedFluents(task.finishAction()).empty());
  const auto at = [&](const std::string& cell) {
    return *model.findState("loc(rob1)=main_library_" + cell +
                            ",loc(tb1)=elsewhere,in_hand(rob1,tb1)=false");
  };
  EXPECT_TRUE(task.isExecutable(search, at("c0")));
  EXPECT_FALSE(task.isExecutable(search, at("c1")));
  EXPECT_FALSE(task.isExecutable(search, task.boundaryState()));
  EXPECT_TRUE(task.isExecutable(task.finishAction(), task.boundaryState()));
  EXPECT_FALSE(task.isExecutable(task.finishAction(), task.doneState()));
}

TEST(GeneratePomdp, ChecksModelsThatNoFileGave)
{
  Domain office = test::office();
  const auto task = [&] {
    (void)office.task("grasp(rob1, tb1)", {"loc(rob1) = main_library", "loc(tb1) = main_library"},
                      {});
  };
  office.models.actions.at("grasp").outcomes.probabilities["failed"] = 0.3;
  expectError(ErrorCode::kInvalidArgument, "outcomes of 'grasp' sum to 1.2", task);
  office.models.actions.erase("grasp");
  expectError(ErrorCode::kInvalidArgument, "no numbers for the action 'grasp'", task);
}

}  // namespace
}  // namespace kr3::refinement
