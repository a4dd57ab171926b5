#pragma once

#include "bindings.hpp"

namespace kr3::pomdp
{

/// Indices, shape [n, dimensions], and values, shape [n].
using Entries = std::pair<pybind11::array_t<std::int64_t>, pybind11::array_t<double>>;

/// Names, or how many there are.
using NamesArgument = std::optional<std::variant<std::size_t, std::vector<std::string>>>;

/// See the docstring of Python's modelFromArrays.
[[nodiscard]] Model modelFromArrays(const pybind11::object& transitions,
                                    const pybind11::object& observations,
                                    const pybind11::object& rewards, double discount,
                                    const std::optional<BeliefArgument>& initial_belief,
                                    const NamesArgument& states, const NamesArgument& actions,
                                    const NamesArgument& observation_names, double sum_tolerance);

/// @throws ResourceExhausted  above 2^27 entries, as the next
[[nodiscard]] pybind11::array_t<double> transitionArray(const Model& model);
[[nodiscard]] pybind11::array_t<double> observationArray(const Model& model);
[[nodiscard]] pybind11::array_t<double> rewardArray(const Model& model);
[[nodiscard]] Entries transitionEntries(const Model& model);
[[nodiscard]] Entries observationEntries(const Model& model);

}  // namespace kr3::pomdp
