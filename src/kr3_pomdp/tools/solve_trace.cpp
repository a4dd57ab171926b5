#include "solve_trace.hpp"

#include <algorithm>
#include <ctime>
#include <iomanip>
#include <limits>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr double kGrowth = 1.02;
constexpr double kLeastStepS = 0.002;

/// Greatest resident memory of this program so far; 0 where the system does not tell. (getrusage
/// also counts what the process held before it became this program.)
std::size_t peakBytes()
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
  {
    if (line.rfind("VmHWM:", 0) == 0)
    {
      return std::stoull(line.substr(6)) * 1024;
    }
  }
  return 0;
}

}  // namespace

double processCpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

SolveTrace::SolveTrace(const std::string& path, const Model& model, double load_cpu_s)
  : path_(path), start_cpu_s_(processCpuSeconds())
{
  if (path.empty())
  {
    return;
  }
  out_.open(path);
  out_ << std::setprecision(std::numeric_limits<double>::max_digits10)
       << "{\"states\": " << model.numStates() << ", \"actions\": " << model.numActions()
       << ", \"observations\": " << model.numObservations() << ", \"load_cpu_s\": " << load_cpu_s
       << ", \"load_peak_bytes\": " << peakBytes() << "}" << std::endl;  // read while it solves
  if (!out_)
  {
    throw Unavailable("cannot write '" + path + "'");
  }
}

void SolveTrace::add(const SolverProgress& progress, double cpu_s)
{
  if (!path_.empty() && cpu_s >= next_cpu_s_)
  {
    write(progress, cpu_s);
    out_ << "}\n";
    next_cpu_s_ = std::max(cpu_s * kGrowth, cpu_s + kLeastStepS);
  }
}

void SolveTrace::finish(const SolveResult& result, const std::string& reason)
{
  if (path_.empty())
  {
    return;
  }
  write({result.lower, result.upper, result.backups, result.policy.numAlphaVectors(),
         result.elapsed_s, result.memory_bytes},
        cpuSeconds());
  out_ << ", \"stopped\": \"" << reason << "\"}\n";
  out_.close();
  if (!out_)
  {
    throw Unavailable("cannot write '" + path_ + "'");
  }
}

void SolveTrace::write(const SolverProgress& bounds, double cpu_s)
{
  out_ << "{\"cpu_s\": " << cpu_s << ", \"elapsed_s\": " << bounds.elapsed_s
       << ", \"lower\": " << bounds.lower << ", \"upper\": " << bounds.upper
       << ", \"backups\": " << bounds.backups << ", \"vectors\": " << bounds.num_alpha_vectors
       << ", \"search_bytes\": " << bounds.memory_bytes << ", \"peak_bytes\": " << peakBytes();
}

}  // namespace kr3::pomdp
