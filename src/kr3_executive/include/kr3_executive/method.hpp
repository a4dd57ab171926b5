#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>

#include "kr3_executive/driver.hpp"

namespace kr3::executive
{

/// How missions are planned: the architecture, and what it is compared with.
enum class Method : std::uint8_t
{
  kPa,            ///< Algorithm 1
  kPaStar,        ///< Algorithm 1 without defaults
  kPomdp1,        ///< one POMDP of the whole domain
  kPomdp2,        ///< the same, its initial belief biased by the defaults
  kHierarchical,  ///< a POMDP of the high level above POMDPs of its actions
};

[[nodiscard]] const std::vector<Method>& allMethods();
/// "pa", "pa_star", "pomdp1", "pomdp2", "hierarchical"
[[nodiscard]] const char* toString(Method method);
/// @throws InvalidArgument  no such method; the message lists them
[[nodiscard]] Method methodNamed(const std::string& name);

/// The high-level description that a method's reasoner must have: only PA and POMDP-2 know
/// defaults.
[[nodiscard]] reasoner::Description descriptionFor(Method method,
                                                   const reasoner::Description& high_level);

/// How POMDP-1 and POMDP-2 plan.
enum class FlatPlanning : std::uint8_t
{
  kBest,    ///< solved ahead where that leaves a small gap, else online
  kAhead,   ///< solved ahead with the budget, whatever the gap
  kOnline,  ///< at each belief
};
/// "best", "ahead", "online"
[[nodiscard]] const char* toString(FlatPlanning planning);
/// @throws InvalidArgument  no such way; the message lists them
[[nodiscard]] FlatPlanning flatPlanningNamed(const std::string& name);

/// What the probabilistic methods need beside a DriverConfig.
struct BaselineOptions
{
  /// POMDP-2: probability that a fluent is as its default says, in (0, 1); as the next default of a
  /// chain says, given that it is not, and so on.
  double default_probability = 0.85;
  FlatPlanning planning = FlatPlanning::kBest;
  /// Of the whole domain's POMDP, where it is solved ahead.
  SolveBudget budget{0.5, 0.0, 20000};
  /// Counted work of online planning for each action: prospects asked for (what testing one
  /// hypothesis takes from one place), and hypotheses tried as the first to test.
  std::uint64_t online_prospects = 200000;
  std::size_t online_candidates = 8;
  /// Of a flat model that is solved ahead: its actions times its states.
  std::size_t max_rows = 400000;
  /// Of a belief.
  std::size_t max_states = 200000;
  /// Simulated runs that give the numbers of one high-level action in the hierarchy.
  std::size_t option_samples = 100;
};

class BaselineCache;

/// What the probabilistic methods keep from mission to mission: models and policies, by content.
/// Not thread-safe.
[[nodiscard]] std::shared_ptr<BaselineCache> makeBaselineCache();

/// What a mission is made of. Everything passed by reference must outlive it.
struct MissionParts
{
  const refinement::LowLevelDomain& domain;
  const refinement::Models& models;
  const Narrator& narrator;
  HighLevelReasoner& reasoner;  ///< of descriptionFor(method, ...)
  PolicyServer& policies;
  LowLevelExecutor& executor;
  MissionObserver& observer;
  MissionDriver::Clock clock;
  DriverConfig config;
  std::shared_ptr<PlanCosts> costs = {};  ///< of the domain and models; null: the mission's own
};

/// @param cache  null: nothing is kept
[[nodiscard]] std::unique_ptr<Mission> makeMission(Method method, MissionParts parts,
                                                   const BaselineOptions& options = {},
                                                   std::shared_ptr<BaselineCache> cache = nullptr);

}  // namespace kr3::executive
