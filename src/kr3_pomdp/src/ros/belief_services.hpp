#pragma once

#include <memory>

#include <ros/node_handle.h>

#include "kr3_pomdp/policy_store.hpp"
#include "service_list.hpp"

namespace kr3::pomdp
{

/// Offers what is done with beliefs: stateless (get_action, update_belief) and kept ones. All of it
/// is quick.
void offerBeliefServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                         ServiceList& services);

}  // namespace kr3::pomdp
