#pragma once

#include <atomic>

#include <kr3_common/ros/lockstep_consumer.hpp>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// The mission thinks as long as this lives: in lockstep simulated time goes no faster than wall
/// time, so that thinking costs a simulated robot what it would cost a real one. Nothing without a
/// pace.
class Thinking
{
public:
  explicit Thinking(LockstepConsumer* pace) : pace_(pace)
  {
    if (pace_ != nullptr)
      pace_->pace();
  }
  ~Thinking()
  {
    if (pace_ != nullptr)
      pace_->release();
  }
  Thinking(const Thinking&) = delete;
  Thinking& operator=(const Thinking&) = delete;

private:
  LockstepConsumer* pace_;
};

/// An executor during whose actions nobody thinks.
class PacedExecutor : public LowLevelExecutor
{
public:
  /// @param inner, pace  must outlive this
  PacedExecutor(LowLevelExecutor& inner, LockstepConsumer& pace) : inner_(inner), pace_(pace) {}

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;

private:
  LowLevelExecutor& inner_;
  LockstepConsumer& pace_;
};

}  // namespace kr3::executive
