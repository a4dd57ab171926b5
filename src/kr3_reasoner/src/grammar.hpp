#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

/// The concrete syntax: text to trees of named nodes. docs/language.md has the grammar. Private to
/// the package.
namespace kr3::reasoner::grammar
{

/// What a node stands for.
enum class Rule
{
  kNone,
  // Declarations.
  kSortDeclaration,
  kSet,
  kRange,
  kSortName,
  kFluentDeclaration,
  kFluentKind,
  kActionDeclaration,
  kExogenous,
  kParameters,
  kValueSort,
  // Axioms and the rest.
  kCausalLaw,
  kOutcome,
  kNothing,
  kLabel,
  kEffect,
  kChoice,
  kImpossible,
  kConstraint,
  kFalse,
  kBody,
  kObservationLaw,
  kDefault,
  kFact,
  kMagnification,
  kPreference,
  kCost,
  kDecimal,
  // Parts of formulas.
  kAtom,
  kArguments,
  kName,
  kVariable,
  kNumber,
  kNot,
  kMinus,
  kRelation,
  kCondition,
  // History records and goals.
  kRecord,
  kRecordKind,
  kDisjunction,
  kConjunction,
  kNegation,
};

/// A node of the tree of one statement.
struct Node
{
  Rule rule = Rule::kNone;
  std::string text;
  SourcePosition position;
  std::vector<Node> children;

  /// The first child of a kind, or nullptr.
  [[nodiscard]] const Node* child(Rule wanted) const;
};

/// What a statement may be.
enum class Kind
{
  kSort,
  kStatic,
  kFluent,
  kAction,
  kAxiom,
  kObservation,
  kDefault,
  kFact,
  kRecord,         ///< of a history
  kGroundLiteral,  ///< without a final dot
  kGroundAction,   ///< without a final dot
  kGoal,           ///< without a final dot
};

/// A statement of a file before it is parsed: its text up to the final dot, and the section it
/// stands in.
struct Chunk
{
  std::string section;  ///< empty before the first section
  std::string text;
  SourcePosition position;
};

/// Cuts a file into statements, so that an error in one does not hide those in the next.
[[nodiscard]] std::vector<Chunk> split(const std::string& text, const std::string& file);

/// Parses one statement. On an error the tree's rule is kNone and `problems` gets what was found
/// and expected.
[[nodiscard]] Node parse(Kind kind, const std::string& text, const SourcePosition& start,
                         std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner::grammar
