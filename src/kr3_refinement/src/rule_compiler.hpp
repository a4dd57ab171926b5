#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "rule.hpp"
#include "signature.hpp"

namespace kr3::refinement
{

/// Turns laws of the language into rules over a signature: names become numbers, variables get the
/// elements that their positions allow.
class RuleCompiler
{
public:
  RuleCompiler(const reasoner::Description& description, const Signature& signature)
    : description_(description), signature_(signature)
  {
  }

  /// Nothing when the law rests on knowledge (in its head or its body).
  [[nodiscard]] std::optional<CompiledConstraint> constraint(
      const reasoner::StateConstraint& law) const;
  [[nodiscard]] std::optional<CompiledLaw> causalLaw(const reasoner::CausalLaw& law) const;
  [[nodiscard]] std::optional<CompiledObservation> observation(
      const reasoner::ObservationLaw& law) const;
  /// Only for conditions on one action. @param action  the action it is about, for conditions on
  /// every action
  [[nodiscard]] std::optional<CompiledExecutability> executability(
      const reasoner::Executability& law, const std::string& action) const;
  [[nodiscard]] CompiledLiteral fact(const reasoner::Literal& literal) const;

private:
  class Scope;
  const reasoner::Description& description_;
  const Signature& signature_;
};

}  // namespace kr3::refinement
