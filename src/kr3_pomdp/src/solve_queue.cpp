#include "kr3_pomdp/solve_queue.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

using Clock = std::chrono::steady_clock;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastTimeS = 1e-3;  // for solving, when reading took all the time

double secondsSince(Clock::time_point time)
{
  return std::chrono::duration<double>(Clock::now() - time).count();
}

Clock::duration durationOf(double seconds)
{
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// A deadline for what may wait for ever; wait_until with the clock's greatest time overflows.
Clock::time_point deadlineAfter(double seconds)
{
  constexpr double kLongS = 1e8;
  return Clock::now() + durationOf(std::min(seconds, kLongS));
}

/// Only this thread gets nicer, and those it starts.
void beNice(int niceness)
{
  if (niceness > 0)
  {
    // Solving works without it, only less politely.
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), niceness);
  }
}

std::exception_ptr cancelledError()
{
  return std::make_exception_ptr(Cancelled("cancelled before there was a policy"));
}

}  // namespace

struct SolveQueue::Job
{
  std::string key;
  SolveRequest request;
  Callbacks callbacks;
  std::atomic<bool> cancel{false};
  std::mutex calling;                             // held while a callback runs
  bool answered = false;                          // guarded by `calling`
  std::optional<Clock::time_point> cancelled_at;  // guarded by the queue's mutex
};

class SolveQueue::Impl
{
public:
  using JobPtr = std::shared_ptr<Job>;

  Impl(std::shared_ptr<PolicyStore> store, const Options& options)
    : store_(std::move(store)), options_(options)
  {
  }

  void submit(const JobPtr& job);
  std::size_t cancelIf(const std::function<bool(const std::string&)>& matches);
  void work();
  void watch();
  /// No callbacks from now on, and threads end as soon as they can.
  void close();
  /// @return whether all threads have ended
  bool waitForThreads(double patience_s);

  mutable std::mutex mutex_;  // guards what follows
  std::deque<JobPtr> waiting_;
  std::vector<JobPtr> running_;
  std::size_t num_threads_ = 0;  // that have not ended
  std::uint64_t num_solved_ = 0;
  std::uint64_t num_cached_ = 0;
  std::condition_variable changed_;

private:
  /// The first request that is not solved already by another thread; with the mutex held.
  std::deque<JobPtr>::iterator next();
  SolveOutcome run(const JobPtr& job);
  SolveOutcome solveNow(const JobPtr& job);
  std::optional<SolveOutcome> known(const Job& job);
  void report(const JobPtr& job, const SolveReport& report);
  void answer(const JobPtr& job, const SolveOutcome& outcome);
  void reportPlaces();

  const std::shared_ptr<PolicyStore> store_;
  const Options options_;
  std::atomic<bool> closed_{false};
};

void SolveQueue::Impl::report(const JobPtr& job, const SolveReport& report)
{
  const std::lock_guard<std::mutex> lock(job->calling);
  if (!job->answered && !closed_ && job->callbacks.report)
  {
    job->callbacks.report(report);
  }
}

void SolveQueue::Impl::answer(const JobPtr& job, const SolveOutcome& outcome)
{
  const std::lock_guard<std::mutex> lock(job->calling);
  if (!std::exchange(job->answered, true) && !closed_)
  {
    job->callbacks.done(outcome);
  }
}

std::optional<SolveOutcome> SolveQueue::Impl::known(const Job& job)
{
  if (job.request.ignore_cache)
  {
    return std::nullopt;
  }
  const auto found = store_->find(job.request.model, job.request.limits);
  if (!found)
  {
    return std::nullopt;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  ++num_cached_;
  return SolveOutcome{found->id, found->solved, true, false, nullptr};
}

void SolveQueue::Impl::submit(const JobPtr& job)
{
  if (const auto outcome = known(*job))
  {
    answer(job, *outcome);
    return;
  }
  std::size_t num_ahead = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_)
    {
      throw FailedPrecondition("the solver has stopped");
    }
    if (waiting_.size() >= options_.max_waiting)
    {
      throw ResourceExhausted(std::to_string(waiting_.size()) +
                              " models wait to be solved, no more are taken: try again later");
    }
    num_ahead = waiting_.size() + running_.size();
    waiting_.push_back(job);
  }
  if (num_ahead >= static_cast<std::size_t>(options_.num_workers))
  {
    report(job, {SolvePhase::kQueued, num_ahead, {-kInfinity, kInfinity, 0, 0, 0.0, 0}});
  }
  changed_.notify_all();
}

