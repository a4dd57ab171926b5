#pragma once

#include <atomic>
#include <chrono>
#include <string>

namespace kr3::reasoner
{

/// When a question has to end: never, unless something is set. Private to the package.
struct SearchLimit
{
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  const std::atomic<bool>* cancel = nullptr;
  const char* question = "planning";  ///< for the messages; outlives the limit

  [[nodiscard]] bool isSet() const
  {
    return cancel != nullptr || deadline != std::chrono::steady_clock::time_point::max();
  }

  [[nodiscard]] bool isReached() const
  {
    return (cancel != nullptr && cancel->load()) ||
           (deadline != std::chrono::steady_clock::time_point::max() &&
            std::chrono::steady_clock::now() > deadline);
  }

  /// @param what  what takes so long, for the message; may be empty
  /// @throws Cancelled, DeadlineExceeded  the limit is reached
  void check(const std::string& what) const;
  void check() const
  {
    if (isReached())
    {
      check("");
    }
  }
};

}  // namespace kr3::reasoner
