#pragma once

#include <cstdint>
#include <optional>

#include <kr3_pomdp/policy.hpp>

#include "flat_model.hpp"
#include "kr3_executive/domain_belief.hpp"
#include "search_order.hpp"
#include "test_plan.hpp"

namespace kr3::executive
{

/// A simple policy of a flat model, for its solver to begin with: test the hypotheses of the start
/// in the order of orderOfTests(), round after round; look again while an answer that speaks for
/// one is not enough; then go on to the goal and end. What does not turn out as expected is tried
/// again, on the way to the goal after another look.
///
/// The policy is a finite-state controller; there is a vector for each of its nodes, the value of
/// following it from there. Each is a lower bound up to the rounding of the value iteration, which
/// is subtracted.
///
/// @param plan       of the same task, goal and start
/// @param threshold  probability above which a hypothesis is acted on
/// @return nothing where no hypothesis can be tested, or more than `max_nodes` nodes were needed
/// Source: Hansen (1998), evaluation of finite-state controllers.
[[nodiscard]] std::optional<pomdp::Policy> searchPolicy(const FlatModel& flat, TestPlan& plan,
                                                        const DomainBelief& start, double threshold,
                                                        const SearchOrderOptions& options,
                                                        std::size_t max_nodes = 2000);

}  // namespace kr3::executive
