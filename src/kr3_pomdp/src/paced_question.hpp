#pragma once

#include <cstddef>
#include <functional>

namespace kr3::pomdp
{

/// Asks whether to go on once in some work: on small models reading the clock for each piece of a
/// sweep takes longer than the sweep.
class PacedQuestion
{
public:
  /// @param keep_going  outlives this object
  explicit PacedQuestion(const std::function<bool()>& keep_going) : keep_going_(&keep_going) {}

  /// @param work  about to be done: rows, each of a few entries
  [[nodiscard]] bool operator()(std::size_t work)
  {
    work_ += work;
    if (work_ < kPeriod)
    {
      return true;
    }
    work_ = 0;
    return (*keep_going_)();
  }

private:
  static constexpr std::size_t kPeriod = 5000;  // some tens of microseconds

  const std::function<bool()>* keep_going_;
  std::size_t work_ = kPeriod;  // the first question is asked
};

}  // namespace kr3::pomdp
