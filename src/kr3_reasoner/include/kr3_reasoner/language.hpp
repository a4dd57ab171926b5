#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

/// The abstract syntax of KR3's action language, for the high level and the low level alike.
///
/// The language is AL_d: AL (Gelfond and Kahl 2014, ch. 8) with functional fluents and
/// non-deterministic causal laws (Sridharan, Gelfond, Zhang and Wyatt, JAIR 65, 2019, sec. 3),
/// defaults, preferences among them, and what a refinement adds: magnified sorts, knowledge
/// fluents, labelled outcomes and observations. docs/language.md has the grammar.
///
/// All types are plain values; a Description that `parseDescription` returned has passed every
/// check of the language.
namespace kr3::reasoner
{

/// Where something stands in a file; line and column count from 1.
struct SourcePosition
{
  std::string file;
  int line = 0;
  int column = 0;
};

/// A constant (`office`, `3`) or a variable (`R`).
struct Term
{
  bool is_variable = false;
  std::string name;

  bool operator==(const Term& other) const
  {
    return is_variable == other.is_variable && name == other.name;
  }
};

/// A name applied to terms: `loc(R)`, `move(rob1, P)`, `d1(X)`.
struct Atom
{
  std::string name;
  std::vector<Term> arguments;
  SourcePosition position;
};

/// `atom = value` or `atom != value`. For a boolean fluent the value is the constant `true` or
/// `false`: `in_hand(R, O)` is `in_hand(R, O) = true` and `-in_hand(R, O)` is `in_hand(R, O) =
/// false`.
struct Literal
{
  Atom atom;
  Term value;
  bool equal = true;
};

/// `X = Y`, `X != Y`, and for numbers `<`, `<=`, `>`, `>=`.
struct Comparison
{
  enum class Operator
  {
    kEqual,
    kNotEqual,
    kLess,
    kLessEqual,
    kGreater,
    kGreaterEqual
  };
  Term left;
  Operator op = Operator::kEqual;
  Term right;
  SourcePosition position = {};
};

/// `textbook(X)` or `not textbook(X)`: X is, or is not, an element of the sort.
struct Membership
{
  std::string sort;
  Term term;
  bool negated = false;
  SourcePosition position = {};
};

/// One element of a body `if c1, ..., cn`.
using Condition = std::variant<Literal, Comparison, Membership>;
using Body = std::vector<Condition>;

/// A sort: `place = {office, kitchen}.`, `thing = object + robot.`, `level = 0..3.` After the
/// checks `elements` holds all elements, those of member sorts included, in the order of their
/// declaration.
struct Sort
{
  std::string name;
  std::vector<std::string> elements;
  std::vector<std::string> member_sorts;  ///< the sorts that this one is the union of
  SourcePosition position;
};

enum class FluentKind
{
  kStatic,     ///< never changes
  kInertial,   ///< keeps its value until an action changes it
  kDefined,    ///< boolean; false unless its axioms say otherwise
  kKnowledge,  ///< inertial and boolean, about what the robot knows; starts afresh (false) with
               ///< each high-level action
};

/// `inertial loc(thing) : place.` A fluent with no value sort is boolean.
///
/// In the predicate form it reads `inertial loc(thing, place).` with the law `-loc(T, P1) if loc(T,
/// P2), P1 != P2.` The checks rewrite it to a function; literals are still read and printed as
/// `loc(rob1, office)`. Unless the file says `total loc.`, it is a partial function: its value sort
/// is then made by the checks and has one element more, which stands for "no value".
struct FluentDeclaration
{
  std::string name;
  FluentKind kind = FluentKind::kInertial;
  std::vector<std::string> argument_sorts;
  std::optional<std::string> value_sort;
  SourcePosition position;
  bool predicate_form = false;
  std::string no_value = {};  ///< of a partial function, the element that stands for "no value"
};

/// `move(robot, place).` or `exogenous exo_move(object, place).`
struct ActionDeclaration
{
  std::string name;
  std::vector<std::string> argument_sorts;
  bool exogenous = false;
  SourcePosition position;
};

/// What one outcome of an action does to one fluent: `loc(R) = C`, or `loc(R) = {Z : neighbor(Z,
/// C)}`, one of a set.
struct Effect
{
  Atom fluent;
  Term value;  ///< the value; in a choice the variable that ranges over the set
  bool is_choice = false;
  Body choice;  ///< the condition on `value` in a choice
};

/// `loc(R) = C [reached]`. A deterministic law has one outcome with an empty label. An outcome
/// without effects is written `nothing [failed]`. When the set of a choice is empty in a state, the
/// outcome cannot happen there.
struct Outcome
{
  std::string label;
  std::vector<Effect> effects;
};

/// `a causes outcome_1 or ... or outcome_n if body.`
struct CausalLaw
{
  Atom action;
  std::vector<Outcome> outcomes;
  Body body;
  SourcePosition position;
};

/// `l if body.` No head (`false if body.`) forbids the states in which the body holds.
struct StateConstraint
{
  std::optional<Literal> head;
  Body body;
  SourcePosition position;
};

/// `impossible a0, ..., ak if body.` An action may be a variable (`impossible A1, A2 if A1 !=
/// A2.`): a Term whose is_variable is set, ranging over all agent actions.
struct Executability
{
  std::vector<std::variant<Atom, Term>> actions;
  Body body;
  SourcePosition position;
};

/// `search(R, C, O) observes loc(O) = C.` (is it so: true or false) or `move(R, C) observes
/// loc(R).` (which value).
struct ObservationLaw
{
  Atom action;
  Atom fluent;
  std::optional<Term> value;
  SourcePosition position;
};

/// `default d1(X): loc(X) = main_library if textbook(X).`
struct Default
{
  Atom name;
  Literal head;
  Body body;
  SourcePosition position;
};

/// `prefer d1(X) over d2(X).`
struct Preference
{
  Atom better;
  Atom worse;
  SourcePosition position;
};

/// `cost move(R, P) = 5 if far(P).` Cost of one occurrence; actions without one cost 1.
struct ActionCost
{
  Atom action;
  double cost = 1.0;
  Body body;
  SourcePosition position;
};

/// `magnify place into cell by part_of.` Refinement files only: elements of `fine` stand for parts
/// of elements of `coarse`, by the static `part_of(fine) : coarse`.
struct Magnification
{
  std::string coarse;
  std::string fine;
  std::string component_static;
  SourcePosition position;
};

/// The part of the answer set program that a raw block joins.
enum class AspPart
{
  kBase,        ///< `asp`: once
  kState,       ///< `asp state`: for every step t
  kTransition,  ///< `asp transition`: for every step t above 0, about what happens from t-1 to t
};

/// Answer set programming code of experts, taken as it is.
struct AspBlock
{
  AspPart part = AspPart::kBase;
  std::string text;
  SourcePosition position;  ///< of the first character of `text`
};

/// A domain description, high or low level.
struct Description
{
  std::vector<Sort> sorts;
  std::vector<FluentDeclaration> fluents;  ///< statics included
  std::vector<ActionDeclaration> actions;
  std::vector<CausalLaw> causal_laws;
  std::vector<StateConstraint> constraints;
  std::vector<Executability> executabilities;
  std::vector<ObservationLaw> observations;
  std::vector<Literal> static_facts;  ///< ground
  std::vector<Default> defaults;
  std::vector<Preference> preferences;
  std::vector<ActionCost> costs;
  std::vector<Magnification> magnifications;
  std::vector<AspBlock> asp_blocks;

