#include <kr3_common/error.hpp>

#include "bindings.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

template <typename Find, typename NameOf>
std::size_t indexOf(const Key& key, std::size_t size, const char* kind, Find find, NameOf name_of)
{
  if (const auto* index = std::get_if<std::size_t>(&key))
  {
    if (*index >= size)
    {
      throw InvalidArgument(std::string(kind) + " " + std::to_string(*index) + " of " +
                            std::to_string(size));
    }
    return *index;
  }
  const std::string& name = std::get<std::string>(key);
  const std::optional<std::size_t> found = find(name);
  if (!found)
  {
    throw NotFound("no " + std::string(kind) + " '" + name + "'; the first of " +
                   std::to_string(size) + " is '" + name_of(0) + "'");
  }
  return *found;
}

}  // namespace

std::size_t actionOf(const Model& model, const Key& key)
{
  return indexOf(
      key, model.numActions(), "action", [&](const std::string& n) { return model.findAction(n); },
      [&](std::size_t i) { return model.actionName(i); });
}

std::size_t observationOf(const Model& model, const Key& key)
{
  return indexOf(
      key, model.numObservations(), "observation",
      [&](const std::string& n) { return model.findObservation(n); },
      [&](std::size_t i) { return model.observationName(i); });
}

std::size_t stateOf(const Model& model, const Key& key)
{
  return indexOf(
      key, model.numStates(), "state", [&](const std::string& n) { return model.findState(n); },
      [&](std::size_t i) { return model.stateName(i); });
}

void bindBeliefs(py::module_& module)
{
  py::class_<Belief>(module, "Belief", py::buffer_protocol(),
                     "A probability distribution over the states of a model, shape [num_states]. "
                     "numpy.asarray(belief) reads it in place; where a function takes a Belief it "
                     "takes an array too.")
      .def(py::init([](const BeliefArgument& probabilities) { return probabilities.belief(); }),
           py::arg("probabilities"),
           "Shape [num_states]; sums to 1 within 1e-6 and is normalised. Raises InvalidArgument.")
      .def_buffer([](const Belief& b) {
        return py::buffer_info(b.probabilities().data(),
                               static_cast<py::ssize_t>(b.probabilities().size()));
      })
      .def_property_readonly(
          "probabilities", [](const Belief& b) { return arrayOf(b.probabilities()); },
          "A copy, shape [num_states].")
      .def("__len__", &Belief::size)
      .def(
          "__getitem__",
          [](const Belief& b, std::size_t state) {
    if (state >= b.size())
    {
      throw py::index_error("state " + std::to_string(state) + " of " + std::to_string(b.size()));
    }
    return b[state];
          })
      .def("__eq__",
           [](const Belief& a, const Belief& b) { return a.probabilities() == b.probabilities(); })
      .def(
          "__repr__",
          [](const Belief& b) {
    return py::str("Belief({})").format(py::repr(arrayOf(b.probabilities()).attr("tolist")()));
          })
      .def(py::pickle([](const Belief& b) { return arrayOf(b.probabilities()); },
                      [](const py::array_t<double>& p) {
    return Belief(std::vector<double>(p.data(), p.data() + p.size()));
      }));
  py::class_<BeliefUpdate>(module, "BeliefUpdate",
                           "What a belief becomes, and how likely that was.")
      .def_readonly("posterior", &BeliefUpdate::posterior, "the new belief")
      .def_readonly("probability", &BeliefUpdate::probability,
                    "Pr(observation | belief, action), in (0, 1]");
}

}  // namespace kr3::pomdp
