#pragma once

#include <cstdint>
#include <string>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// How large a random domain may become. The defaults keep it below about 200 states, so that it
/// can be enumerated.
struct CaseSize
{
  int max_things = 2;
  int max_places = 3;
  int max_steps = 2;     ///< of the history
  int max_defaults = 3;  ///< statements; each has an instance for each thing
  int max_records = 4;   ///< observations
  bool actions_in_language_only =
      false;  ///< no recorded actions: a history that is a good start for planning
};

/// A description with a history and what a diagnosis may assume, drawn from a seed. Both texts are
/// in the language, so that a case that fails can be run by hand.
struct RandomCase
{
  std::uint64_t seed = 0;
  std::string description;
  std::string history;
  ReasonerOptions options;
};

/// Draws sorts with subsorts; inertial, boolean, functional and defined fluents (recursive ones
/// too); statics; laws with several outcomes and choices; constraints with and without head;
/// executability conditions of one and of two actions; defaults that rest on one another;
/// preferences; exogenous actions; attempts; uncertain records. Equal seeds give equal cases. The
/// description always passes the checks of the language; the history may be inconsistent.
[[nodiscard]] RandomCase randomCase(std::uint64_t seed, const CaseSize& size = {});

/// A history for any description: attempts of random actions, and observations that mostly tell of
/// one unchanging world. Equal seeds give equal histories.
[[nodiscard]] std::string randomHistory(const Description& description, std::uint64_t seed,
                                        int steps, int observations);

/// Both texts and the options, for a message.
[[nodiscard]] std::string toString(const RandomCase& random_case);

}  // namespace kr3::reasoner
