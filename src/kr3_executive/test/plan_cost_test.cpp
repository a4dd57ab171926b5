// Expected costs of plans: single efforts with known answers, orders against the formula.

#include "kr3_executive/plan_cost.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_refinement/component_map.hpp>
#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/domain_files.hpp"

namespace kr3::executive
{
namespace
{

constexpr double kThreshold = 0.85;
constexpr double kEven = 0.5;

/// Components on a line, 2 m apart within a whole; `begin_m` says where each whole begins.
struct Whole
{
  std::string name;
  std::size_t components = 1;
  double begin_m = 0.0;
};

refinement::ComponentMap onALine(const std::vector<Whole>& wholes)
{
  refinement::ComponentMapData data;
  std::vector<double> at_m;
  for (const auto& whole : wholes)
  {
    for (std::size_t i = 0; i < whole.components; ++i)
    {
      data.components.push_back({whole.name + "_c" + std::to_string(i), whole.name});
      at_m.push_back(whole.begin_m + 2.0 * static_cast<double>(i));
    }
  }
  const std::size_t n = at_m.size();
  data.neighbors.resize(n);
  for (std::size_t a = 0; a < n; ++a)
  {
    for (std::size_t b = 0; b < n; ++b)
    {
      data.distances_m.push_back(std::abs(at_m[a] - at_m[b]));
      if (a != b && data.components[a].part_of == data.components[b].part_of &&
          data.distances_m.back() < 2.5)
        data.neighbors[a].push_back(b);
    }
  }
  return refinement::ComponentMap(std::move(data));
}

struct Setting
{
  Setting(const std::string& name, const std::vector<Whole>& wholes)
  {
    const std::string path = std::string(KR3_DOMAINS_DIR) + "/" + name;
    LoadedDomain loaded =
        load(readDomainFiles(path + "/domain.kr3", path + "/refinement.kr3", path + "/models.yaml",
                             path + "/bindings.yaml", onALine(wholes)));
    domain = std::move(loaded.domain);
    models = std::move(loaded.models);
    costs = std::make_unique<PlanCosts>(std::make_shared<TaskCache>(*domain, models));
  }

  [[nodiscard]] std::vector<reasoner::Literal> state(const std::vector<std::string>& texts) const
  {
    std::vector<reasoner::Literal> literals;
    for (const auto& text : texts)
      literals.push_back(reasoner::parseGroundLiteral(text, domain->highLevel()));
    return literals;
  }
  Effort effort(const std::vector<std::string>& holds, const std::string& action,
                const std::vector<std::string>& assumed = {}, double prior = kEven) const
  {
    std::vector<std::string> all = holds;
    all.insert(all.end(), assumed.begin(), assumed.end());
    return costs->effort(state(all), action, assumed, kThreshold, prior);
  }

