#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_task.hpp"

namespace kr3::executive
{

/// What something takes, on average.
struct OptionEffort
{
  double seconds = 0.0;
  double steps = 1.0;  ///< low-level actions
};

/// Finding out whether a high-level action is possible by beginning to carry it out: the
/// low-level policy is followed until something speaks for it or the policy gives up.
struct LookModel
{
  OptionEffort where_possible;
  OptionEffort where_impossible;
  double detection = 1.0;    ///< probability that it seems possible where it is
  double false_alarm = 0.0;  ///< where it is not
};

/// How a high-level action goes when its low-level policy carries it out.
struct OptionModel
{
  OptionEffort success;    ///< where it is possible and is found to have succeeded
  OptionEffort failure;    ///< where it is impossible for what is hidden
  double detection = 1.0;  ///< probability that it succeeds where it is possible
  bool on_hidden = false;  ///< whether it is possible depends on what is hidden
  LookModel look;          ///< if so
};

struct OptionTrials
{
  double threshold = 0.85;  ///< belief that counts as knowledge
  std::size_t samples = 100;
  std::uint64_t seed = 0;
};

/// Simulates a low-level policy on its own model, half the runs where its high-level action is
/// possible and half where it is not.
/// @param prior  what is not met with in any run stays as it is here
[[nodiscard]] OptionModel simulatedOption(const LowLevelTask& begun, PolicyServer& policies,
                                          const std::string& policy, const OptionTrials& trials,
                                          const OptionModel& prior);

}  // namespace kr3::executive
