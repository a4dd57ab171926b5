#pragma once

#include <optional>
#include <string>
#include <vector>

#include "beginning.hpp"
#include "history.hpp"
#include "instances.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

[[nodiscard]] std::string withoutSpaces(const std::string& text);

/// A literal as people read it: "tb1 was not in ..." is beyond us without
/// knowing the domain, so: "loc(tb1) was not office", and of a fluent in the
/// predicate form "loc(tb1, office) was not true".
[[nodiscard]] std::string inThePast(const Literal& literal, const Description& description);

/// The record with the file and line where it stands, if it stands in one.
[[nodiscard]] std::string withPlace(const Record& record);

/// "domain.kr3:12", or nothing when the position is in no file.
[[nodiscard]] std::string placeOf(const SourcePosition& position);

/// Several items as people list them: "a", "a and b", "a, b and c".
[[nodiscard]] std::string listed(const std::vector<std::string>& items);

/// The items that are not empty.
[[nodiscard]] std::vector<std::string> nonEmpty(const std::vector<std::string>& items);

/// A ground instance of a default.
struct GroundDefault
{
  const Default* rule = nullptr;
  std::string name;  ///< "d1(tb1)"
  Literal head;
  std::vector<Literal> body;  ///< without what is static
};

/// What an assumption says about an action.
struct AssumedAction
{
  Atom action;
  int step = -1;  ///< below 0: the assumption is about no action
  bool failed = false;
};

/// Says what an assumption `ab(X)` means. Composed from the description's own
/// names only.
class Words
{
public:
  /// All must outlive this object.
  /// @param beginning  of a history that was progressed; nullptr: it was not
  Words(const Description& description, const ReasonerOptions& options, const Instances& instances,
        const std::vector<CheckedRecord>& records, const Beginning* beginning = nullptr)
    : description_(description)
    , options_(options)
    , instances_(instances)
    , records_(records)
    , beginning_(beginning)
  {
  }

  /// A literal in the form in which the description declares its fluent.
  [[nodiscard]] std::string text(const Literal& literal) const
  {
    return toString(literal, description_);
  }

  /// The assumption with its price, without the records that call for it.
  [[nodiscard]] Assumption assumption(const Clingo::Symbol& assumed) const;

  /// "init(loc(tb1) = main_library, false)", "exo_move(tb1, office) at 2".
  [[nodiscard]] std::string statement(const Clingo::Symbol& assumed) const;

  /// "tb1 is an exception to default d1: initially loc(tb1) was not
  /// main_library".
  [[nodiscard]] std::string sentence(const Clingo::Symbol& assumed) const;

  /// The literal that an exception makes true.
  [[nodiscard]] Literal exception(const Clingo::Symbol& assumed) const;

  /// The ground defaults to which an assumption is an exception.
  [[nodiscard]] std::vector<GroundDefault> exceptedDefaults(const Clingo::Symbol& assumed) const;

  /// The ground defaults with a head about a fluent.
  [[nodiscard]] std::vector<GroundDefault> defaultsAbout(const Atom& fluent) const;

  [[nodiscard]] AssumedAction assumedAction(const Clingo::Symbol& assumed) const;

  /// The record that an assumption calls wrong, or kNoRecord; that too if it is no longer kept.
  [[nodiscard]] std::size_t wrongRecord(const Clingo::Symbol& assumed) const;

  /// A ground literal about a fluent that an assumption is about: what an exception makes true,
  /// what an action changes, what a record says; nothing when there is none.
  [[nodiscard]] std::optional<Literal> subject(const Clingo::Symbol& assumed) const;

  /// Whether an assumption is an exception to defaults.
  [[nodiscard]] bool isException(const Clingo::Symbol& assumed) const;

private:
  const Description& description_;
  const ReasonerOptions& options_;
  const Instances& instances_;
  const std::vector<CheckedRecord>& records_;
  const Beginning* beginning_;  // nullptr: step 0
};

}  // namespace kr3::reasoner
