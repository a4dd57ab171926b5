#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "kr3_pomdp/model_text.hpp"
#include "kr3_pomdp/policy.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// A model and the text that it was read from.
struct NamedModel
{
  ModelText text;
  Model model;
};

/// A model with the policy found for it, if there is one.
struct SolvedModel
{
  std::shared_ptr<const NamedModel> source;  ///< shared by the policies of one model, never null
  std::optional<Policy> policy;              ///< none: a model to plan for online
  SolverLimits limits;                       ///< as they were asked for
  double lower;                              ///< at the initial belief; -infinity without a policy
  double upper;                              ///< infinity when unknown
  std::uint64_t backups = 0;
  std::optional<StopReason> reason;  ///< none when it was not solved here: its bounds are not known
  double cpu_s = 0.0;
  double elapsed_s = 0.0;               ///< wall time
  std::size_t search_memory_bytes = 0;  ///< of the solver at its end

  [[nodiscard]] const Model& model() const { return source->model; }
  /// Memory of text, model and policy, roughly.
  [[nodiscard]] std::size_t sizeInBytes() const;
  /// "precision" and so on, or "loaded".
  [[nodiscard]] const char* reasonText() const;
};

/// @param source  not null
[[nodiscard]] SolvedModel solvedModel(std::shared_ptr<const NamedModel> source,
                                      const SolverLimits& limits, SolveResult result);

/// A model with a policy from elsewhere, or with none.
///
/// The lower bound is what the policy's vectors say; they are taken to be right.
/// @param source  not null
/// @throws InvalidArgument  a policy for another number of states or with an action that the model
///                          lacks
[[nodiscard]] SolvedModel unsolvedModel(std::shared_ptr<const NamedModel> source,
                                        std::optional<Policy> policy);

[[nodiscard]] bool sameLimits(const SolverLimits& a, const SolverLimits& b);

/// Whether a solution answers a request for the same model with these limits, so that nothing need
/// be solved:
/// - it was found with just these limits; or
/// - the request sets no counted work (which must repeat exactly), and the solution is as precise
/// as
///   asked for, or was found with as much time and memory for at least that precision.
/// A cancelled run answers only by its precision.
[[nodiscard]] bool answers(const SolvedModel& known, const SolverLimits& wanted);

/// Hash of a text, 128 bits as 32 hexadecimal digits; the same on every machine. Not cryptographic.
[[nodiscard]] std::string contentHash(const std::string& text);

/// The hash of all that a solution depends on: the model's text and the limits, and for one that
/// was not solved here its policy.
[[nodiscard]] std::string contentHash(const SolvedModel& solved);

}  // namespace kr3::pomdp
