#pragma once

#include <fstream>
#include <string>

#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// CPU time of this process so far, of all its threads.
[[nodiscard]] double processCpuSeconds();

/// Writes how the bounds came nearer, for programs to read: one JSON object a line. The first is
/// the model (sizes, load time), the last the result; those between have the fields of the result.
///
/// A line follows another when the CPU time since the start of solving has grown by a fiftieth and
/// by 2 ms, so that long runs give short files. Not thread-safe.
class SolveTrace
{
public:
  /// @param path  empty = write nothing
  /// @throws Unavailable  the file cannot be written
  SolveTrace(const std::string& path, const Model& model, double load_cpu_s);

  /// CPU time since this object was made.
  [[nodiscard]] double cpuSeconds() const { return processCpuSeconds() - start_cpu_s_; }

  void add(const SolverProgress& progress, double cpu_s);
  /// @param reason  why solving ended, in words
  /// @throws Unavailable  the file could not be written
  void finish(const SolveResult& result, const std::string& reason);

private:
  void write(const SolverProgress& bounds, double cpu_s);

  std::string path_;
  std::ofstream out_;
  double start_cpu_s_;
  double next_cpu_s_ = 0.0;
};

}  // namespace kr3::pomdp
