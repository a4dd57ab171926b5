#include "python_model.hpp"

#include <utility>

#include <kr3_common/error.hpp>

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

py::object required(const py::object& model, const char* name)
{
  if (!py::hasattr(model, name))
  {
    throw InvalidArgument(py::str(py::type::of(model)).cast<std::string>() + " has no '" + name +
                          "', which a generative model needs");
  }
  return model.attr(name);
}

py::object optional(const py::object& model, const char* name)
{
  return py::getattr(model, name, py::none());
}

template <typename Value>
Value valueOf(const py::object& result, const char* method, const char* expected)
{
  try
  {
    return result.cast<Value>();
  }
  catch (const py::cast_error&)
  {
    throw InvalidArgument(std::string(method) + " returned " +
                          py::repr(result).cast<std::string>() + ", expected " + expected);
  }
}

}  // namespace

std::uint64_t ObjectTable::numberOf(const py::handle& object)
{
  PyObject* known = PyDict_GetItemWithError(numbers_.ptr(), object.ptr());
  if (known != nullptr)
  {
    return PyLong_AsUnsignedLongLong(known);
  }
  if (PyErr_Occurred() != nullptr)
  {
    throw py::error_already_set();
  }
  const std::uint64_t number = objects_.size();
  numbers_[object] = py::int_(number);
  objects_.push_back(py::reinterpret_borrow<py::object>(object));
  return number;
}

PythonModel::PythonModel(py::object model)
  : model_(std::move(model))
  , num_actions_(valueOf<std::size_t>(required(model_, "numActions")(), "numActions", "an int"))
  , discount_(valueOf<double>(required(model_, "discount")(), "discount", "a float"))
  , step_(required(model_, "step"))
  , upper_bound_(required(model_, "upperBound"))
  , default_action_(optional(model_, "defaultAction"))
  , observation_probability_(optional(model_, "observationProbability"))
  , perturbed_(optional(model_, "perturbed"))
{
  if (num_actions_ == 0)
  {
    throw InvalidArgument("numActions returned 0, expected at least 1");
  }
}

GenerativeStep PythonModel::step(std::uint64_t state, std::size_t action, double random) const
{
  const py::object result = step_(states_[state], action, random);
  if (!py::isinstance<py::tuple>(result) || (py::len(result) != 3 && py::len(result) != 4))
  {
    throw InvalidArgument("step returned " + py::repr(result).cast<std::string>() +
                          ", expected (next state, observation, reward) and perhaps terminal");
  }
  const auto parts = py::reinterpret_borrow<py::tuple>(result);
  return {states_.numberOf(parts[0]), observations_.numberOf(parts[1]),
          valueOf<double>(parts[2], "step", "a number as reward"),
          parts.size() == 4 && valueOf<bool>(parts[3], "step", "a bool as terminal")};
}

double PythonModel::upperBound(std::uint64_t state) const
{
  return valueOf<double>(upper_bound_(states_[state]), "upperBound", "a number");
}

std::size_t PythonModel::defaultAction(const std::vector<std::uint64_t>& states) const
{
  if (default_action_.is_none())
  {
    return 0;
  }
  py::list objects(states.size());
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    objects[i] = states_[states[i]];
  }
  const auto action = valueOf<std::size_t>(default_action_(objects), "defaultAction", "an action");
  if (action >= num_actions_)
  {
    throw InvalidArgument("defaultAction returned " + std::to_string(action) + " of " +
                          std::to_string(num_actions_));
  }
  return action;
}

std::optional<double> PythonModel::observationProbability(std::size_t action,
                                                          std::uint64_t next_state,
                                                          std::uint64_t observation) const
{
  if (observation_probability_.is_none())
  {
    return std::nullopt;
  }
  const auto probability = valueOf<double>(
      observation_probability_(action, states_[next_state], observations_[observation]),
      "observationProbability", "a number");
  if (!(probability >= 0.0 && probability <= 1.0))
  {
    throw InvalidArgument("observationProbability returned " + std::to_string(probability) +
                          ", expected it in [0, 1]");
  }
  return probability;
}

std::optional<std::uint64_t> PythonModel::perturbed(std::uint64_t state, double random) const
{
  if (perturbed_.is_none())
  {
    return std::nullopt;
  }
  return states_.numberOf(perturbed_(states_[state], random));
}

std::vector<std::uint64_t> PythonModel::keepOnly(const std::vector<std::uint64_t>& states)
{
  ObjectTable kept;
  std::vector<std::uint64_t> numbers;
  numbers.reserve(states.size());
  for (const std::uint64_t state : states)
  {
    numbers.push_back(kept.numberOf(states_[state]));
  }
  states_ = std::move(kept);
  observations_ = ObjectTable();
  return numbers;
}

}  // namespace kr3::pomdp
