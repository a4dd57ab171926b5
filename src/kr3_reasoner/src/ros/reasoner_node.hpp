#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

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
#include <kr3_msgs/WhatIf.h>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// Parameters of the reasoner node; config/reasoner_node.yaml says what they mean.
struct ReasonerNodeConfig
{
  std::string domain;
  std::vector<std::string> more_files;
  int max_horizon = 12;
  double time_limit_s = 10.0;
  double question_time_limit_s = 10.0;
  int max_records = 10000;
  ReasonerOptions options;
};

/// @throws InvalidArgument  listing everything wrong with the parameters
[[nodiscard]] ReasonerNodeConfig loadReasonerNodeConfig(const ros::NodeHandle& private_nh);

/// Reads the description that the parameters name.
/// @throws NotFound, InvalidArgument  as readDescription
[[nodiscard]] Description readDomain(const ReasonerNodeConfig& config);

/// Offers a Reasoner on ROS. Services answer one after the other, in the thread that spins. Plans
/// are made in a thread of their own with a reasoner of their own, so that services answer
/// meanwhile and a goal that is cancelled ends at once, whatever the solver does.
class ReasonerNode
{
public:
  ReasonerNode(ros::NodeHandle nh, const ReasonerNodeConfig& config);
  ~ReasonerNode();
  ReasonerNode(const ReasonerNode&) = delete;
  ReasonerNode& operator=(const ReasonerNode&) = delete;

private:
  using PlanServer = actionlib::SimpleActionServer<kr3_msgs::MakePlanAction>;

  /// A planning reasoner at work; its thread holds what it needs.
  struct Work
  {
    std::shared_ptr<std::atomic<bool>> cancel;
    std::future<kr3_msgs::MakePlanResult> result;
  };

  /// Of one service call.
  [[nodiscard]] Limits questionLimits() const;

  /// A service: `answer` fills the response, what it throws becomes the status.
  template <typename Service>
  void serve(
      ros::NodeHandle& nh, const std::string& name,
      std::function<void(const typename Service::Request&, typename Service::Response&)> answer);
  void offerHistory(ros::NodeHandle& nh);
  void offerQuestions(ros::NodeHandle& nh);
  void offerAnalyses(ros::NodeHandle& nh);

  /// Reads the description again. Goals under way are planned to their end with the one they began
  /// with.
  /// @throws InvalidArgument, NotFound  the files are wrong, or the history does not fit them; then
  ///                                    nothing has changed; FailedPrecondition  the history was
  ///                                    progressed
  void reloadDomain();

  /// @throws ResourceExhausted  more records than the parameter max_records allows
  void checkCount(std::size_t num_records) const;
  void addRecords(const kr3_msgs::AddRecords::Request& request);
  void diagnose(const kr3_msgs::Diagnose::Request& request,
                kr3_msgs::Diagnose::Response& response) const;
  void explain(const kr3_msgs::ExplainLiteral::Request& request,
               kr3_msgs::ExplainLiteral::Response& response) const;
  void whatIf(const kr3_msgs::WhatIf::Request& request, kr3_msgs::WhatIf::Response& response) const;
  void getState(const kr3_msgs::GetState::Request& request,
                kr3_msgs::GetState::Response& response) const;

  void onPlan(const kr3_msgs::MakePlanGoalConstPtr& goal);
  [[nodiscard]] Work startPlanning(const kr3_msgs::MakePlanGoal& goal);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  ReasonerNodeConfig config_;
  std::mutex mutex_;  // guards what follows, down to last_duration_s_
  Reasoner reasoner_;
  std::size_t num_told_ = 0;           // records, with those that are no longer kept
  std::shared_ptr<Reasoner> planner_;  // idle, with the history of the last goal; or none
  std::size_t domain_version_ = 0;     // counts how often the description was replaced
  std::size_t num_plans_ = 0;
  std::size_t num_questions_ = 0;
  std::string last_question_;
  ros::WallTime last_time_;
  double last_duration_s_ = 0.0;
  std::vector<Work> abandoned_;  // of the action server's thread: cancelled, but not ended yet

  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  std::vector<ros::ServiceServer> services_;
  PlanServer plan_;
};

}  // namespace kr3::reasoner
