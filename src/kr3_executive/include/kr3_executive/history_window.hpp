#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>

namespace kr3::executive
{

/// When the reasoner's copy of a history is progressed (docs/progression.md), so that long missions
/// stay fast, and which records it then still has. Both reasoners of the executive follow it, so
/// that they answer alike. The history itself is kept whole.
class HistoryWindow
{
public:
  /// @param steps  that are kept one by one; progressed when there are half as many again. 0: never
  explicit HistoryWindow(std::uint32_t steps) : steps_(static_cast<int>(steps)) {}

  /// The whole history was told anew: it begins at step 0.
  void reset(std::vector<reasoner::Record> records);
  void add(const std::vector<reasoner::Record>& records);

  [[nodiscard]] const std::vector<reasoner::Record>& all() const { return all_; }
  /// The step at which the history should begin now; nothing while it is short.
  [[nodiscard]] std::optional<int> due() const;
  /// The history begins at this step now, be it the one wished for or not.
  void beginsAt(int step) { first_step_ = step; }
  [[nodiscard]] int firstStep() const { return first_step_; }

  /// Indices among all records of those that the reasoner counts among what it keeps.
  /// @throws InternalError  it keeps fewer
  [[nodiscard]] std::vector<std::size_t> amongAll(const std::vector<std::size_t>& kept) const;

private:
  int steps_;
  std::vector<reasoner::Record> all_;
  int first_step_ = 0;
};

}  // namespace kr3::executive
