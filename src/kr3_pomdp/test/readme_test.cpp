// The example of README.md, word for word.

#include <gtest/gtest.h>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{
namespace
{

TEST(Readme, TheExampleListensFirst)
{
  ModelBuilder builder({"left", "right"}, {"listen", "open_left", "open_right"},
                       {"hear_left", "hear_right"});
  builder.setDiscount(0.95);
  builder.setTransition(kAny, kAny, kAny, 0.5);  // opening a door: the tiger goes anywhere
  builder.setObservation(kAny, kAny, kAny, 0.5);
  for (std::size_t s = 0; s < 2; ++s)
  {
    builder.setTransition(0, s, kAny, 0.0);
    builder.setTransition(0, s, s, 1.0);  // listening: it stays
    builder.setObservation(0, s, s, 0.85);
    builder.setObservation(0, s, 1 - s, 0.15);
    builder.setReward(0, s, -1.0);
    builder.setReward(1 + s, s, -100.0);
    builder.setReward(1 + s, 1 - s, 10.0);
  }
  const Model model = builder.build();

  SolverLimits limits;
  limits.precision = 1e-3;
  limits.time_s = 1.0;
  const SolveResult result = solve(model, limits);  // result.lower <= optimum <= result.upper

  Belief belief = model.initialBelief();
  const std::size_t action = result.policy.actionAt(belief);  // "listen"
  belief = updated(model, belief, action, *model.findObservation("hear_left")).posterior;

  EXPECT_EQ(model.actionName(action), "listen");
  EXPECT_NEAR(result.lower, 19.37, 0.01);
  EXPECT_NEAR(belief[0], 0.85, 1e-12);
}

}  // namespace
}  // namespace kr3::pomdp
