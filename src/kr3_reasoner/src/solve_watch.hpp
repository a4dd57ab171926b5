#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include <clingo.hh>

#include "search_limit.hpp"

namespace kr3::reasoner
{

/// Interrupts a solver from a thread of its own when a limit is reached, so that solving needs no
/// thread for each call. Private to the package.
class SolveWatch
{
public:
  /// @param control  must outlive the watch
  SolveWatch(Clingo::Control& control, const SearchLimit& limit);
  ~SolveWatch();
  SolveWatch(const SolveWatch&) = delete;
  SolveWatch& operator=(const SolveWatch&) = delete;

  /// @throws Cancelled, DeadlineExceeded  the limit is reached
  /// @param what  what takes so long, for the message
  void check(const std::string& what) const { limit_.check(what); }

private:
  void run();

  Clingo::Control& control_;
  SearchLimit limit_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace kr3::reasoner
