#pragma once

#include <mutex>
#include <optional>

#include <ros/node_handle.h>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// Keeps a simulation in lockstep with a mission: while the mission thinks, simulated time goes as
/// fast as wall time and no faster, however fast the simulation is otherwise; while a skill runs,
/// the simulation is not held.
///
/// So thinking costs a simulated robot what it would cost a real one, and not that times the
/// real-time factor. Thread-safe.
class ThinkingPace
{
public:
  /// Registers with the simulator as a consumer of the node's name.
  /// @throws Unavailable         there is no simulator that offers lockstep
  /// @throws FailedPrecondition  it refused, with its reason
  explicit ThinkingPace(ros::NodeHandle nh);
  ~ThinkingPace();
  ThinkingPace(const ThinkingPace&) = delete;
  ThinkingPace& operator=(const ThinkingPace&) = delete;

  void beginThinking();
  void endThinking();

private:
  struct Instant
  {
    ros::Time simulated;
    ros::SteadyTime wall;
  };

  /// Acknowledges the present unless simulated time is ahead of what thinking took.
  void acknowledge();

  ros::NodeHandle nh_;
  std::string name_;
  std::mutex mutex_;
  std::optional<Instant> thinking_since_;
  ros::Time acknowledged_;
  ros::Publisher acknowledgements_;
  ros::SteadyTimer timer_;
};

/// The mission thinks as long as this lives. Nothing without a pace.
class Thinking
{
public:
  explicit Thinking(ThinkingPace* pace) : pace_(pace)
  {
    if (pace_ != nullptr)
      pace_->beginThinking();
  }
  ~Thinking()
  {
    if (pace_ != nullptr)
      pace_->endThinking();
  }
  Thinking(const Thinking&) = delete;
  Thinking& operator=(const Thinking&) = delete;

private:
  ThinkingPace* pace_;
};

/// An executor during whose actions nobody thinks.
class PacedExecutor : public LowLevelExecutor
{
public:
  /// @param inner, pace  must outlive this
  PacedExecutor(LowLevelExecutor& inner, ThinkingPace& pace) : inner_(inner), pace_(pace) {}

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;

private:
  LowLevelExecutor& inner_;
  ThinkingPace& pace_;
};

}  // namespace kr3::executive
