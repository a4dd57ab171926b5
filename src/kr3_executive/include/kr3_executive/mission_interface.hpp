#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/reasoner.hpp>

#include "kr3_executive/mission.hpp"
#include "kr3_executive/mission_log.hpp"

namespace kr3::executive
{

/// How a mission ended.
struct MissionResult
{
  ErrorCode code = ErrorCode::kOk;  ///< kOk also when no plan was left
  bool achieved = false;            ///< the method holds the goal to be true
  std::string reason;
  std::uint32_t hl_actions = 0;  ///< 0 for methods without a high level
  std::uint32_t ll_actions = 0;
  double duration_s = 0.0;  ///< on the mission's clock
};

/// Missions by one method, the architecture's or another.
///
/// achieve() runs in one thread; cancel() and tell() may be called from others, and by the observer
/// from within.
class Mission
{
public:
  using Clock = std::function<double()>;  ///< s, never runs backwards

  Mission() = default;
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;
  virtual ~Mission() = default;

  /// Runs a mission until it ends; failures on the way are in the result.
  ///
  /// @param initial  records told when the history is empty
  /// @param time_limit_s  on the clock, 0 = none
  /// @throws InvalidArgument  the goal does not fit the description; nothing was started
  virtual MissionResult achieve(const std::string& goal,
                                const std::vector<reasoner::Record>& initial, const Limits& limits,
                                double time_limit_s) = 0;

  /// Ends the mission under way; it stays cancelled until the next achieve().
  virtual void cancel() = 0;

  /// A fact from a person; taken in at once when no mission runs, else after the low-level action
  /// under way. @throws InvalidArgument  it does not fit the description
  virtual void tell(const reasoner::Record& record) = 0;

  /// Not while a mission runs.
  [[nodiscard]] virtual const Knowledge& knowledge() const = 0;
  virtual void setKnowledge(Knowledge knowledge) = 0;
};

}  // namespace kr3::executive
