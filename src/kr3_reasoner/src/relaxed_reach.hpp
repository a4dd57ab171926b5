#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "ground_rules.hpp"
#include "plan_program.hpp"

namespace kr3::reasoner
{

/// What could be reached if nothing that was once true became false again. What is unreachable even
/// so is unreachable by any plan. Private to the package.
class RelaxedReach
{
public:
  /// @param problem  must outlive this
  explicit RelaxedReach(const PlanningProblem& problem);

  /// Why a formula can never hold; nothing when it may.
  [[nodiscard]] std::optional<std::string> whyUnreachable(const Formula& formula) const;

private:
  using Visited = std::unordered_set<std::string>;

  [[nodiscard]] std::string program() const;
  [[nodiscard]] std::string relaxed(const Body& body) const;
  [[nodiscard]] std::string relaxed(const Literal& literal) const;
  [[nodiscard]] std::string contrary(const Literal& literal) const;
  [[nodiscard]] std::string executabilityRules() const;

  [[nodiscard]] bool mayHold(const GroundAtom& fluent, ConstantId value, bool equal) const;
  [[nodiscard]] std::optional<std::string> why(const Formula& formula, bool wanted) const;
  [[nodiscard]] std::string why(const GroundAtom& fluent, ConstantId value, bool equal,
                                Visited& visited) const;
  [[nodiscard]] std::optional<std::string> whyNot(const GroundableRule& rule,
                                                  const RuleLiteral& literal,
                                                  const GroundAtom& fluent, ConstantId value,
                                                  bool equal, Visited& visited) const;
  [[nodiscard]] std::string whyImpossible(const GroundAtom& action) const;
  [[nodiscard]] std::string text(const GroundAtom& fluent, ConstantId value, bool equal) const;

  const PlanningProblem& problem_;
  GroundRules rules_;
  Encoding encoding_;
  std::unordered_map<GroundAtom, std::unordered_set<ConstantId>, GroundAtomHash> values_;
  std::unordered_set<GroundAtom, GroundAtomHash> actions_;
};

}  // namespace kr3::reasoner
