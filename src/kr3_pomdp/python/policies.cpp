#include <fstream>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

#include "bindings.hpp"
#include "kr3_pomdp/policy.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

void writePolicy(const Policy& policy, const std::string& path)
{
  std::ofstream out(path);
  policy.write(out);
  out.close();
  if (!out)
  {
    throw Unavailable("cannot write '" + path + "'");
  }
}

Policy readPolicy(const std::string& path)
{
  std::ifstream in(path);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  return Policy::read(in, path);
}

std::string textOf(const Policy& policy)
{
  std::ostringstream out;
  policy.write(out);
  return out.str();
}

Policy fromText(const std::string& text, const std::string& name)
{
  std::istringstream in(text);
  return Policy::read(in, name);
}

/// The best vector at each of many beliefs, shape [n, num_states].
std::pair<py::array_t<std::int64_t>, py::array_t<double>> bestAtEach(const Policy& policy,
                                                                     const Doubles& beliefs)
{
  if (beliefs.ndim() != 2 || static_cast<std::size_t>(beliefs.shape(1)) != policy.numStates())
  {
    throw InvalidArgument(
        "beliefs of shape [..., " +
        std::to_string(beliefs.ndim() > 0 ? beliefs.shape(beliefs.ndim() - 1) : 0) +
        "], expected [n, " + std::to_string(policy.numStates()) + "]");
  }
  py::array_t<std::int64_t> actions(beliefs.shape(0));
  py::array_t<double> values(beliefs.shape(0));
  std::int64_t* action = actions.mutable_data();
  double* value = values.mutable_data();
  const double* first = beliefs.data();
  const py::ssize_t count = beliefs.shape(0);
  const py::gil_scoped_release release;
  for (py::ssize_t i = 0; i < count; ++i, first += policy.numStates())
  {
    const Policy::Choice best =
        policy.bestAt(Belief(std::vector<double>(first, first + policy.numStates())));
    action[i] = static_cast<std::int64_t>(best.action);
    value[i] = best.value;
  }
  return {actions, values};
}

void bindAlphaVector(py::module_& module)
{
  py::class_<AlphaVector>(module, "AlphaVector",
                          "The value of one conditional plan in some states, and its first action.")
      .def(py::init([](std::size_t action, const Doubles& values,
                       const std::optional<Indices>& states) {
             AlphaVector vector{
                 action, {}, std::vector<double>(values.data(), values.data() + values.size())};
             if (states)
             {
               vector.states.assign(states->data(), states->data() + states->size());
             }
             return vector;
           }),
           py::arg("action"), py::arg("values"), py::arg("states") = std::nullopt,
           "One value for each of `states` (ascending indices); without them, for all states.")
      .def_readonly("action", &AlphaVector::action, "the index of the plan's first action")
      .def_property_readonly(
          "values", [](const AlphaVector& v) { return arrayOf(v.values); },
          "Shape [len(states)], or [num_states] when `states` is empty.")
      .def_property_readonly(
          "states",
          [](const AlphaVector& v) {
    return py::array_t<std::uint32_t>(static_cast<py::ssize_t>(v.states.size()), v.states.data());
          },
          "Ascending; empty: all states of the model.");
}

}  // namespace

void bindPolicies(py::module_& module)
{
  bindAlphaVector(module);
  py::class_<Policy::Choice>(module, "Choice", "What a policy does at a belief.")
      .def_readonly("action", &Policy::Choice::action, "its index")
      .def_readonly("value", &Policy::Choice::value, "a lower bound of what is earned from there");
  py::class_<Policy>(module, "Policy",
                     "At a belief, the action of the alpha vector that is greatest there, among "
                     "those whose states hold all of the belief. An immutable value; pickled "
                     "exactly.")
      .def(py::init<std::size_t, const std::vector<AlphaVector>&>(), py::arg("num_states"),
           py::arg("alpha_vectors"),
           "From vectors, of which one at least is over all states. Raises InvalidArgument.")
      .def("numStates", &Policy::numStates, "Of the model it is for.")
      .def("numAlphaVectors", &Policy::numAlphaVectors, "How many vectors.")
      .def("maxAction", &Policy::maxAction, "The greatest action index of any vector.")
      .def("sizeInBytes", &Policy::sizeInBytes, "Memory held, roughly.")
      .def("alphaVectors", &Policy::alphaVectors,
           "All vectors, those with the same states together.")
      .def(
          "actionAt",
          [](const Policy& p, const BeliefArgument& belief) { return p.actionAt(belief.belief()); },
          py::arg("belief"), "The index of the action. Raises InvalidArgument.")
      .def(
          "valueAt",
          [](const Policy& p, const BeliefArgument& belief) { return p.valueAt(belief.belief()); },
          py::arg("belief"), "A lower bound of what the policy earns from the belief on.")
      .def(
          "bestAt",
          [](const Policy& p, const BeliefArgument& belief) { return p.bestAt(belief.belief()); },
          py::arg("belief"), "Action and value at once.")
      .def("bestAtEach", &bestAtEach, py::arg("beliefs"),
           "Actions and values, shape [n] each, at beliefs of shape [n, num_states].")
      .def("write", &writePolicy, py::arg("path"),
           "Writes a file that Policy.read reads back exactly. Raises Unavailable.")
      .def_static("read", &readPolicy, py::arg("path"),
                  "Raises Unavailable, or InvalidArgument with 'file:line: message'.")
      .def(py::pickle(&textOf, [](const std::string& text) { return fromText(text, "pickle"); }));
}

}  // namespace kr3::pomdp
