#pragma once

#include <memory>
#include <string>
#include <vector>

#include "history_program.hpp"
#include "local_table.hpp"

namespace kr3::reasoner
{

/// Progresses histories to later first steps (docs/semantics_tests.md, row 11). Private to the
/// package; not thread-safe.
///
/// The history before the new first step is unrolled once for each kind of assumption and falls
/// into components that share no rule. A component's table has a row for each combination of values
/// that its fluents may have at the new first step, whatever has to be assumed for it. No answer
/// about later steps depends on more: what explains the whole history best is, for some rows, what
/// explains each of these best together with what explains the rest from there on.
class Progression
{
public:
  explicit Progression(const TableLimits& limits) : limits_(limits), tables_(limits) {}

  struct Result
  {
    std::shared_ptr<const Beginning> beginning;  ///< nullptr: it cannot be represented
    std::vector<std::string> obstacles;          ///< why not, in words
  };

  /// The beginning at a step after the program's first one, in place of the records before it.
  /// @throws FailedPrecondition  the records before the step are inconsistent
  [[nodiscard]] Result progressed(const HistoryProgram& program,
                                  const std::vector<CheckedRecord>& records, int step);

private:
  class Level;

  TableLimits limits_;
  LocalTables tables_;
};

}  // namespace kr3::reasoner
