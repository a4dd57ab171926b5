#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

/// Answers that say why (docs/semantics_tests.md, rows 6, 9, 10 and 11). Plain values.
namespace kr3::reasoner
{

/// How a literal is known. The words are those of the history and of the
/// description.
enum class ReasonKind : std::uint8_t
{
  kObserved = 0,        ///< a record says so
  kHappened = 1,        ///< a record says that the action happened, or was attempted
                        ///< and did not fail
  kCaused = 2,          ///< an effect of an action that happened, by a causal law
  kInertia = 3,         ///< it was so at another step, and nothing in between can change it
  kConstraint = 4,      ///< by a state constraint
  kDefinition = 5,      ///< by the axioms of a defined fluent
  kExecutability = 6,   ///< an action happened that would have been impossible otherwise
  kOnlyValue = 7,       ///< every other value of the fluent is excluded
  kStatic = 8,          ///< a fact of the description
  kDefault = 9,         ///< the head of a default that applies initially
  kException = 10,      ///< the contrary of a default's head, assumed to explain the history
  kAssumed = 11,        ///< an exogenous action, a failed attempt or a wrong record,
                        ///< assumed likewise
  kChange = 12,         ///< it changed, and only these actions and laws can have changed it
  kContradiction = 13,  ///< the contrary, supposed, leads to a contradiction
  kSupposed = 14,       ///< what a contradiction or a case supposes
  kCases = 15,          ///< it holds in each of the cases that are left
  kTogether = 16,       ///< the records and defaults below entail it together
  kAgain = 17,          ///< shown before in the same proof
  kCarried = 18,        ///< known when the history was progressed
};

/// "record" of a Reason that rests on none.
constexpr std::size_t kNoRecord = std::numeric_limits<std::size_t>::max();

/// A node of a proof. Its children are what it rests on.
struct Reason
{
  ReasonKind kind = ReasonKind::kTogether;
  std::string statement;  ///< what is known: a ground literal or action; empty
                          ///< for a contradiction
  int step = 0;
  std::size_t record = kNoRecord;  ///< index into the history: kObserved, kHappened, kAssumed
  std::string default_name;        ///< ground, as "d1(tb1)": kDefault, kException
  SourcePosition position;         ///< of the law, constraint, definition or default;
                                   ///< of the record
  std::string sentence;            ///< this node in words, without its children
  std::vector<Reason> children;
};

enum class LawKind : std::uint8_t
{
  kCausal = 0,
  kConstraint = 1,
  kDefinition = 2,     ///< all the rules of a defined fluent
  kExecutability = 3,  ///< of one action
};

/// A law of the description that an explanation rests on.
struct CitedLaw
{
  LawKind kind = LawKind::kCausal;
  std::string about;  ///< the action, or the fluent of the head; empty for `false if ...`
  std::vector<SourcePosition> positions;  ///< of its rules: several for a definition
};

/// Why a literal is entailed (docs/semantics_tests.md, row 10).
///
/// What is cited are records, ground defaults and laws. *Sufficient*: the history of these records
/// under the description with these defaults and laws only entails the literal. *Minimal*: without
/// one of them it does not. Sorts, statics, inertia, preferences and conditions on several actions
/// at once always stay, and a defined fluent whose definition is left out may be true or false.
/// What keeps something else from interfering is therefore not cited, and what was observed is not
/// explained by a default that would have said the same.
struct Explanation
{
  bool entailed = false;
  std::vector<std::string> reasons;  ///< in words, from the literal itself down to what it rests on
  std::vector<std::string> records;  ///< the records it rests on
  std::vector<std::size_t> record_indices;  ///< the same, as indices into the history
  std::vector<std::string> defaults;        ///< ground defaults it rests on, "d1(tb1)"
  std::vector<CitedLaw> laws;               ///< it rests on
  Reason proof;                             ///< meaningful when entailed
};

/// The ground default whose head is the first in the proof; where no proof has one, the first that
/// is cited; empty when the literal rests on none.
[[nodiscard]] std::string defaultBehind(const Explanation& explanation);

/// What is open about a literal, and what would settle it.
struct OpenQuestion
{
  bool open = false;                  ///< whether the literal is possible, and not entailed
  std::vector<std::string> values;    ///< that its fluent may have at the step, as in its sort
  std::vector<std::string> deciding;  ///< fluents whose value at the current step would settle it
  std::vector<std::string> reasons;   ///< in words, one sentence each
};

enum class AssumptionKind : std::uint8_t
{
  kException = 0,    ///< to a default
  kExogenous = 1,    ///< an exogenous action
  kFailure = 2,      ///< of an attempt
  kWrongRecord = 3,  ///< a sensing error
};

/// One element of an explanation E (Zhang et al. 2014, Definition 2, with the
/// extensions of docs/semantics_tests.md, rows 3, 5 and 6).
struct Assumption
{
  AssumptionKind kind = AssumptionKind::kException;
  std::string statement;              ///< "init(loc(tb1) = main_library, false)",
                                      ///< "exo_move(tb1, office) at 2"
  std::string sentence;               ///< in words
  int price = 0;                      ///< of a wrong record: 100 times its log-odds
  std::vector<std::string> defaults;  ///< ground, to which this is an exception
  std::vector<std::size_t> because;   ///< records that contradict the history without it; of the
                                      ///< first eight alternatives of a diagnosis only
  std::string because_in_words;       ///< empty when no proof was found within bounds
};

/// One minimal explanation of a history.
struct ExplanationAlternative
{
  std::vector<Assumption> assumptions;
  int price = 0;
  std::string in_words;
};

/// Doubtful records (confidence below 1) that would have to be given up
/// together; no subset would do.
struct Retraction
{
  std::vector<std::size_t> records;  ///< indices into the history
  double log_odds = 0.0;             ///< sum over the records; the smaller, the more doubtful
  std::string opens;                 ///< the literal that becomes possible; empty: consistency
  std::string in_words;
};

}  // namespace kr3::reasoner