  /// The named declaration, or nullptr.
  [[nodiscard]] const Sort* findSort(const std::string& name) const;
  [[nodiscard]] const FluentDeclaration* findFluent(const std::string& name) const;
  [[nodiscard]] const ActionDeclaration* findAction(const std::string& name) const;
};

/// One problem in a text: where, what was found, what was expected.
struct Diagnostic
{
  SourcePosition position;
  std::string message;
};

/// A text and the name of the file it stands in, for messages.
struct SourceText
{
  std::string file;
  std::string text;
};

/// Parses and checks a description. Reports every problem, not just the first.
///
/// @param text  the description
/// @param file  its name, for messages
/// @throws InvalidArgument  with one line "file:line:column: message" for each problem
[[nodiscard]] Description parseDescription(const std::string& text, const std::string& file);

/// The same for one description in several files, such as the domain and the objects of a building:
/// what one file declares, all others may use. An order of the files is not needed.
[[nodiscard]] Description parseDescription(const std::vector<SourceText>& sources);

/// Reads and parses one description from several files. @throws as readDescription of one file
[[nodiscard]] Description readDescription(const std::vector<std::string>& paths);

/// Reads and parses a file. @throws NotFound  no such file; InvalidArgument as parseDescription
[[nodiscard]] Description readDescription(const std::string& path);

/// Parses a refinement on top of the high-level description it refines: names of `base` may be
/// used, and sorts, statics, fluents and actions of the refinement are checked together with them.
/// The result holds the refinement's own declarations only.
[[nodiscard]] Description parseRefinement(const std::string& text, const std::string& file,
                                          const Description& base);

/// Reads and parses a refinement. @throws NotFound  no such file; InvalidArgument as
/// parseRefinement
[[nodiscard]] Description readRefinement(const std::string& path, const Description& base);

/// Checks a description that was composed in memory and completes its sorts' elements.
/// @throws InvalidArgument  as parseDescription
void checkDescription(Description& description);

/// `loc(tb1) = office`, `-in_hand(rob1, tb1)`, ... as in the language.
[[nodiscard]] std::string toString(const Term& term);
[[nodiscard]] std::string toString(const Atom& atom);
[[nodiscard]] std::string toString(const Literal& literal);

/// As above, but `loc(tb1, office)` or `-loc(tb1, office)` of a fluent in the predicate form.
[[nodiscard]] std::string toString(const Literal& literal, const Description& description);

/// `=`, `!=`, ...
[[nodiscard]] const char* toString(Comparison::Operator op);

/// The whole description in the language, so that parseDescription(toString(d)) equals d.
[[nodiscard]] std::string toString(const Description& description);

/// Parses one ground literal or action against a description: names, arities and sorts are checked.
/// @throws InvalidArgument  with the nearest known name where one is unknown
[[nodiscard]] Literal parseGroundLiteral(const std::string& text, const Description& description);
[[nodiscard]] Atom parseGroundAction(const std::string& text, const Description& description);

/// A goal: a formula over ground literals with `and` (or `,`), `or`, `not` and parentheses.
struct Formula
{
  enum class Kind
  {
    kLiteral,
    kNot,
    kAnd,
    kOr
  };
  Kind kind = Kind::kLiteral;
  Literal literal;                ///< kLiteral
  std::vector<Formula> operands;  ///< otherwise
};
[[nodiscard]] Formula parseGoal(const std::string& text, const Description& description);
[[nodiscard]] std::string toString(const Formula& formula);
[[nodiscard]] std::string toString(const Formula& formula, const Description& description);

}  // namespace kr3::reasoner
