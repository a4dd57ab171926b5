#include "policy_node.hpp"

#include <chrono>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/param_reader.hpp>

#include "belief_services.hpp"
#include "online_service.hpp"
#include "policy_services.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr int kSlowThreads = 2;
constexpr double kNearlyFull = 0.9;

std::size_t megabytes(int count)
{
  return static_cast<std::size_t>(count) << 20U;
}

/// Of the ids of beliefs: a node that is started again must not answer for those of the last.
std::string beliefPrefix()
{
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return "belief-" + contentHash(std::to_string(now.count())).substr(0, 8);
}

SolveQueue::Options queueOptions(const PolicyNodeConfig& config, const ReadOptions& read)
{
  SolveQueue::Options options;
  options.num_workers = config.parallel_solves;
  options.max_waiting = static_cast<std::size_t>(config.max_waiting_goals);
  options.report_period_s = config.feedback_period_s;
  options.niceness = config.solve_niceness;
  options.read = read;
  return options;
}

GoalLimits goalLimits(const PolicyNodeConfig& config)
{
  return {config.default_precision, config.max_time_s, megabytes(config.max_search_megabytes),
          config.max_threads, megabytes(config.max_model_megabytes)};
}

}  // namespace

PolicyNodeConfig loadPolicyNodeConfig(const ros::NodeHandle& private_nh)
{
  PolicyNodeConfig config;
  ParamReader params(private_nh);
  const auto positive = [&params](const std::string& name, auto& value) {
    value = params.get(name, value);
    params.check(value > 0, name, "must be positive");
  };
  positive("default_precision", config.default_precision);
  positive("max_time_s", config.max_time_s);
  positive("feedback_period_s", config.feedback_period_s);
  positive("max_search_megabytes", config.max_search_megabytes);
  positive("max_threads", config.max_threads);
  positive("parallel_solves", config.parallel_solves);
  positive("max_waiting_goals", config.max_waiting_goals);
  config.cancel_abandoned_goals =
      params.get("cancel_abandoned_goals", config.cancel_abandoned_goals);
  config.solve_niceness = params.get("solve_niceness", config.solve_niceness);
  params.check(config.solve_niceness >= 0 && config.solve_niceness <= 19, "solve_niceness",
               "must be in [0, 19]");
  positive("max_model_megabytes", config.max_model_megabytes);
  positive("max_states", config.max_states);
  positive("max_rows", config.max_rows);
  positive("max_entries", config.max_entries);
  positive("cache_megabytes", config.cache_megabytes);
  positive("max_beliefs", config.max_beliefs);
  positive("service_threads", config.service_threads);
  positive("online_time_s", config.online_time_s);
  positive("max_online_time_s", config.max_online_time_s);
  params.check(config.online_time_s <= config.max_online_time_s, "online_time_s",
               "must be at most max_online_time_s");
  positive("online_scenarios", config.online_scenarios);
  config.policy_directory = params.get("policy_directory", config.policy_directory);
  config.load_at_start = params.get("load_at_start", config.load_at_start);
  config.max_process_megabytes = params.get("max_process_megabytes", config.max_process_megabytes);
  params.check(config.max_process_megabytes >= 0, "max_process_megabytes", "must be at least 0");
  params.finish();
  return config;
}

PolicyNode::Lane::Lane(int num_threads) : spinner(static_cast<std::uint32_t>(num_threads), &queue)
{
  nh.setCallbackQueue(&queue);
}

