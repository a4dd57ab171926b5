#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/interfaces.hpp"

/// What the low level believes of single fluents, between high-level actions and beside them.
namespace kr3::executive
{

/// A ground low-level fluent as the high level names it: `opened(cover_2)` is `opened(box)`.
[[nodiscard]] std::string coarseFluent(const refinement::LowLevelDomain& domain,
                                       const std::string& fluent);

/// What the low level last believed about a fluent.
struct RememberedFluent
{
  /// Over low-level values and refinement::kElsewhere, which stands for all values not listed.
  refinement::Distribution values;
  std::string assumed;  ///< the high-level value on which it rested
  /// By how much `values` overstate the odds of `assumed`, in (0, 1]: the action began with more
  /// belief in it than was remembered, for the sake of the plan.
  double odds = 1.0;
};
/// The low level's memory between high-level actions, by ground fluent.
using LowLevelMemory = std::map<std::string, RememberedFluent>;

/// How sure the high level is of a literal, and why.
struct Support
{
  double probability = 1.0;  ///< 1: held for certain
  std::string reason;        ///< for people: "default d1(tb1)", "observed", "assumed"
};
using SupportOf = std::function<Support(const std::string& literal)>;

/// Line 10: the initial belief for a zoom.
///
/// What the low level remembers wins while it rests on the value that the high level holds now, or
/// puts most of its mass there; otherwise the high level's support counts, spread over the
/// components.
[[nodiscard]] refinement::InitialKnowledge initialKnowledge(
    const refinement::LowLevelDomain& domain, const refinement::Zoom& zoom,
    const LowLevelMemory& memory, const SupportOf& support);

/// A sighting as a likelihood. Its confidence c is the probability that it is right when nothing
/// else is known, so that Pr(sighting | f = v) = c for the value v that was seen, and the rest is
/// shared by the other values: (1 - c) / (n - 1) each of n. `f != v` is as likely as 1 - c where f
/// has that value, and as likely as c where it has another.
class SightingLikelihood
{
public:
  /// @throws InvalidArgument  no ground literal of an inertial low-level fluent, or a confidence
  ///                          outside (0, 1]
  SightingLikelihood(const refinement::LowLevelDomain& domain, const Sighting& sighting);

  [[nodiscard]] const std::string& fluent() const { return fluent_; }
  /// A value's name; "true" and "false" of boolean fluents.
  [[nodiscard]] double of(const std::string& value) const;
  /// Of any one of the values that are not listed, all equally likely.
  /// @param listed  other values; refinement::kElsewhere among them does not count
  [[nodiscard]] double ofOthers(const std::vector<std::string>& listed) const;

  /// The posterior of a distribution over values and refinement::kElsewhere. The value seen becomes
  /// one of those listed.
  [[nodiscard]] refinement::Distribution applied(const refinement::Distribution& prior) const;

private:
  std::string fluent_;
  std::vector<std::string> values_;  // all that the fluent can have
  std::string seen_;
  double seen_likelihood_ = 1.0;
  double other_likelihood_ = 1.0;
};

/// Nothing is known of a fluent.
[[nodiscard]] refinement::Distribution unknownValue();

/// All values of a valued fluent on the high level, in the order of its sort; none of another one.
[[nodiscard]] std::vector<std::string> highLevelValues(const refinement::LowLevelDomain& domain,
                                                       const std::string& fluent);

/// What a distribution over low-level values has on the components of a high-level one.
[[nodiscard]] double massOf(const refinement::LowLevelDomain& domain,
                            const refinement::Distribution& values, const std::string& value);

/// High-level values of a fluent for which the `elsewhere` of a distribution stands: it lists none
/// of their components. 0 where the high level has no such values.
[[nodiscard]] std::size_t numUnlisted(const refinement::LowLevelDomain& domain,
                                      const std::string& fluent,
                                      const refinement::Distribution& values);

/// The remembered values with their odds as they were before the action; not normalised.
[[nodiscard]] refinement::Distribution weighed(const refinement::LowLevelDomain& domain,
                                               const RememberedFluent& remembered);

/// How likely each of several values of a high-level fluent is, by what the low level remembers;
/// values of which it remembers nothing share its `elsewhere` equally. Sums to 1.
/// @param values  at least one
[[nodiscard]] std::vector<double> probabilitiesOf(const refinement::LowLevelDomain& domain,
                                                  const LowLevelMemory& memory,
                                                  const std::string& fluent,
                                                  const std::vector<std::string>& values);

/// Forgets what was found out about one value, as when a refutation is taken back.
void forget(const refinement::LowLevelDomain& domain, LowLevelMemory& memory,
            const std::string& fluent, const std::string& value);

}  // namespace kr3::executive
