// How the value and the first action of a task change with its initial belief.

#include "kr3_refinement/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

const char* const kHighLevel = R"(
sorts
  rack = {near, far}.
  box = {a}.
fluents
  inertial at(box) : rack.
  inertial packed(box).
actions
  pack(box, rack).
axioms
  pack(X, R) causes packed(X).
  impossible pack(X, R) if at(X) = R2, R != R2.
)";

const char* const kModels = R"(
discount: 0.98
rewards: {success: 100, given_up: 20, wrong_finish: -100}
actions:
  pack(X, S): {cost: {base_s: 1.0, impossible_s: 2.0}}
)";

/// Nothing can be sensed: pack and finish, or finish at once. @param slots  in each rack
PomdpTask blind(std::size_t slots, double near)
{
  const LowLevelDomain domain = test::composed(kHighLevel, "magnify rack into slot by slot_of.\n",
                                               gridMap({"near", "far"}, slots, 1.0));
  const Models models = parseModels(kModels, "models.yaml", domain);
  const Zoom zoomed =
      zoom(domain, {reasoner::parseGroundLiteral("at(a) = near", domain.highLevel())},
           reasoner::parseGroundAction("pack(a, near)", domain.highLevel()));
  return generatePomdp(domain, models, zoomed, {{}, {{"at(a)", {{"near", near}}}}});
}

/// By hand: packing costs 1 s and earns .98 * 100, in vain 2 s and .98 * 20.
double packing(double near)
{
  return near * (-1.0 + 98.0) + (1.0 - near) * (-2.0 + 19.6);
}
double finishing(double near)
{
  return near * -100.0 + (1.0 - near) * 20.0;
}

TEST(Sensitivity, OfATaskWithoutSensorsIsKnown)
{
  const PomdpTask task = blind(1, 0.8);
  SensitivityOptions options;
  options.masses = {0.0, 0.005, 0.01, 0.02, 0.5, 1.0};
  options.bisections = 12;
  options.limits.precision = 1e-9;
  const SensitivityReport report = sensitivity(task, "at(a)", options);
  EXPECT_DOUBLE_EQ(report.nominal, 0.8);
  ASSERT_EQ(report.by_mass.size(), options.masses.size());
  for (const SensitivityPoint& point : report.by_mass)
  {
    const double best = std::max(packing(point.probability), finishing(point.probability));
    EXPECT_NEAR(point.lower, best, 2e-3) << point.probability;
    EXPECT_NEAR(point.upper, best, 2e-3) << point.probability;
    EXPECT_NEAR(point.nominal_policy, packing(point.probability), 2e-3) << point.probability;
    EXPECT_EQ(task.actionSymbol(point.first_action), point.probability < 0.012 ? "finish" : "pack");
  }
  // 97 p + 17.6 (1 - p) = -100 p + 20 (1 - p) at p = 2.4 / 199.4
  ASSERT_EQ(report.changes.size(), 1U);
  EXPECT_LE(report.changes[0].below, 2.4 / 199.4);
  EXPECT_GE(report.changes[0].above, 2.4 / 199.4);
  EXPECT_LT(report.changes[0].above - report.changes[0].below, 1e-5);
  ASSERT_EQ(report.by_value.size(), 1U);
  EXPECT_EQ(report.by_value[0].start, "near_c0");
  EXPECT_NEAR(report.by_value[0].lower, packing(0.8), 2e-3);
}

// The value is convex in the belief: knowing the slot is worth no less than its spread, on average.
TEST(Sensitivity, NoSpreadIsWorthMoreThanKnowingThePlace)
{
  const PomdpTask task = blind(2, 0.6);
  const SensitivityReport report = sensitivity(task, "at(a)");
  ASSERT_EQ(report.by_value.size(), 2U);
  const pomdp::SolveResult own = pomdp::solve(task.model(), {});
  EXPECT_GE(report.by_value[0].upper + report.by_value[1].upper, 2.0 * own.lower - 1e-6);
  for (const SensitivityPoint& point : report.by_value)
  {
    EXPECT_LE(point.nominal_policy, point.upper + 1e-6);
  }
}

TEST(Sensitivity, IsToldInATable)
{
  const PomdpTask task = blind(1, 0.8);
  SensitivityOptions options;
  options.masses = {0.0, 0.5};
  const std::string text = sensitivity(task, "at( a )", options).text(task);
  for (const char* part :
       {"at(a) is inside the zoom with 0.800", "0.500  57.30 .. 57.30  57.30  pack(a, near_c0)",
        "0.000  20.00 .. 20.00  17.60  finish", "finish becomes pack(a, near_c0)",
        "near_c0  81.12 .. 81.12"})
  {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

TEST(Sensitivity, IsRefusedWhereNothingIsHidden)
{
  const PomdpTask task = blind(1, 0.8);
  expectError(ErrorCode::kNotFound, "the task has no fluent 'on(a)'",
              [&] { (void)sensitivity(task, "on(a)"); });
  expectError(ErrorCode::kFailedPrecondition, "'packed(a)' is known at the start",
              [&] { (void)sensitivity(task, "packed(a)"); });
  SensitivityOptions options;
  options.masses = {1.5};
  expectError(ErrorCode::kInvalidArgument, "expected masses in [0, 1]",
              [&] { (void)sensitivity(task, "at(a)", options); });
}

}  // namespace
}  // namespace kr3::refinement