std::size_t SolveQueue::Impl::cancelIf(const std::function<bool(const std::string&)>& matches)
{
  std::vector<JobPtr> ended;
  std::size_t num_cancelled = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const JobPtr& job : waiting_)
    {
      if (matches(job->key))
      {
        ended.push_back(job);
      }
    }
    for (const JobPtr& job : ended)
    {
      waiting_.erase(std::find(waiting_.begin(), waiting_.end(), job));
    }
    for (const JobPtr& job : running_)
    {
      if (matches(job->key) && !job->cancel.exchange(true))
      {
        job->cancelled_at = Clock::now();
        ++num_cancelled;
      }
    }
  }
  for (const JobPtr& job : ended)
  {
    answer(job, {"", nullptr, false, true, cancelledError()});
  }
  if (!ended.empty())
  {
    reportPlaces();
  }
  changed_.notify_all();
  return num_cancelled + ended.size();
}

std::deque<SolveQueue::Impl::JobPtr>::iterator SolveQueue::Impl::next()
{
  const auto running = [this](const JobPtr& job) {
    return std::any_of(running_.begin(), running_.end(), [&job](const JobPtr& other) {
      return !job->request.ignore_cache && !other->cancel &&
             sameLimits(other->request.limits, job->request.limits) &&
             other->request.model == job->request.model;
    });
  };
  return std::find_if(waiting_.begin(), waiting_.end(),
                      [&running](const JobPtr& job) { return !running(job); });
}

void SolveQueue::Impl::reportPlaces()
{
  std::vector<JobPtr> waiting;
  std::size_t num_ahead = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting.assign(waiting_.begin(), waiting_.end());
    num_ahead = running_.size();
  }
  for (const JobPtr& job : waiting)
  {
    report(job, {SolvePhase::kQueued, num_ahead++, {-kInfinity, kInfinity, 0, 0, 0.0, 0}});
  }
}

void SolveQueue::Impl::work()
{
  beNice(options_.niceness);
  std::unique_lock<std::mutex> lock(mutex_);
  while (!closed_)
  {
    const auto first = next();
    if (first == waiting_.end())
    {
      changed_.wait(lock);
      continue;
    }
    const JobPtr job = *first;
    waiting_.erase(first);
    running_.push_back(job);
    lock.unlock();
    reportPlaces();
    const SolveOutcome outcome = run(job);
    lock.lock();
    running_.erase(std::find(running_.begin(), running_.end(), job));
    lock.unlock();
    answer(job, outcome);
    changed_.notify_all();  // what waited for the same content may start
    lock.lock();
  }
}

SolveOutcome SolveQueue::Impl::run(const JobPtr& job)
{
  try
  {
    if (const auto outcome = known(*job))
    {
      return *outcome;
    }
    return solveNow(job);
  }
  catch (const std::bad_alloc&)
  {
    return {"", nullptr, false, job->cancel,
            std::make_exception_ptr(ResourceExhausted("out of memory while solving the model"))};
  }
  catch (...)
  {
    return {"", nullptr, false, job->cancel, std::current_exception()};
  }
}

SolveOutcome SolveQueue::Impl::solveNow(const JobPtr& job)
{
  const Clock::time_point start = Clock::now();
  const auto may_go_on = [this, &job] { return !job->cancel && !closed_; };
  const SolveRequest& request = job->request;
  report(job, {SolvePhase::kReading, 0, {-kInfinity, kInfinity, 0, 0, 0.0, 0}});
  std::shared_ptr<const NamedModel> source = store_->findModel(request.model);
  if (!source)
  {
    ReadOptions read = options_.read;
    read.keep_going = may_go_on;
    source = std::make_shared<const NamedModel>(
        NamedModel{request.model, readModel(request.model, "model", read)});
  }
  if (!may_go_on())
  {
    throw Cancelled("cancelled before there was a policy");
  }
  SolverLimits limits = request.limits;
  if (limits.time_s > 0.0)
  {
    limits.time_s = std::max(kLeastTimeS, limits.time_s - secondsSince(start));
  }
  double next_report_s = 0.0;
  SolveResult result = solve(source->model, limits, [&](const SolverProgress& progress) {
    if (progress.elapsed_s >= next_report_s)
    {
      report(job, {SolvePhase::kSolving, 0, progress});
      next_report_s = progress.elapsed_s + options_.report_period_s;
    }
    return may_go_on();
  });
  const bool cancelled = result.reason == StopReason::kCancelled;
  auto solved = std::make_shared<const SolvedModel>(
      solvedModel(std::move(source), request.limits, std::move(result)));
  std::string id = store_->put(solved);
  const std::lock_guard<std::mutex> lock(mutex_);
  ++num_solved_;
  return {std::move(id), std::move(solved), false, cancelled, nullptr};
}

