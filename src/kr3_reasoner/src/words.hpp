#pragma once

#include <string>
#include <vector>

#include "history.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

[[nodiscard]] std::string withoutSpaces(const std::string& text);

/// A literal as people read it: "tb1 was not in ..." is beyond us without knowing the domain, so:
/// "loc(tb1) was not office".
[[nodiscard]] std::string inThePast(const Literal& literal);

/// Says what an assumption `ab(X)` means. Composed from the description's own names only.
class Words
{
public:
  /// Both must outlive this object.
  Words(const Description& description, const std::vector<CheckedRecord>& records)
    : description_(description), records_(records)
  {
  }

  /// "init(loc(tb1) = main_library, false)", "exo_move(tb1, office) at 2".
  [[nodiscard]] std::string statement(const Clingo::Symbol& assumed) const;

  /// "tb1 is an exception to default d1: initially loc(tb1) was not main_library".
  [[nodiscard]] std::string sentence(const Clingo::Symbol& assumed) const;

  /// The literal that an exception makes true.
  [[nodiscard]] Literal exception(const Clingo::Symbol& assumed) const;

private:
  [[nodiscard]] std::string exceptedDefaults(const Clingo::Symbol& assumed) const;

  const Description& description_;
  const std::vector<CheckedRecord>& records_;
};

}  // namespace kr3::reasoner