PolicyNode::PolicyNode(const PolicyNodeConfig& config)
  : config_(config)
  , store_(std::make_shared<PolicyStore>(
        PolicyStore::Limits{megabytes(config.cache_megabytes),
                            static_cast<std::size_t>(config.max_beliefs)},
        beliefPrefix()))
  , queue_(store_, queueOptions(config, readOptions()))
  , quick_(config.service_threads)
  , slow_(kSlowThreads)
  , solving_(1)
  , diagnostics_(quick_.nh)
  , solve_server_(solving_.nh, queue_, goalLimits(config), config.cancel_abandoned_goals)
{
  const PolicyFiles files(config.policy_directory, megabytes(config.cache_megabytes));
  loadAtStart(files);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("policies", this, &PolicyNode::diagnose);
  diagnostics_timer_ = quick_.nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  offerBeliefServices(quick_.nh, store_, services_);
  offerPolicyServices(quick_.nh, store_, services_);
  ReadOptions read = readOptions();
  read.keep_going = [] { return ros::ok(); };
  offerFileServices(slow_.nh, store_, files, {megabytes(config.max_model_megabytes), read},
                    services_);
  offerOnlineService(slow_.nh, store_,
                     {config.online_time_s, config.max_online_time_s,
                      static_cast<std::size_t>(config.online_scenarios)},
                     services_);
  quick_.spinner.start();
  slow_.spinner.start();
  solving_.spinner.start();
}

PolicyNode::~PolicyNode() = default;

bool PolicyNode::stop()
{
  constexpr double kPatienceS = 1.0;
  diagnostics_timer_.stop();
  const bool solver_ended = queue_.stop(kPatienceS);
  const bool services_ended = services_.shutdown(kPatienceS);
  const bool ended = solver_ended && services_ended;
  if (ended)
  {
    solving_.spinner.stop();
    slow_.spinner.stop();
    quick_.spinner.stop();
  }
  return ended;
}

ReadOptions PolicyNode::readOptions() const
{
  ReadOptions options;
  options.max_names = static_cast<std::size_t>(config_.max_states);
  options.max_rows = static_cast<std::size_t>(config_.max_rows);
  options.max_entries = static_cast<std::size_t>(config_.max_entries);
  return options;
}

void PolicyNode::loadAtStart(const PolicyFiles& files)
{
  for (const std::string& name : config_.load_at_start)
  {
    const std::string id =
        store_->put(std::make_shared<const SolvedModel>(files.load(name, readOptions())));
    ROS_INFO("loaded '%s' as policy %s", name.c_str(), id.c_str());
  }
}

void PolicyNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  using Level = diagnostic_msgs::DiagnosticStatus;
  const StoreStatistics store = store_->statistics();
  const PolicyStore::Limits& limits = store_->limits();
  const std::size_t num_waiting = queue_.numWaiting();
  const std::size_t num_running = queue_.numRunning();
  const std::uint64_t evicted = store.evicted_policies + store.evicted_beliefs;
  const auto nearlyFull = [](std::size_t used, std::size_t most) {
    return static_cast<double>(used) > kNearlyFull * static_cast<double>(most);
  };
  status.summary(Level::OK, num_running > 0 ? "solving" : "idle");
  if (nearlyFull(store.bytes, limits.max_bytes))
  {
    status.mergeSummary(Level::WARN, "memory for policies and beliefs is nearly full");
  }
  if (nearlyFull(store.num_beliefs, limits.max_beliefs))
  {
    status.mergeSummary(Level::WARN, "there are nearly as many beliefs as are kept");
  }
  if (num_waiting >= static_cast<std::size_t>(config_.max_waiting_goals))
  {
    status.mergeSummary(Level::WARN, "no more models are taken to be solved");
  }
  if (evicted > evicted_before_)
  {
    status.mergeSummary(Level::WARN, "policies or beliefs were evicted");
  }
  evicted_before_ = evicted;
  status.add("policies", store.num_policies);
  status.add("beliefs", store.num_beliefs);
  status.add("bytes", store.bytes);
  status.add("bytes allowed", limits.max_bytes);
  status.add("evicted policies", store.evicted_policies);
  status.add("evicted beliefs", store.evicted_beliefs);
  status.add("goals being solved", num_running);
  status.add("goals waiting", num_waiting);
  status.add("solved", queue_.numSolved());
  status.add("answered from the cache", queue_.numCached());
}

}  // namespace kr3::pomdp
