#include "executive_node_config.hpp"

#include <algorithm>
#include <chrono>

#include <kr3_common/ros/param_reader.hpp>

namespace kr3::executive
{
namespace
{

/// A shorter history would be summed up in the middle of what a mission is about.
constexpr std::uint32_t kLeastWindow = 10;

}  // namespace

ExecutiveNodeConfig loadExecutiveNodeConfig(const ros::NodeHandle& private_nh)
{
  ExecutiveNodeConfig config;
  ParamReader params(private_nh);
  config.domain = params.require<std::string>("domain");
  config.refinement = params.require<std::string>("refinement");
  config.models = params.require<std::string>("models");
  config.bindings = params.require<std::string>("bindings");
  config.scenario = params.get("scenario", config.scenario);
  config.state_file = params.get("state_file", config.state_file);
  const std::string method = params.get("method", std::string(toString(config.method)));
  const auto& methods = allMethods();
  const auto named = std::find_if(methods.begin(), methods.end(),
                                  [&](Method known) { return method == toString(known); });
  params.check(named != methods.end(), "method",
               "must be pa, pa_star, pomdp1, pomdp2 or hierarchical");
  config.method = named == methods.end() ? config.method : *named;
  double& bias = config.baseline.default_probability;
  bias = params.get("pomdp2_bias", bias);
  params.check(bias > 0.0 && bias < 1.0, "pomdp2_bias", "must be in (0, 1)");
  config.peer_deadline_s = params.get("peer_deadline_s", config.peer_deadline_s);
  params.check(config.peer_deadline_s > 0.0, "peer_deadline_s", "must be positive");

  config.lockstep = params.get("lockstep", config.lockstep);

  const auto count = [&params](const std::string& name, int fallback, int least) {
    const int value = params.get(name, fallback);
    params.check(value >= least, name, "must be at least " + std::to_string(least));
    return static_cast<std::uint32_t>(std::max(value, least));
  };
  Limits& limits = config.driver.limits;
  limits.max_hl_actions = count("max_hl_actions", static_cast<int>(limits.max_hl_actions), 1);
  limits.max_ll_actions = count("max_ll_actions", static_cast<int>(limits.max_ll_actions), 1);
  limits.max_attempts = count("max_attempts", static_cast<int>(limits.max_attempts), 1);
  limits.max_reopened = count("max_reopened", static_cast<int>(limits.max_reopened), 0);
  limits.max_detours = count("max_detours", static_cast<int>(limits.max_detours), 0);
  config.driver.max_alternatives =
      count("max_alternatives", static_cast<int>(config.driver.max_alternatives), 1);
  config.driver.history_window =
      count("history_window", static_cast<int>(config.driver.history_window), 0);
  params.check(config.driver.history_window == 0 || config.driver.history_window >= kLeastWindow,
               "history_window", "must be 0 (all) or at least " + std::to_string(kLeastWindow));
  config.driver.max_skill_retries =
      count("max_skill_retries", static_cast<int>(config.driver.max_skill_retries), 0);
  limits.threshold = params.get("threshold", limits.threshold);
  params.check(limits.threshold > 0.5 && limits.threshold < 1.0, "threshold",
               "must be in (0.5, 1)");
  double& by_default = config.driver.default_probability;
  by_default = params.get("default_probability", by_default);
  params.check(by_default > 0.0 && by_default < 1.0, "default_probability", "must be in (0, 1)");

  double& least = config.driver.least_hypothesis_probability;
  least = params.get("least_hypothesis_probability", least);
  params.check(least > 0.0 && least < 1.0, "least_hypothesis_probability", "must be in (0, 1)");
  double& change = config.driver.change_probability;
  change = params.get("change_probability", change);
  params.check(change >= 0.0 && change < 1.0, "change_probability", "must be in [0, 1)");

  SolveBudget& budget = config.driver.budget;
  budget.precision = params.get("precision", budget.precision);
  params.check(budget.precision > 0.0, "precision", "must be positive");
  budget.time_s = params.get("solve_time_s", budget.time_s);
  params.check(budget.time_s >= 0.0, "solve_time_s", "must not be negative");
  budget.max_backups = count("max_backups", static_cast<int>(budget.max_backups), 0);

  config.plan.max_horizon = static_cast<int>(count("max_horizon", config.plan.max_horizon, 1));
  const double plan_time_s = params.get("plan_time_s", 30.0);
  params.check(plan_time_s > 0.0, "plan_time_s", "must be positive");
  config.plan.time_limit = std::chrono::milliseconds(static_cast<int>(1000.0 * plan_time_s));
  config.driver.explain_facts = true;
  params.finish();
  return config;
}

}  // namespace kr3::executive
