#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

enum class PolicyFormat : std::uint8_t
{
  kKr3,   ///< Policy::write
  kAppl,  ///< the XML of APPL's tools
};

/// Writes a policy in APPL's format, so that its simulator and its policy graphs take it.
///
/// APPL has vectors per value of what the robot sees of the state (Model::initialLabels; one value
/// when it sees nothing), over the states with that value. A vector of ours that covers only some
/// of these gets, in the others, a value below all that can be earned there, so that it stays a
/// lower bound.
///
/// @param model_name  for the attribute `model`
/// @throws InvalidArgument  a policy for another model, or a model with unequal numbers of states
///                          for the values that the robot sees
void writeApplPolicy(std::ostream& out, const Policy& policy, const Model& model,
                     const std::string& model_name);

/// Reads a policy in APPL's format, dense or sparse vectors.
///
/// Its values promise nothing: APPL prunes vectors that others build on, and writes six digits.
/// evaluate() says what it earns. Where the robot sees part of the state, a vector over all states
/// is added, one below the least value, which answers beliefs that nothing in the file covers.
///
/// @param name  of the input, for messages
/// @throws InvalidArgument  malformed, or for another model; the message says `name:line:column`
/// Source: the format as APPL 0.96 writes and reads it.
[[nodiscard]] Policy readApplPolicy(std::istream& in, const std::string& name, const Model& model);

/// Reads a policy of `model` in either format: APPL's where the file begins with `<`.
/// @throws Unavailable  the file cannot be opened or read; InvalidArgument  malformed, or a policy
///                      for another number of states or with an action that the model lacks
[[nodiscard]] Policy loadPolicy(const std::string& path, const Model& model);

/// Likewise, in this format and no other.
[[nodiscard]] Policy loadPolicy(const std::string& path, const Model& model, PolicyFormat format);

/// @throws InvalidArgument  a policy for another number of states or with an action that the model
///                          lacks
void checkFits(const Policy& policy, const Model& model);

}  // namespace kr3::pomdp
