#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"

/// A description as the propositional theory it stands for, spelled out without any solver. The
/// oracles of the equivalence tests start from here; nothing of src/ is used but the parsed
/// Description.
namespace kr3::reasoner::oracle
{

/// `fluent = value` or `fluent != value`, by index. A boolean fluent has the values 0 (false) and 1
/// (true), and its literals are written with `equal` set.
struct GroundLiteral
{
  int fluent = 0;
  int value = 0;
  bool equal = true;
};
using GroundBody = std::vector<GroundLiteral>;

struct GroundFluentInfo
{
  std::string name;  ///< `loc(rob1)`
  std::vector<std::string> values;
  bool boolean = false;
  bool defined = false;
};

struct GroundActionInfo
{
  std::string name;
  bool exogenous = false;
};

/// `head if body`; without a head the body is forbidden.
struct GroundConstraint
{
  std::optional<GroundLiteral> head;
  GroundBody body;
};

/// An instance of an effect: certain, or one value out of those of which some body holds.
struct GroundEffect
{
  struct Candidate
  {
    int value = 0;
    std::vector<GroundBody> bodies;  ///< any of them
  };
  int fluent = 0;
  int value = 0;
  bool is_choice = false;
  std::vector<Candidate> candidates;
};

/// One choice between outcomes: an instance of an action with the variables of the law's effects.
struct GroundLaw
{
  int action = 0;
  std::vector<GroundBody> bodies;  ///< any of them
  std::vector<std::vector<GroundEffect>> outcomes;
};

struct GroundExecutability
{
  std::vector<int> actions;
  GroundBody body;
};

struct GroundDefault
{
  std::string name;  ///< `d1`
  std::vector<std::string> arguments;
  GroundLiteral head;
  GroundBody body;
};

struct GroundDomain
{
  std::vector<GroundFluentInfo> fluents;
  std::vector<GroundActionInfo> actions;
  std::vector<GroundConstraint> constraints;
  std::vector<GroundLaw> laws;
  std::vector<GroundExecutability> executabilities;
  std::vector<GroundDefault> defaults;
  std::set<std::pair<int, int>> better;  ///< of defaults, transitive
  std::set<std::string> true_statics;    ///< `near(a, b)`, `home(a) = u`
};

/// @throws InternalError  a name in the description is unknown (it was not checked)
[[nodiscard]] GroundDomain grounded(const Description& description);

/// A ground literal by index; of a static: nothing.
[[nodiscard]] std::optional<GroundLiteral> literalOf(const Literal& literal,
                                                     const GroundDomain& domain);

[[nodiscard]] int actionOf(const std::string& name, const GroundDomain& domain);

/// Whether a ground literal of a static is true; `f != v` is when `f = v` is not.
[[nodiscard]] bool staticHolds(const Literal& literal, const Description& description,
                               const GroundDomain& domain);

/// `loc(tb1) = office`, `wet(a)`, `-wet(a)`.
[[nodiscard]] std::string toString(const GroundLiteral& literal, const GroundDomain& domain);

}  // namespace kr3::reasoner::oracle