  std::unique_ptr<refinement::LowLevelDomain> domain;
  refinement::Models models;
  std::unique_ptr<PlanCosts> costs;
};

/// The office with a large room near by and a small one far away.
Setting office()
{
  return {"office",
          {{"office", 1, 40.0},
           {"kitchen", 12, 42.0},
           {"corridor", 1, 20.0},
           {"study_corner", 1, 30.0},
           {"main_library", 2, 80.0},
           {"aux_library", 1, 90.0}}};
}

TEST(PlanCosts, AnActionWithoutChanceTakesItsTime)
{
  const Setting setting = office();
  EXPECT_NEAR(setting
                  .effort({"loc(rob1) = corridor", "loc(tb1) = corridor", "in_hand(rob1, tb1)"},
                          "putdown(rob1, tb1)")
                  .success_s,
              3.0, 1e-6);
}

TEST(PlanCosts, AFailureIsTriedAgain)
{
  const Setting setting = office();  // 4 s, succeeds with 0.9
  const Effort effort =
      setting.effort({"loc(rob1) = corridor", "loc(tb1) = corridor"}, "grasp(rob1, tb1)");
  EXPECT_NEAR(effort.success_s, 4.0 / 0.9, 1e-2);
  EXPECT_FALSE(effort.checks);
}

TEST(PlanCosts, ALookThroughOneComponentIsOneLook)
{
  const Setting setting = office();  // 2 s a look, 0.90 and 0.05: one miss refutes at even odds
  const Effort effort =
      setting.effort({"loc(rob1) = corridor"}, "grasp(rob1, tb1)", {"loc(tb1) = corridor"});
  EXPECT_TRUE(effort.checks);
  EXPECT_NEAR(effort.failure_s, 2.0, 1e-6);
  // Seen at once, one look is enough (0.947); seen late, the pass is repeated; then the grasp.
  EXPECT_NEAR(effort.success_s, 2.0 + (1.0 / 0.9 - 1.0) * 2.0 + 4.0 / 0.9, 1e-2);
}

TEST(PlanCosts, MoreDoubtNeedsFewerPasses)
{
  const Setting setting = office();
  const auto failure = [&](double prior) {
    return setting
        .effort({"loc(rob1) = corridor"}, "grasp(rob1, tb1)", {"loc(tb1) = corridor"}, prior)
        .failure_s;
  };
  // Posterior odds after r misses: (0.1 / 0.95)^r p / (1 - p), to be below 0.15 / 0.85.
  EXPECT_NEAR(failure(0.3), 2.0, 1e-6);
  EXPECT_NEAR(failure(0.85), 4.0, 1e-6);
  EXPECT_NEAR(failure(0.99), 6.0, 1e-6);
}

TEST(PlanCosts, ATourDrivesFromComponentToComponent)
{
  const Setting setting = office();
  const Effort effort =
      setting.effort({"loc(rob1) = main_library"}, "grasp(rob1, tb1)", {"loc(tb1) = main_library"});
  // Two looks and one drive of 2 m, 1 + 2 * 2 s, which slips with 0.05 to where it came from.
  EXPECT_NEAR(effort.failure_s, 2.0 + 5.0 / 0.95 + 2.0, 1e-2);
}

TEST(PlanCosts, WhereLookingIsCheaperWinsThoughTheWayIsLonger)
{
  const Setting setting = office();
  const auto plan = [](const std::string& place) {
    return reasoner::Plan{{"loc(tb1) = " + place},
                          {{"move(rob1, " + place + ")"},
                           {"grasp(rob1, tb1)"},
                           {"move(rob1, study_corner)"},
                           {"putdown(rob1, tb1)"}}};
  };
  const auto start = setting.state({"loc(rob1) = office"});
  const std::vector<WeightedPlan> plans{{plan("kitchen"), 0.5}, {plan("corridor"), 0.5}};
  const auto costs = setting.costs->expected(start, plans, kThreshold, kEven);
  EXPECT_LT(costs[1], costs[0]);
  const double near_s = setting.effort({"loc(rob1) = office"}, "move(rob1, kitchen)").success_s;
  const double far_s = setting.effort({"loc(rob1) = office"}, "move(rob1, corridor)").success_s;
  EXPECT_GT(far_s, 2.0 * near_s);

  // The formula, put together by hand.
  const auto from = [&](const std::string& place) {
    const std::string robot = "loc(rob1) = " + place;
    const Effort check = setting.effort({robot}, "grasp(rob1, tb1)", {"loc(tb1) = " + place});
    const double rest =
        setting
            .effort({robot, "loc(tb1) = " + place, "in_hand(rob1, tb1)"},
                    "move(rob1, study_corner)")
            .success_s +
        setting
            .effort({"loc(rob1) = study_corner", "loc(tb1) = study_corner", "in_hand(rob1, tb1)"},
                    "putdown(rob1, tb1)")
            .success_s;
    return Effort{check.success_s + rest, check.failure_s, true};
  };
  const Effort kitchen = from("kitchen");
  const Effort corridor = from("corridor");
  const double across = setting.effort({"loc(rob1) = kitchen"}, "move(rob1, corridor)").success_s;
  const double back = setting.effort({"loc(rob1) = corridor"}, "move(rob1, kitchen)").success_s;
  EXPECT_NEAR(
      costs[0],
      near_s + 0.5 * kitchen.success_s + 0.5 * (kitchen.failure_s + across + corridor.success_s),
      1e-6);
  EXPECT_NEAR(
      costs[1],
      far_s + 0.5 * corridor.success_s + 0.5 * (corridor.failure_s + back + kitchen.success_s),
      1e-6);
}

TEST(PlanCosts, AHypothesisThatIsLikelyEnoughComesFirst)
{
  const Setting setting = office();
  const auto plan = [](const std::string& place) {
    return reasoner::Plan{{"loc(tb1) = " + place},
                          {{"move(rob1, " + place + ")"}, {"grasp(rob1, tb1)"}}};
  };
  const auto start = setting.state({"loc(rob1) = office"});
  const auto costs = setting.costs->expected(
      start, {{plan("kitchen"), 0.95}, {plan("corridor"), 0.05}}, kThreshold, kEven);
  EXPECT_LT(costs[0], costs[1]);
}

TEST(PlanCosts, AnotherDomainIsComparedByTheSameRule)
{
  const Setting setting("workbench", {{"psu", 5}, {"amplifier", 1}, {"tuner", 2}, {"display", 3}});
  const auto plan = [](const std::string& device) {
    return reasoner::Plan{
        {"cause(hum) = " + device},
        {{"unscrew(tech1, " + device + ")"}, {"replace(tech1, " + device + ", hum)"}}};
  };
  const double share = 0.25;
  const auto costs = setting.costs->expected(setting.state({}),
                                             {{plan("psu"), share},
                                              {plan("amplifier"), share},
                                              {plan("tuner"), share},
                                              {plan("display"), share}},
                                             kThreshold, kEven);
  EXPECT_LT(costs[1], costs[2]);  // the fewer modules, the sooner
  EXPECT_LT(costs[2], costs[3]);
  EXPECT_LT(costs[3], costs[0]);
}

TEST(PlanCosts, AnImpossibleActionIsNamed)
{
  const Setting setting = office();
  EXPECT_THROW(static_cast<void>(setting.effort({"loc(rob1) = office"}, "move(rob1, office)")),
               FailedPrecondition);
}

}  // namespace
}  // namespace kr3::executive
