#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <clingo.hh>

#include "assumable.hpp"
#include "history.hpp"
#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Something that explanations of records which are no longer kept assume.
struct CarriedAssumption
{
  Clingo::Symbol what;  ///< as in HistoryProgram, but `wrong(-1-I)` is Beginning::retractable[I]
  int price;
  bool is_retraction;
};

/// A ground fluent, not a defined one, that may have several values at the first step.
struct OpenFluent
{
  Atom atom;
  std::vector<std::string> values;  ///< those it may have
};

/// A combination of values with the cheapest ways in which it can have come about.
struct BeginningRow
{
  std::vector<std::size_t> values;  ///< by fluent of the component, indices into its values

  /// At least one; each a set of indices into the component's assumptions. All have the same price.
  std::vector<std::vector<std::size_t>> explanations;
};

/// Fluents whose values hang together, with their combinations. A component without fluents has one
/// row: what had to be assumed once and for all.
struct BeginningComponent
{
  std::vector<OpenFluent> fluents;
  std::vector<CarriedAssumption> assumptions;
  std::vector<BeginningRow> rows;  ///< at least one
};

/// What is possible at the first step when certain kinds of assumption may be made.
struct BeginningLevel
{
  bool consistent = true;  ///< otherwise these assumptions do not explain the earlier records
  std::vector<BeginningComponent> components;
};

/// What the records before a step say about that step: the history begins there, and they need not
/// be kept (docs/semantics_tests.md, row 11). Private to the package.
///
/// The least price of a state at the first step is the sum of those of its components' rows, for
/// each of the levels of findOptimum.
struct Beginning
{
  int first_step = 0;
  std::size_t num_records = 0;  ///< that are no longer kept
  bool uncertain = false;       ///< one of them had a confidence below 1
  std::vector<Literal> facts;   ///< `f = v` of fluents that have one value at every level
  std::array<std::shared_ptr<const BeginningLevel>, kNumAssumables> levels;
  std::vector<CheckedRecord> retractable;  ///< those that an explanation takes to be wrong

  [[nodiscard]] const BeginningLevel& level(const Assumable& assumable) const
  {
    return *levels[indexOf(assumable)];
  }
};

/// The first step of a history with this beginning; nullptr: 0.
[[nodiscard]] int firstStepOf(const Beginning* beginning);

/// The record that `wrong(R)` is about.
[[nodiscard]] const Record& recordOf(int number, const std::vector<CheckedRecord>& records,
                                     const Beginning* beginning);

/// The rules of one level as text, for HistoryProgram; they hold while `begun` and `guard` do.
/// @param number  tells levels apart
[[nodiscard]] std::string levelRules(const BeginningLevel& level, std::size_t number,
                                     const std::string& guard, int first_step);

/// The facts as text; they hold while `begun` does.
[[nodiscard]] std::string factRules(const Beginning& beginning);

}  // namespace kr3::reasoner
