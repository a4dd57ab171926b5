#pragma once

#include <set>
#include <string>
#include <vector>

#include "proof_writer.hpp"

namespace kr3::reasoner
{

/// Explains what a history entails (docs/semantics_tests.md, row 10). Private to the package.
///
/// The minimal explanations E with the closures of what is known initially (worlds) come from the
/// solver. In one world entailment is monotonic, so a proof is found by propagation and cut down
/// to what it needs; each assumption is justified by the contradiction that the history without it
/// leads to. The solver then checks that the records, defaults and laws cited suffice, and takes
/// away what is superfluous; the proof is then made anew from what is left.
class Explainer
{
public:
  /// All must outlive this object.
  /// @param check  may be nullptr for justify()
  Explainer(const Description& description, const Words& words, const Instances& instances,
            const std::vector<CheckedRecord>& records, int current_step, const SearchLimit& limit,
            HistoryCheck* check)
    : description_(description)
    , words_(words)
    , instances_(instances)
    , records_(records)
    , laws_(description)
    , current_step_(current_step)
    , limit_(limit)
    , check_(check)
  {
  }

  /// @param literal  entailed at `step`
  [[nodiscard]] Explanation explain(const Literal& literal, int step);

  /// Fills in which records call for each assumption of a minimal explanation.
  /// @param known  by assumption: it is filled in already
  void justify(ExplanationAlternative& alternative, const std::vector<Clingo::Symbol>& assumed,
               const std::vector<bool>& known);

private:
  /// A proof in one world, or in several.
  struct Argument
  {
    Reason root;
    Cited cited;
  };

  [[nodiscard]] std::optional<Argument> argue(const Cited& kept, const Literal& literal, int step);
  [[nodiscard]] std::optional<Argument> argueIn(const Cited& kept, const InitialWorld& world,
                                                const Literal& literal, int step);
  [[nodiscard]] std::optional<Argument> necessity(const Cited& kept, const InitialWorld& world,
                                                  std::size_t assumption, const Atom& fluent);
  [[nodiscard]] Argument together(const Cited& kept, const Literal& literal, int step);
  void complete(Argument& argument, const Cited& kept, const Literal& literal, int step);
  [[nodiscard]] Cited withoutSuperfluous(const Cited& cited, const Literal& literal, int step);
  [[nodiscard]] static std::vector<std::string> sentencesOf(const Reason& reason);
  [[nodiscard]] Reason leafOf(const CitedItem& item) const;

  const Description& description_;
  const Words& words_;
  const Instances& instances_;
  const std::vector<CheckedRecord>& records_;
  const Laws laws_;
  int current_step_;
  const SearchLimit& limit_;
  HistoryCheck* check_;
};

}  // namespace kr3::reasoner
