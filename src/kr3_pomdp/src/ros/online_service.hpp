#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include <ros/node_handle.h>

#include <kr3_msgs/PlanOnline.h>

#include "kr3_pomdp/online_planner.hpp"
#include "kr3_pomdp/policy_store.hpp"
#include "service_list.hpp"

namespace kr3::pomdp
{

struct OnlineLimits
{
  double default_time_s;  ///< of a request without a limit
  double max_time_s;
  std::size_t default_scenarios;
};

/// Plans one action at a time by sampling. What a model needs for that is prepared at its first
/// request and kept for the models used last.
///
/// Thread-safe.
class OnlineService
{
public:
  OnlineService(std::shared_ptr<PolicyStore> store, const OnlineLimits& limits)
    : store_(std::move(store)), limits_(limits)
  {
  }

  /// @throws NotFound         no such belief or policy (any more)
  /// @throws InvalidArgument  a limit out of range, a belief that does not fit, a discount of 1
  void plan(const kr3_msgs::PlanOnline::Request& request, kr3_msgs::PlanOnline::Response& response);

private:
  struct Prepared;
  [[nodiscard]] OnlineOptions optionsFrom(const kr3_msgs::PlanOnline::Request& request) const;
  [[nodiscard]] std::shared_ptr<const Prepared> prepared(
      const std::shared_ptr<const SolvedModel>& solved);

  const std::shared_ptr<PolicyStore> store_;
  const OnlineLimits limits_;
  std::mutex mutex_;  // guards what follows; held while a model is prepared
  std::list<std::shared_ptr<const Prepared>> prepared_;  // used last first
};

/// Offers plan_online, which takes as long as it is told to.
void offerOnlineService(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                        const OnlineLimits& limits, ServiceList& services);

}  // namespace kr3::pomdp
