#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include "kr3_pomdp/policy_store.hpp"
#include "kr3_pomdp/solve_queue.hpp"
#include "service_list.hpp"
#include "solve_server.hpp"

namespace kr3::pomdp
{

/// Parameters of the policy node; config/policy_node.yaml says what they mean.
struct PolicyNodeConfig
{
  double default_precision = 0.01;
  double max_time_s = 60.0;
  double feedback_period_s = 0.25;
  int max_search_megabytes = 1024;
  int max_threads = 2;
  int parallel_solves = 1;
  int max_waiting_goals = 16;
  bool cancel_abandoned_goals = true;
  int solve_niceness = 5;
  int max_model_megabytes = 64;
  int max_states = 300000;
  int max_rows = 5000000;
  int max_entries = 20000000;
  int cache_megabytes = 512;
  int max_beliefs = 1000;
  int service_threads = 2;
  double online_time_s = 1.0;
  double max_online_time_s = 10.0;
  int online_scenarios = 500;
  std::string policy_directory;
  std::vector<std::string> load_at_start;
  int max_process_megabytes = 4096;
};

/// @throws InvalidArgument  listing everything wrong with the parameters
[[nodiscard]] PolicyNodeConfig loadPolicyNodeConfig(const ros::NodeHandle& private_nh);

/// Solves models on request, keeps policies and beliefs, and answers what to do and what to
/// believe.
///
/// Nothing waits for what takes long: models are solved in threads of their own; quick services,
/// slow ones (files, planning online) and the action's messages have a callback queue each, with
/// its own threads. They share a store that is locked for look-ups only.
class PolicyNode
{
public:
  /// @throws InvalidArgument, NotFound, Unavailable  a file of load_at_start cannot be loaded
  explicit PolicyNode(const PolicyNodeConfig& config);
  ~PolicyNode();
  PolicyNode(const PolicyNode&) = delete;
  PolicyNode& operator=(const PolicyNode&) = delete;

  /// Ends what is under way. Called once.
  /// @return false when a thread could not be ended soon: then end the process at once
  [[nodiscard]] bool stop();

private:
  /// A callback queue with the threads that serve it.
  struct Lane
  {
    explicit Lane(int num_threads);
    ros::CallbackQueue queue;
    ros::NodeHandle nh;
    ros::AsyncSpinner spinner;
  };

  [[nodiscard]] ReadOptions readOptions() const;
  void loadAtStart(const class PolicyFiles& files);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  const PolicyNodeConfig config_;
  const std::shared_ptr<PolicyStore> store_;
  SolveQueue queue_;
  Lane quick_;
  Lane slow_;
  Lane solving_;
  std::uint64_t evicted_before_ = 0;  // at the last diagnosis
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  SolveServer solve_server_;
  ServiceList services_;
};

}  // namespace kr3::pomdp
