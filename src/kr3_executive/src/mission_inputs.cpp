#include "mission_inputs.hpp"

#include <string>

#include <kr3_common/error.hpp>

namespace kr3::executive
{

LowLevelResult executeNoting(LowLevelExecutor& executor, const LowLevelAction& action,
                             const FluentLookup& believed, std::uint32_t max_retries,
                             const std::atomic<bool>& cancel,
                             const std::function<void(const Input&)>& note)
{
  for (std::uint32_t attempt = 0;; ++attempt)
  {
    try
    {
      LowLevelResult result = executor.execute(action, believed, cancel);
      note(SkillEnded{action, ErrorCode::kOk, {}, result});
      return result;
    }
    catch (const Error& e)
    {
      note(SkillEnded{action, e.code(), e.what(), {}});
      const bool may_retry =
          e.code() == ErrorCode::kUnavailable || e.code() == ErrorCode::kDeadlineExceeded;
      if (!may_retry || attempt >= max_retries || cancel)
        throw;
    }
  }
}

reasoner::Record checkedFact(const reasoner::Record& record,
                             const reasoner::Description& high_level)
{
  const auto literal = reasoner::parseGroundLiteral(record.statement, high_level);
  if (!(record.confidence > 0.0 && record.confidence <= 1.0))
    throw InvalidArgument("confidence " + std::to_string(record.confidence) + ", expected (0, 1]");
  reasoner::Record told = record;
  told.kind = reasoner::RecordKind::kObserved;
  told.statement = reasoner::toString(literal);
  return told;
}

}  // namespace kr3::executive
