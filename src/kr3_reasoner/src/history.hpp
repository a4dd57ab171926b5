#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// A record whose statement has been parsed. Private to the package.
struct CheckedRecord
{
  Record record;
  Literal
      literal;  ///< of an observation; its value is folded in: `obs(f = v, false, i)` is `f != v`
  Atom action;  ///< of an action

  [[nodiscard]] bool isAction() const
  {
    return record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
  }
};

/// @throws InvalidArgument  the statement does not fit the description, or a number is out of range
[[nodiscard]] CheckedRecord checkRecord(const Record& record, const Symbols& symbols);

/// 100 times the log-odds that an uncertain record is right, at least 1.
[[nodiscard]] int doubtOf(const Record& record);

/// The literal that is true exactly when `literal` is false.
[[nodiscard]] Literal contrary(const Literal& literal, const Description& description);

/// `f != true` of a boolean fluent becomes `f = false`; any other literal stays.
[[nodiscard]] Literal normalized(Literal literal, const Description& description);

}  // namespace kr3::reasoner
