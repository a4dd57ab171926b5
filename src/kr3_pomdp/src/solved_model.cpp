#include "kr3_pomdp/solved_model.hpp"

#include <cstdio>
#include <limits>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/start_value.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// FNV-1a over the text, then mixed; `seed` gives independent halves.
std::uint64_t hash64(const std::string& text, std::uint64_t seed)
{
  std::uint64_t hash = 0xcbf29ce484222325ULL ^ seed;
  for (const char c : text)
  {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  hash ^= hash >> 33;
  hash *= 0xff51afd7ed558ccdULL;
  hash ^= hash >> 33;
  return hash;
}

/// Whether a limit lets through all that another does; 0 is none.
template <typename Number>
bool atLeast(Number limit, Number other)
{
  return limit == Number{0} || (other != Number{0} && limit >= other);
}

}  // namespace

std::size_t SolvedModel::sizeInBytes() const
{
  return sizeof(SolvedModel) + sizeof(NamedModel) + source->text.text.size() +
         source->model.sizeInBytes() + (policy ? policy->sizeInBytes() : 0);
}

const char* SolvedModel::reasonText() const
{
  return reason ? toString(*reason) : "loaded";
}

SolvedModel solvedModel(std::shared_ptr<const NamedModel> source, const SolverLimits& limits,
                        SolveResult result)
{
  return {std::move(source), std::move(result.policy), limits,        result.lower,
          result.upper,      result.backups,           result.reason, result.cpu_s,
          result.elapsed_s,  result.memory_bytes};
}

SolvedModel unsolvedModel(std::shared_ptr<const NamedModel> source, std::optional<Policy> policy)
{
  double lower = -kInfinity;
  if (policy)
  {
    const Model& model = source->model;
    if (policy->numStates() != model.numStates() || policy->maxAction() >= model.numActions())
    {
      throw InvalidArgument("a policy over " + std::to_string(policy->numStates()) +
                            " states with actions up to " + std::to_string(policy->maxAction()) +
                            ", the model has " + std::to_string(model.numStates()) +
                            " states and " + std::to_string(model.numActions()) + " actions");
    }
    lower = startValue(model, *policy);
  }
  return {std::move(source), std::move(policy), {}, lower, kInfinity, 0, std::nullopt, 0.0, 0.0, 0};
}

bool sameLimits(const SolverLimits& a, const SolverLimits& b)
{
  return a.precision == b.precision && a.time_s == b.time_s && a.max_backups == b.max_backups &&
         a.max_memory_bytes == b.max_memory_bytes && a.num_threads == b.num_threads;
}

bool answers(const SolvedModel& known, const SolverLimits& wanted)
{
  if (!known.policy || !known.reason)
  {
    return false;
  }
  const bool cancelled = *known.reason == StopReason::kCancelled;
  if (!cancelled && sameLimits(known.limits, wanted))
  {
    return true;
  }
  if (wanted.max_backups != 0)
  {
    return false;
  }
  if (known.upper - known.lower <= wanted.precision)
  {
    return true;
  }
  return !cancelled && known.limits.max_backups == 0 &&
         known.limits.precision <= wanted.precision &&
         atLeast(known.limits.time_s, wanted.time_s) &&
         atLeast(known.limits.max_memory_bytes, wanted.max_memory_bytes) &&
         known.limits.num_threads >= wanted.num_threads;
}

std::string contentHash(const std::string& text)
{
  char digits[33];
  std::snprintf(digits, sizeof(digits), "%016llx%016llx",
                static_cast<unsigned long long>(hash64(text, 0)),
                static_cast<unsigned long long>(hash64(text, 0x9e3779b97f4a7c15ULL)));
  return digits;
}

std::string contentHash(const SolvedModel& solved)
{
  const SolverLimits& limits = solved.limits;
  char head[192];
  std::snprintf(head, sizeof(head), "%s %.17g %.17g %llu %zu %d\n", solved.reason ? "solved" : "",
                limits.precision, limits.time_s,
                static_cast<unsigned long long>(limits.max_backups), limits.max_memory_bytes,
                limits.num_threads);
  std::ostringstream policy;
  if (!solved.reason && solved.policy)
  {
    solved.policy->write(policy);
  }
  return contentHash(solved.source->text.format + ' ' + head + policy.str() +
                     solved.source->text.text);
}

}  // namespace kr3::pomdp
