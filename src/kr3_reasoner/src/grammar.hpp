#pragma once

#include <string>
#include <string_view>
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
  kTotality,
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

/// A node of the tree of one statement. `text` points into the text that was parsed.
struct Node
{
  Rule rule = Rule::kNone;
  std::string_view text;
  int line = 0;
  int column = 0;
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

/// The deepest nesting of parentheses and negations in a goal.
constexpr int kMaxDepth = 200;

/// The longest name, in characters.
constexpr std::size_t kMaxName = 255;

/// Parses one statement. On an error the tree's rule is kNone and `problems` gets what was found
/// and expected. The tree points into `text`.
///
/// @param start  where `text` stands
[[nodiscard]] Node parse(Kind kind, std::string_view text, const SourcePosition& start,
                         std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner::grammar