void SolveQueue::Impl::watch()
{
  const auto grace = durationOf(options_.grace_s);
  std::unique_lock<std::mutex> lock(mutex_);
  while (!closed_)
  {
    std::vector<JobPtr> overdue;
    Clock::time_point next = deadlineAfter(kInfinity);
    for (const JobPtr& job : running_)
    {
      if (job->cancelled_at && *job->cancelled_at + grace <= Clock::now())
      {
        overdue.push_back(job);
        job->cancelled_at.reset();
      }
      else if (job->cancelled_at)
      {
        next = std::min(next, *job->cancelled_at + grace);
      }
    }
    if (overdue.empty())
    {
      changed_.wait_until(lock, next);
      continue;
    }
    lock.unlock();
    for (const JobPtr& job : overdue)
    {
      answer(job, {"", nullptr, false, true, cancelledError()});
    }
    lock.lock();
  }
}

void SolveQueue::Impl::close()
{
  std::vector<JobPtr> jobs;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    jobs = running_;
    waiting_.clear();
  }
  for (const JobPtr& job : jobs)
  {
    job->cancel = true;
    // Whoever calls back now ends before this returns.
    const std::lock_guard<std::mutex> lock(job->calling);
  }
  changed_.notify_all();
}

bool SolveQueue::Impl::waitForThreads(double patience_s)
{
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_until(lock, deadlineAfter(patience_s), [this] { return num_threads_ == 0; });
}

SolveQueue::SolveQueue(std::shared_ptr<PolicyStore> store, const Options& options)
{
  if (!store || options.num_workers < 1 || !(options.report_period_s > 0.0) ||
      !(options.grace_s >= 0.0) || options.niceness < 0 || options.niceness > 19)
  {
    throw InvalidArgument(
        "a queue without store or worker, with a period that is not positive, a negative grace, or "
        "a niceness outside [0, 19]");
  }
  impl_ = std::make_shared<Impl>(std::move(store), options);
  const auto start = [this](void (Impl::*member)()) {
    {
      const std::lock_guard<std::mutex> lock(impl_->mutex_);
      ++impl_->num_threads_;
    }
    // Detached, for stop() waits by count: a thread that cannot be interrupted may outlive this
    // object, and holds what it needs.
    std::thread([impl = impl_, member] {
      (*impl.*member)();
      const std::lock_guard<std::mutex> lock(impl->mutex_);
      --impl->num_threads_;
      impl->changed_.notify_all();
    }).detach();
  };
  for (int i = 0; i < options.num_workers; ++i)
  {
    start(&Impl::work);
  }
  start(&Impl::watch);
}

SolveQueue::~SolveQueue()
{
  stop(kInfinity);
}

void SolveQueue::submit(const std::string& key, SolveRequest request, Callbacks callbacks)
{
  const auto job = std::make_shared<Job>();
  job->key = key;
  job->request = std::move(request);
  job->callbacks = std::move(callbacks);
  impl_->submit(job);
}

std::size_t SolveQueue::cancelIf(const std::function<bool(const std::string&)>& matches)
{
  return impl_->cancelIf(matches);
}

bool SolveQueue::stop(double patience_s)
{
  impl_->close();
  return impl_->waitForThreads(patience_s);
}

std::size_t SolveQueue::numWaiting() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  return impl_->waiting_.size();
}

std::size_t SolveQueue::numRunning() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  return impl_->running_.size();
}

std::uint64_t SolveQueue::numSolved() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  return impl_->num_solved_;
}

std::uint64_t SolveQueue::numCached() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  return impl_->num_cached_;
}

}  // namespace kr3::pomdp
