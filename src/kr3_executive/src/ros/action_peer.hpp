#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <actionlib/client/simple_action_client.h>
#include <ros/node_handle.h>

#include <kr3_common/error.hpp>

namespace kr3::executive
{

/// One action server that is called like a function. Deadlines are wall time, so that a stopped
/// simulation cannot hang the caller.
///
/// Calls from one thread at a time; callbacks arrive in the node's spinner.
template <typename Action>
class ActionPeer
{
public:
  using Goal = typename Action::_action_goal_type::_goal_type;
  using Result = typename Action::_action_result_type::_result_type;

  ActionPeer(ros::NodeHandle nh, std::string name)
    : name_(std::move(name)), client_(std::make_unique<Client>(nh, name_, false))
  {
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool connected() { return client_->isServerConnected(); }

  /// @param cancel  cancels the goal; the result that the server then gives is returned
  /// @param time_s  wall time allowed, 0 = as long as the server is there
  /// @throws Unavailable       no server, or it went away
  /// @throws DeadlineExceeded  the time ran out; the goal was cancelled
  /// @throws Cancelled         cancelled, and the server did not answer that
  Result call(const Goal& goal, const std::atomic<bool>& cancel, double time_s)
  {
    using Clock = std::chrono::steady_clock;
    waitForServer(cancel);
    const auto call = std::make_shared<Call>();  // outlives this function if an answer comes late
    client_->sendGoal(goal, [call](const auto& /*state*/, const auto& result) {
      const std::lock_guard<std::mutex> lock(call->mutex);
      call->done = true;
      if (result)
        call->result = *result;
      call->changed.notify_all();
    });
    const auto start = Clock::now();
    std::optional<Clock::time_point> cancelled_at;
    auto last_seen = start;
    bool timed_out = false;
    std::unique_lock<std::mutex> lock(call->mutex);
    while (!call->changed.wait_for(lock, kPoll, [&] { return call->done; }))
    {
      const auto now = Clock::now();
      lock.unlock();
      if (client_->isServerConnected())
        last_seen = now;
      timed_out =
          timed_out || (time_s > 0.0 && now - start > std::chrono::duration<double>(time_s));
      if ((cancel || timed_out) && !cancelled_at)
      {
        client_->cancelGoal();
        cancelled_at = now;
      }
      if (now - last_seen > kGone || !ros::ok())
      {
        client_->stopTrackingGoal();
        throw Unavailable("action server '" + name_ + "' went away");
      }
      if (cancelled_at && now - *cancelled_at > kCancelTime)
      {
        client_->stopTrackingGoal();
        break;
      }
      lock.lock();
    }
    if (!lock.owns_lock())
      lock.lock();
    if (timed_out)
      throw DeadlineExceeded("action server '" + name_ + "' took longer than allowed");
    if (call->result)
      return *call->result;
    if (cancelled_at)
      throw Cancelled("action '" + name_ + "' was cancelled");
    throw Unavailable("action server '" + name_ + "' gave no result");
  }

private:
  using Client = actionlib::SimpleActionClient<Action>;

  static constexpr std::chrono::milliseconds kPoll{20};  // for cancel, which has no callback
  static constexpr std::chrono::seconds kGone{5};
  static constexpr std::chrono::seconds kCancelTime{5};

  struct Call
  {
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
    std::optional<Result> result;
  };

  void waitForServer(const std::atomic<bool>& cancel)
  {
    const auto start = std::chrono::steady_clock::now();
    while (!client_->isServerConnected())
    {
      if (cancel)
        throw Cancelled("waiting for action server '" + name_ + "' was cancelled");
      if (std::chrono::steady_clock::now() - start > kGone || !ros::ok())
        throw Unavailable("no action server '" + name_ + "'");
      ros::WallDuration(0.02).sleep();  // actionlib offers no callback for a connection
    }
  }

  std::string name_;
  std::unique_ptr<Client> client_;
};

}  // namespace kr3::executive
