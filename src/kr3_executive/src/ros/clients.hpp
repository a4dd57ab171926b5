#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/service_client.h>

#include <kr3_msgs/ExecuteSkillAction.h>
#include <kr3_msgs/MakePlanAction.h>
#include <kr3_msgs/SolveAction.h>

#include "action_peer.hpp"
#include "kr3_executive/bindings.hpp"
#include "kr3_executive/history_window.hpp"
#include "kr3_executive/interfaces.hpp"
#include "sensor_watches.hpp"

namespace kr3::executive
{

/// reasoner_node as the high level. It keeps the history itself and tells it again when the node
/// holds another one, as after a restart.
class RosReasoner : public HighLevelReasoner
{
public:
  /// @param history_window  steps that the node keeps one by one (history_window.hpp)
  RosReasoner(ros::NodeHandle nh, const reasoner::PlanOptions& options,
              std::uint32_t history_window);

  /// Names of services and actions that do not answer yet.
  [[nodiscard]] std::vector<std::string> missing();

  void setHistory(const std::vector<reasoner::Record>& records) override;
  void addRecords(const std::vector<reasoner::Record>& records) override;
  void suppose(const std::vector<reasoner::Record>& records) override;
  reasoner::Diagnosis diagnose() override;
  reasoner::Answer entails(const std::string& literal, int step) override;
  bool possible(const std::string& literal, int step) override;
  std::vector<std::string> entailedAt(int step) override;
  reasoner::Explanation explain(const std::string& literal, int step) override;
  std::vector<reasoner::Retraction> retractions(const std::string& literal, int step) override;
  reasoner::PlanResult plan(const std::string& goal, std::uint32_t max_plans,
                            const std::atomic<bool>& cancel) override;
  /// Asked of the node each time, as it may have been started anew with others.
  /// @throws FailedPrecondition  it keeps a window of its own: records are counted from the start
  ///                             here
  std::optional<ReasonerSettings> settings() override;

private:
  /// Tells the whole history again unless the node holds as many records as we do.
  void synchronise();

  reasoner::PlanOptions options_;
  std::uint32_t history_window_;
  /// The history, of which the node has the later part.
  void progressIfDue();

  HistoryWindow window_;
  ros::ServiceClient set_history_;
  ros::ServiceClient add_records_;
  ros::ServiceClient entails_;
  ros::ServiceClient explain_;
  ros::ServiceClient diagnose_;
  ros::ServiceClient get_state_;
  ros::ServiceClient find_retractions_;
  ros::ServiceClient progress_;
  ros::ServiceClient get_options_;
  ActionPeer<kr3_msgs::MakePlanAction> plan_;
};

/// policy_node as the policy server.
class RosPolicyServer : public PolicyServer
{
public:
  explicit RosPolicyServer(ros::NodeHandle nh);

  [[nodiscard]] std::vector<std::string> missing();

  SolvedPolicy solve(const pomdp::Model& model, const SolveBudget& budget,
                     const std::atomic<bool>& cancel) override;
  std::size_t actionAt(const std::string& policy_id, const pomdp::Belief& belief) override;

private:
  ros::NodeHandle nh_;
  ActionPeer<kr3_msgs::SolveAction> solve_;
  ros::ServiceClient get_action_;
  ros::ServiceClient connected_action_;  ///< the same, persistent
};

/// Skill servers as the executor of low-level actions, by the bindings of the domain.
class RosExecutor : public LowLevelExecutor
{
public:
  /// @param bindings  must outlive the executor
  RosExecutor(ros::NodeHandle nh, const Bindings& bindings);

  [[nodiscard]] std::vector<std::string> missing();

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;

private:
  const Bindings& bindings_;
  SensorWatches watches_;
  std::map<std::string, std::unique_ptr<ActionPeer<kr3_msgs::ExecuteSkillAction>>> servers_;
};

}  // namespace kr3::executive
