#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

const char* toString(StopReason reason)
{
  switch (reason)
  {
    case StopReason::kPrecision:
      return "precision";
    case StopReason::kTimeLimit:
      return "time limit";
    case StopReason::kBackupLimit:
      return "backup limit";
    case StopReason::kCancelled:
      return "cancelled";
    case StopReason::kMemoryLimit:
      return "memory limit";
  }
  return "unknown";
}

}  // namespace kr3::pomdp
