// What a task makes of values that its zoom does not have.

#include "kr3_executive/low_level_task.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace kr3::executive
{
namespace
{

using refinement::kElsewhere;
using refinement::LowLevelDomain;

/// A gauge reads the shelf of a box, right with some probability.
struct Gauge
{
  explicit Gauge(const std::string& right)
    : high(reasoner::parseDescription(R"(
sorts
  rack = {near, far}.
  thing = {box}.
fluents
  inertial on(thing) : rack.
  inertial tagged(thing).
actions
  tag(thing).
axioms
  tag(X) causes tagged(X).
  impossible tag(X) if on(X) = far.
)",
                                      "domain.kr3"))
    , domain(high,
             reasoner::parseRefinement(R"(
magnify rack into shelf by of_rack.
actions
  gauge(thing).
observations
  gauge(X) observes on(X).
  gauge(X) observes tagged(X).
)",
                                       "refinement.kr3", high),
             refinement::gridMap({"near", "far"}, 3, 1.0))
    , models(refinement::parseModels(R"(
actions:
  tag(X): {cost: {base_s: 1.0, impossible_s: 2.0}}
  gauge(X):
    observations: {on: )" + right + R"(, tagged: exact}
    cost: {base_s: 1.0, impossible_s: 2.0}
)",
                                     "models.yaml", domain.description()))
  {
    knowledge.coarse["on(box)"] = {{"near", 0.5}};
  }

  [[nodiscard]] LowLevelTask task() const
  {
    const auto zoom = refinement::zoom(
        domain, {reasoner::parseGroundLiteral("on(box) = near", domain.highLevel())},
        reasoner::parseGroundAction("tag(box)", domain.highLevel()));
    return {domain,
            std::make_shared<const refinement::PomdpTask>(
                refinement::generatePomdp(domain, models, zoom, knowledge)),
            knowledge};
  }

  reasoner::Description high;
  LowLevelDomain domain;
  refinement::Models models;
  refinement::InitialKnowledge knowledge;
};

std::size_t gauge(const LowLevelTask& task)
{
  return task.pomdp().model().findAction("gauge(box)").value();
}

double elsewhere(const LowLevelTask& task)
{
  return task.pomdp().fineMarginal(task.belief(), "on(box)").at(kElsewhere);
}

// Six shelves: three outside are told with 3 * 0.02 of a box inside, three inside with as much of
// one elsewhere.
TEST(LowLevelTask, TakesAValueOutsideTheZoomAsPerhapsAnError)
{
  const Gauge domain("{true_positive: 0.9, source: hand-written}");
  LowLevelTask task = domain.task();
  EXPECT_TRUE(task.update(gauge(task), {"far_c1", "false"}));
  EXPECT_NEAR(elsewhere(task), 0.94 / (0.94 + 0.06), 1e-9);
  LowLevelMemory memory;
  task.remember(memory);
  EXPECT_EQ(memory.at("on(box)").values.count("far_c1"), 0U);  // it is in doubt
  EXPECT_NEAR(memory.at("on(box)").values.at(kElsewhere), 0.94, 1e-9);

  EXPECT_TRUE(task.update(gauge(task), {"near_c1", "false"}));
  EXPECT_NEAR(elsewhere(task), 0.94 * 0.02 / (0.94 * 0.02 + 0.06 / 3.0 * (0.9 + 2.0 * 0.02)), 1e-9);
}

// Nor is there doubt where the box can be: what is told must be an error, if the sensor errs.
TEST(LowLevelTask, TakesAValueOutsideTheZoomAsAnErrorWhereThereIsNoElsewhere)
{
  Gauge domain("{true_positive: 0.9, source: hand-written}");
  domain.knowledge = {{{"on(box)", {{"near_c0", 0.5}, {"near_c1", 0.5}}}}, {}};
  LowLevelTask task = domain.task();
  EXPECT_TRUE(task.update(gauge(task), {"far_c1", "false"}));
  EXPECT_NEAR(task.pomdp().fineMarginal(task.belief(), "on(box)").at("near_c0"), 0.5, 1e-9);
  EXPECT_EQ(task.observed().count("on(box)"), 0U);
  LowLevelMemory memory;
  task.remember(memory);
  EXPECT_EQ(memory.at("on(box)").values.count("far_c1"), 0U);
}

// A sensor that cannot err has told where the box is: the zoom has no place for it.
TEST(LowLevelTask, ReportsAValueThatIsOutsideTheZoomWithoutDoubt)
{
  Gauge domain("exact");
  domain.knowledge = {{{"on(box)", {{"near_c0", 0.5}, {"near_c1", 0.5}}}}, {}};
  LowLevelTask task = domain.task();
  EXPECT_FALSE(task.update(gauge(task), {"far_c1", "false"}));
  EXPECT_EQ(task.observed().at("on(box)"), "far_c1");
  LowLevelMemory memory;
  task.remember(memory);
  EXPECT_EQ(memory.at("on(box)").values.at("far_c1"), 1.0);
}

}  // namespace
}  // namespace kr3::executive
