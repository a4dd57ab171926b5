#pragma once

#include <cstdint>

namespace kr3::pomdp
{

/// Splits work between trials and the belief grid by what each has gained of late. It counts
/// operations, not seconds, so that a run repeats.
class WorkSplit
{
public:
  /// Whether the grid is next.
  [[nodiscard]] bool gridIsDue() const;

  /// @param work  multiply-add operations
  /// @param gain  by how much the gap at the start fell, >= 0
  void addTrial(std::uint64_t work, double gain) { trials_.add(work, gain); }
  /// A round of the grid; what trials did since the last one is weighed against it.
  /// @param changed  whether it found anything to do
  void addRound(std::uint64_t work, double gain, bool changed);

private:
  struct Side
  {
    void add(std::uint64_t work, double gain);
    /// Counts what was added since the last call.
    void close();

    double work = 0.0;
    double recent_work = 0.0;
    double recent_gain = 0.0;
    double rate = 0.0;  // gain per work, the later the more
    bool rated = false;
  };

  Side trials_;
  Side grid_;
  bool exhausted_ = false;
};

}  // namespace kr3::pomdp
