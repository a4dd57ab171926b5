#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "kr3_pomdp/belief.hpp"
#include "kr3_pomdp/model.hpp"

/// The Python module kr3_pomdp: names are those of the C++ library. One function a part of it; each
/// binds the types that later ones use.
namespace kr3::pomdp
{

/// Beliefs and what they become.
void bindBeliefs(pybind11::module_& module);
/// Model, ModelBuilder, models from arrays, files.
void bindModels(pybind11::module_& module);
/// FactoredModel and its parts.
void bindFactoredModels(pybind11::module_& module);
/// AlphaVector and Policy.
void bindPolicies(pybind11::module_& module);
/// solve, evaluate and simulation.
void bindSolving(pybind11::module_& module);

/// solveExactly.
void bindExactSolver(pybind11::module_& module);
/// Planning online.
void bindPlanning(pybind11::module_& module);

/// A state, action or observation in Python: its index or its name.
using Key = std::variant<std::size_t, std::string>;

/// @throws NotFound         no such name
/// @throws InvalidArgument  an index out of range
[[nodiscard]] std::size_t actionOf(const Model& model, const Key& key);
[[nodiscard]] std::size_t observationOf(const Model& model, const Key& key);
[[nodiscard]] std::size_t stateOf(const Model& model, const Key& key);

/// A belief as Python gives it: a Belief or probabilities, shape [num_states].
struct BeliefArgument
{
  std::vector<double> probabilities;
  [[nodiscard]] Belief belief() const { return Belief(probabilities); }
};

/// A copy of a vector as a numpy array. @param shape  its product is the number of values
[[nodiscard]] inline pybind11::array_t<double> arrayOf(const std::vector<double>& values,
                                                       std::vector<pybind11::ssize_t> shape = {})
{
  if (shape.empty())
  {
    shape = {static_cast<pybind11::ssize_t>(values.size())};
  }
  return pybind11::array_t<double>(std::move(shape), values.data());
}

}  // namespace kr3::pomdp

namespace pybind11::detail
{

template <>
struct type_caster<kr3::pomdp::BeliefArgument>
{
  PYBIND11_TYPE_CASTER(kr3::pomdp::BeliefArgument,
                       const_name("Union[kr3_pomdp.Belief, numpy.ndarray[numpy.float64]]"));

  bool load(handle source, bool convert)
  {
    if (isinstance<kr3::pomdp::Belief>(source))
    {
      value.probabilities = source.cast<const kr3::pomdp::Belief&>().probabilities();
      return true;
    }
    if (!convert && !isinstance<array>(source))
    {
      return false;
    }
    const auto numbers = array_t<double, array::c_style | array::forcecast>::ensure(source);
    if (!numbers || numbers.ndim() != 1)
    {
      PyErr_Clear();
      return false;
    }
    value.probabilities.assign(numbers.data(), numbers.data() + numbers.size());
    return true;
  }
};

}  // namespace pybind11::detail
