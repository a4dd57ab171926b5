#include "paced_executor.hpp"

namespace kr3::executive
{

LowLevelResult PacedExecutor::execute(const LowLevelAction& action, const FluentLookup& believed,
                                      const std::atomic<bool>& cancel)
{
  struct Acting
  {
    LockstepConsumer& pace;
    explicit Acting(LockstepConsumer& paced) : pace(paced) { pace.release(); }
    ~Acting() { pace.pace(); }
    Acting(const Acting&) = delete;
    Acting& operator=(const Acting&) = delete;
  };
  const Acting acting(pace_);
  return inner_.execute(action, believed, cancel);
}

}  // namespace kr3::executive
