#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include <kr3_common/ros/monotonic_clock.hpp>
#include <kr3_msgs/AchieveAction.h>
#include <kr3_msgs/Tell.h>

#include "clients.hpp"
#include "executive_node_config.hpp"
#include "kr3_executive/driver.hpp"
#include "kr3_executive/knowledge_file.hpp"
#include "kr3_executive/mission_recording.hpp"
#include "kr3_executive/scenario.hpp"
#include "markers.hpp"
#include "paced_executor.hpp"

namespace kr3::executive
{

/// Runs missions on a robot.
///
/// Missions run in the action server's own thread, one that was under way when the node ended in a
/// thread of its own; everything else in the node's spinner.
///
/// A mission under way is kept in the state file with history and memory, and taken up again at the
/// next start, unless it was cancelled or ended. A new goal takes its place.
class ExecutiveNode : public MissionObserver
{
public:
  /// Waits for the map's cells and for every node it needs.
  ///
  /// @param stop  set by a signal: waiting ends
  /// @throws Unavailable        something did not answer in time; the message names it
  /// @throws InvalidArgument    a file is wrong
  /// @throws Cancelled          `stop` was set
  ExecutiveNode(ros::NodeHandle nh, const ros::NodeHandle& private_nh, ExecutiveNodeConfig config,
                const std::atomic<bool>& stop);
  ~ExecutiveNode() override;
  ExecutiveNode(const ExecutiveNode&) = delete;
  ExecutiveNode& operator=(const ExecutiveNode&) = delete;

  void onEvent(const ReportedEvent& event) override;
  void onBelief(const ReportedBelief& belief) override;
  void onSnapshot(const Snapshot& snapshot) override;
  void onInput(const Input& input) override;
  void onDecision(const ReportedDecision& decision) override;

private:
  using AchieveServer = actionlib::SimpleActionServer<kr3_msgs::AchieveAction>;

  void waitForPeers(const std::atomic<bool>& stop);
  void restoreKnowledge();
  void onAchieve(const kr3_msgs::AchieveGoalConstPtr& goal);
  bool onCancel(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  /// Runs a mission, which is under way until this returns. @throws InvalidArgument
  MissionResult runMission(const MissionUnderWay& mission);
  void resumeMission();
  /// Cancels the mission that was taken up and waits until the robot stands.
  void endResumedMission();
  void save();
  bool onTell(kr3_msgs::Tell::Request& request, kr3_msgs::Tell::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ExecutiveNodeConfig config_;
  std::unique_ptr<refinement::LowLevelDomain> domain_;
  refinement::Models models_;
  Bindings bindings_;
  MonotonicClock clock_;  // of mission times
  Scenario scenario_;
  std::unique_ptr<Narrator> narrator_;
  std::unique_ptr<MissionMarkers> markers_;
  RosReasoner reasoner_;
  RosPolicyServer policies_;
  std::unique_ptr<RosExecutor> executor_;
  std::unique_ptr<LockstepConsumer> pace_;  // in lockstep only, as the next
  std::unique_ptr<PacedExecutor> paced_executor_;
  /// Of a method without defaults: the reasoner node's description has them.
  std::unique_ptr<HighLevelReasoner> own_reasoner_;
  std::unique_ptr<Mission> driver_;

  std::mutex mutex_;  // guards the members down to `mission_start_s_`
  Snapshot snapshot_;
  std::string belief_;
  kr3_msgs::AchieveFeedback feedback_;
  std::optional<MissionUnderWay> under_way_;  // with what was left to it at its start
  double mission_start_s_ = 0.0;

  std::atomic<bool> stopping_{false};
  std::future<void> resumed_;

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher state_publisher_;
  ros::Publisher event_publisher_;
  ros::Publisher belief_publisher_;
  ros::Publisher belief_markers_publisher_;
  ros::Publisher plan_markers_publisher_;
  ros::Publisher input_publisher_;
  std::unique_ptr<MissionRecorder> recorder_;
  ros::WallTimer diagnostics_timer_;
  ros::ServiceServer tell_;
  ros::ServiceServer cancel_;
  std::unique_ptr<AchieveServer> achieve_;
};

}  // namespace kr3::executive
