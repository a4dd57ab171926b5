#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "oracle.hpp"

/// A slow, literal translation of a ground domain and a history into an answer set program, for
/// domains too large to enumerate: two literals `holds` and `-holds` for each value, inertia for
/// both, the closure on a layer of its own (`u`, `-u`), no slicing. Solved by plain clingo.
namespace kr3::reasoner::oracle
{

/// What a diagnosis may assume.
struct Level
{
  bool exogenous = false;
  bool retractions = false;
};

/// The program at one level, for people and for clingo.
[[nodiscard]] std::string referenceProgram(const GroundDomain& domain,
                                           const Description& description,
                                           const std::vector<Record>& records,
                                           const ReasonerOptions& options, const Level& level);

/// The models, as answersOf, but found by clingo.
[[nodiscard]] Answers referenceAnswers(const Description& description,
                                       const std::vector<Record>& records,
                                       const ReasonerOptions& options);

/// The literals that hold in all and in some models with minimal explanations.
struct Consequences
{
  bool consistent = false;
  int cost = 0;
  std::vector<std::vector<std::set<int>>> possible;  ///< by step and fluent: the values it takes
};
[[nodiscard]] Consequences referenceConsequences(const Description& description,
                                                 const std::vector<Record>& records,
                                                 const ReasonerOptions& options);

}  // namespace kr3::reasoner::oracle
