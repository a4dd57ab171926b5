#pragma once

#include <atomic>
#include <mutex>
#include <string>

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <kr3_msgs/AddRecords.h>
#include <kr3_msgs/Diagnose.h>
#include <kr3_msgs/Entails.h>
#include <kr3_msgs/ExplainLiteral.h>
#include <kr3_msgs/GetState.h>
#include <kr3_msgs/MakePlanAction.h>
#include <kr3_msgs/SetHistory.h>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// Parameters of the reasoner node; config/reasoner_node.yaml says what they mean.
struct ReasonerNodeConfig
{
  std::string domain;
  int max_horizon = 12;
  double time_limit_s = 10.0;
  ReasonerOptions options;
};

/// @throws InvalidArgument  listing everything wrong with the parameters
[[nodiscard]] ReasonerNodeConfig loadReasonerNodeConfig(const ros::NodeHandle& private_nh);

/// Offers a Reasoner on ROS. Plans are made in the action server's own thread with a reasoner of
/// their own, so that the services answer meanwhile.
class ReasonerNode
{
public:
  ReasonerNode(ros::NodeHandle nh, const ReasonerNodeConfig& config);
  ~ReasonerNode();
  ReasonerNode(const ReasonerNode&) = delete;
  ReasonerNode& operator=(const ReasonerNode&) = delete;

private:
  using PlanServer = actionlib::SimpleActionServer<kr3_msgs::MakePlanAction>;

  bool onSetHistory(kr3_msgs::SetHistory::Request& request,
                    kr3_msgs::SetHistory::Response& response);
  bool onAddRecords(kr3_msgs::AddRecords::Request& request,
                    kr3_msgs::AddRecords::Response& response);
  bool onEntails(kr3_msgs::Entails::Request& request, kr3_msgs::Entails::Response& response);
  bool onExplain(kr3_msgs::ExplainLiteral::Request& request,
                 kr3_msgs::ExplainLiteral::Response& response);
  bool onDiagnose(kr3_msgs::Diagnose::Request& request, kr3_msgs::Diagnose::Response& response);
  bool onGetState(kr3_msgs::GetState::Request& request, kr3_msgs::GetState::Response& response);
  void onPlan(const kr3_msgs::MakePlanGoalConstPtr& goal);
  [[nodiscard]] kr3_msgs::MakePlanResult makePlan(const kr3_msgs::MakePlanGoal& goal);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  ReasonerNodeConfig config_;
  std::mutex mutex_;  // guards reasoner_ and num_plans_
  Reasoner reasoner_;
  unsigned num_plans_ = 0;
  std::atomic<bool> cancel_{false};

  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  ros::ServiceServer set_history_;
  ros::ServiceServer add_records_;
  ros::ServiceServer entails_;
  ros::ServiceServer explain_;
  ros::ServiceServer diagnose_;
  ros::ServiceServer get_state_;
  PlanServer plan_;
};

}  // namespace kr3::reasoner
