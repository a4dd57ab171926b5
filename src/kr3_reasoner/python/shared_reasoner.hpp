#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings.hpp"

namespace kr3::reasoner
{

/// Set from any thread to end a call of `plan`.
class Cancellation
{
public:
  void cancel() { flag_ = true; }
  [[nodiscard]] bool cancelled() const { return flag_; }

private:
  std::atomic<bool> flag_{false};
};

/// A Reasoner that several Python threads may use, one question at a time. The interpreter runs on
/// meanwhile, and Ctrl-C ends a question: it is asked in a thread of its own.
class SharedReasoner
{
public:
  SharedReasoner(Description description, ReasonerOptions options)
    : SharedReasoner(Reasoner(std::move(description), std::move(options)), std::make_shared<Turn>())
  {
  }

  /// What if? The two share what was made of the description, and so take turns.
  [[nodiscard]] std::unique_ptr<SharedReasoner> supposing(const std::vector<Record>& hypothetical)
  {
    Reasoner supposed = look([&](Reasoner& reasoner) { return reasoner.supposing(hypothetical); });
    return std::unique_ptr<SharedReasoner>(new SharedReasoner(std::move(supposed), turn_));
  }

  /// Of each question that follows; 0: none.
  void limitTime(std::chrono::milliseconds time_limit)
  {
    look([&](Reasoner& reasoner) { reasoner.setLimits({time_limit, &turn_->cancel}); });
  }

  /// What takes no time, asked at once. @param question  called with the Reasoner
  template <typename Question>
  std::invoke_result_t<Question, Reasoner&> look(Question question)
  {
    const pybind11::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(turn_->mutex);
    return question(reasoner_);
  }

  /// Asks a question that may take long. @throws pybind11::error_already_set  Ctrl-C
  template <typename Question>
  std::invoke_result_t<Question, Reasoner&> ask(
      Question question, const std::shared_ptr<Cancellation>& cancellation = {})
  {
    constexpr std::chrono::milliseconds kPoll(20);
    const pybind11::gil_scoped_release release;
    std::atomic<bool> started{false};
    auto answer = std::async(std::launch::async, [&] {
      const std::lock_guard<std::mutex> lock(turn_->mutex);
      turn_->cancel = false;
      started = true;
      return question(reasoner_);
    });
    bool by_signal = false;
    while (answer.wait_for(kPoll) != std::future_status::ready)
    {
      if (!by_signal)
      {
        const pybind11::gil_scoped_acquire acquire;
        by_signal = PyErr_CheckSignals() != 0;
      }
      if (started && (by_signal || (cancellation && cancellation->cancelled())))
      {
        turn_->cancel = true;  // before it started, this would end the question of another thread
      }
    }
    if (by_signal)
    {
      answer.wait();
      const pybind11::gil_scoped_acquire acquire;
      throw pybind11::error_already_set();
    }
    return answer.get();
  }

private:
  /// Shared with the reasoners that this one supposes.
  struct Turn
  {
    std::mutex mutex;                 // guards the reasoners
    std::atomic<bool> cancel{false};  // ends the question whose turn it is
  };

  SharedReasoner(Reasoner reasoner, std::shared_ptr<Turn> turn)
    : turn_(std::move(turn)), reasoner_(std::move(reasoner))
  {
    reasoner_.setLimits({std::chrono::milliseconds(0), &turn_->cancel});
  }

  std::shared_ptr<Turn> turn_;
  Reasoner reasoner_;
};

}  // namespace kr3::reasoner
