#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "ground_rules.hpp"
#include "plan_program.hpp"

namespace kr3::reasoner
{

/// What each step of a plan can change, and on what it depends whether the step leads anywhere: an
/// action that no condition forbids has no successor where its effects contradict each other or a
/// state constraint. Private to the package.
class PlanReach
{
public:
  /// All must outlive this.
  PlanReach(const GroundRules& rules, const Consequences& consequences, int now);

  /// Forgets the steps of the plan before.
  void restart() { changed_.clear(); }

  /// The fluents on whose values, before the next step, it depends whether the step has a
  /// successor; empty when it always has one. Steps are given in their order.
  [[nodiscard]] std::vector<GroundFluent> next(const std::vector<std::string>& actions);

private:
  using Fluents = std::unordered_set<GroundAtom, GroundAtomHash>;

  struct Step
  {
    std::vector<GroundAtom> actions;
    Fluents changed;   ///< by the step
    Fluents relevant;  ///< to whether there is a successor
    bool harmless = true;
  };

  void followActions(Step& step) const;
  void followConstraints(Step& step) const;
  [[nodiscard]] bool refuted(const RuleLiteral& literal, const RuleBinding& binding,
                             const Fluents& changed) const;
  [[nodiscard]] GroundFluent toFluent(const GroundAtom& atom) const;
  [[nodiscard]] Literal toLiteral(const GroundAtom& atom, ConstantId value) const;

  const GroundRules& rules_;
  const Consequences& consequences_;
  int now_;
  Fluents changed_;  // by the steps so far
};

}  // namespace kr3::reasoner
