#include <fstream>
#include <utility>

#include <kr3_common/error.hpp>

#include "bindings.hpp"
#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "model_arrays.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

template <typename NameOf>
std::vector<std::string> namesOf(std::size_t size, NameOf name_of)
{
  std::vector<std::string> names;
  names.reserve(size);
  for (std::size_t i = 0; i < size; ++i)
  {
    names.push_back(name_of(i));
  }
  return names;
}

void bindNames(py::class_<Model>& model)
{
  model.def("numStates", &Model::numStates, "How many states.")
      .def("numActions", &Model::numActions, "How many actions.")
      .def("numObservations", &Model::numObservations, "How many observations.")
      .def_property_readonly(
          "states",
          [](const Model& m) {
    return namesOf(m.numStates(), [&](std::size_t i) { return m.stateName(i); });
          },
          "Names, in the order of the indices.")
      .def_property_readonly(
          "actions",
          [](const Model& m) {
    return namesOf(m.numActions(), [&](std::size_t i) { return m.actionName(i); });
          },
          "Names, in the order of the indices.")
      .def_property_readonly(
          "observations",
          [](const Model& m) {
    return namesOf(m.numObservations(), [&](std::size_t i) { return m.observationName(i); });
          },
          "Names, in the order of the indices.")
      .def(
          "stateName", [](const Model& m, std::size_t i) { return m.stateName(stateOf(m, i)); },
          py::arg("state"), "The name of a state. Raises InvalidArgument.")
      .def(
          "actionName", [](const Model& m, std::size_t i) { return m.actionName(actionOf(m, i)); },
          py::arg("action"), "The name of an action. Raises InvalidArgument.")
      .def(
          "observationName",
          [](const Model& m, std::size_t i) { return m.observationName(observationOf(m, i)); },
          py::arg("observation"), "The name of an observation. Raises InvalidArgument.")
      .def("findState", &Model::findState, py::arg("name"), "Its index, or None.")
      .def("findAction", &Model::findAction, py::arg("name"), "Its index, or None.")
      .def("findObservation", &Model::findObservation, py::arg("name"), "Its index, or None.");
}

void bindNumbers(py::class_<Model>& model)
{
  model.def_property_readonly("discount", &Model::discount, "In (0, 1].")
      .def_property_readonly("initial_belief", &Model::initialBelief,
                             py::return_value_policy::reference_internal,
                             "Before anything is seen.")
      .def_property_readonly("initial_labels", &Model::initialLabels,
                             "What the robot sees before its first action: a label for each state; "
                             "empty when it sees nothing.")
      .def(
          "initialOutcomes",
          [](const Model& m) {
    std::vector<std::pair<double, Belief>> outcomes;
    for (const InitialOutcome& outcome : m.initialOutcomes())
    {
      outcomes.emplace_back(outcome.probability, outcome.belief);
    }
    return outcomes;
          },
          "The beliefs that the robot may have before its first action, with their probabilities.")
      .def("transitionArray", &transitionArray,
           "T(s' | s, a), shape [num_actions, num_states, num_states]. Raises ResourceExhausted "
           "above 2^27 entries.")
      .def("observationArray", &observationArray,
           "O(o | a, s'), shape [num_actions, num_states, num_observations]. Raises "
           "ResourceExhausted above 2^27 entries.")
      .def("transitionEntries", &transitionEntries,
           "What is not 0 in T: indices (action, state, next state), shape [n, 3], and "
           "probabilities, shape [n].")
      .def("observationEntries", &observationEntries,
           "What is not 0 in O: indices (action, next state, observation), shape [n, 3], and "
           "probabilities, shape [n].")
      .def("rewardArray", &rewardArray,
           "The expected immediate reward R(a, s), shape [num_actions, num_states].")
      .def(
          "withInitialBelief",
          [](const Model& m, const BeliefArgument& belief) {
    return m.withInitialBelief(belief.belief());
          },
          py::arg("belief"),
          "The same model started elsewhere; the robot sees nothing before its first action. "
          "Raises InvalidArgument.")
      .def("sizeInBytes", &Model::sizeInBytes, "Memory held, roughly.");
}

using AnyKey = std::optional<Key>;

template <typename Find>
std::size_t indexOrAny(const AnyKey& key, Find find)
{
  if (!key)
  {
    return kAny;
  }
  const auto* index = std::get_if<std::size_t>(&*key);
  return index != nullptr ? *index : find(std::get<std::string>(*key));
}

std::size_t stateIn(const ModelBuilder& builder, const AnyKey& key)
{
  return indexOrAny(key, [&](const std::string& name) { return builder.state(name); });
}

std::size_t actionIn(const ModelBuilder& builder, const AnyKey& key)
{
  return indexOrAny(key, [&](const std::string& name) { return builder.action(name); });
}

std::size_t observationIn(const ModelBuilder& builder, const AnyKey& key)
{
  return indexOrAny(key, [&](const std::string& name) { return builder.observation(name); });
}

using Setter = void (ModelBuilder::*)(std::size_t, std::size_t, std::size_t, double);

template <Setter setter>
void set(ModelBuilder& b, const AnyKey& action, const AnyKey& state, const AnyKey& column, double p)
{
  constexpr bool kTransition =
      setter == &ModelBuilder::setTransition || setter == &ModelBuilder::addTransition;
  (b.*setter)(actionIn(b, action), stateIn(b, state),
              kTransition ? stateIn(b, column) : observationIn(b, column), p);
}

void bindBuilder(py::module_& module)
{
  py::class_<ModelBuilder>(module, "ModelBuilder",
                           "Collects a model piece by piece. What is set later replaces what was "
                           "set before; what is never set is 0, and the initial belief is uniform. "
                           "States, actions and observations are indices or names; None is every.")
      .def(py::init<std::vector<std::string>, std::vector<std::string>, std::vector<std::string>>(),
           py::arg("states"), py::arg("actions"), py::arg("observations"),
           "From names. Raises InvalidArgument: an empty list, a duplicate or empty name.")
      .def("setDiscount", &ModelBuilder::setDiscount, py::arg("discount"), "In (0, 1].")
      .def(
          "setInitialBelief",
          [](ModelBuilder& b, BeliefArgument belief) {
    b.setInitialBelief(std::move(belief.probabilities));
          },
          py::arg("probabilities"), "Shape [num_states]; build() checks it.")
      .def("setTransition", &set<&ModelBuilder::setTransition>, py::arg("action"), py::arg("state"),
           py::arg("next_state"), py::arg("probability"),
           "T(next_state | state, action) = probability. Raises InvalidArgument, NotFound.")
      .def("addTransition", &set<&ModelBuilder::addTransition>, py::arg("action"), py::arg("state"),
           py::arg("next_state"), py::arg("probability"), "Adds to T(next_state | state, action).")
      .def("setObservation", &set<&ModelBuilder::setObservation>, py::arg("action"),
           py::arg("next_state"), py::arg("observation"), py::arg("probability"),
           "O(observation | action, next_state) = probability. Raises InvalidArgument, NotFound.")
      .def("addObservation", &set<&ModelBuilder::addObservation>, py::arg("action"),
           py::arg("next_state"), py::arg("observation"), py::arg("probability"),
           "Adds to O(observation | action, next_state).")
      .def(
          "setReward",
          [](ModelBuilder& b, const AnyKey& action, const AnyKey& state, double value,
             const AnyKey& next_state, const AnyKey& observation) {
    b.setReward(actionIn(b, action), stateIn(b, state), stateIn(b, next_state),
                observationIn(b, observation), value);
          },
          py::arg("action"), py::arg("state"), py::arg("value"),
          py::arg("next_state") = std::nullopt, py::arg("observation") = std::nullopt,
          "R(action, state, next_state, observation) = value; the model keeps the expectation "
          "R(a, s).")
      .def("build", &ModelBuilder::build, py::arg("sum_tolerance") = 1e-6,
           "The model. Raises InvalidArgument naming the row of T or O that does not sum to 1 "
           "within the tolerance, or the entry that is no probability.");
}

void writeTo(const std::string& path, const Model& model,
             void (*write)(std::ostream&, const Model&))
{
  std::ofstream out(path);
  if (out)
  {
    write(out, model);
    out.close();
  }
  if (!out)
  {
    throw Unavailable("cannot write '" + path + "'");
  }
}

void bindFiles(py::module_& module)
{
  using Released = py::call_guard<py::gil_scoped_release>;
  module.def("loadModel", &loadModel, py::arg("path"), Released(),
             "Reads a file in the .pomdp or .pomdpx format. Raises Unavailable, or InvalidArgument "
             "with 'file:line:column: message'.");
  module.def(
      "writePomdp",
      [](const std::string& path, const Model& model) { writeTo(path, model, &writePomdp); },
      py::arg("path"), py::arg("model"), Released(),
      "Writes Cassandra's format such that loadModel gives the same model, to the last bit. Raises "
      "Unavailable, InvalidArgument.");
  module.def(
      "writePomdpx",
      [](const std::string& path, const Model& model) { writeTo(path, model, &writePomdpx); },
      py::arg("path"), py::arg("model"), Released(),
      "Writes the POMDPX format, with one state variable. Raises Unavailable.");
}

}  // namespace

void bindModels(py::module_& module)
{
  py::class_<Model> model(module, "Model",
                          "A flat, sparse POMDP: an immutable value. From ModelBuilder, "
                          "modelFromArrays, a FactoredModel or a file.");
  bindNames(model);
  bindNumbers(model);
  bindBuilder(module);
  module.def("modelFromArrays", &modelFromArrays, py::arg("transitions"), py::arg("observations"),
             py::arg("rewards"), py::kw_only(), py::arg("discount"),
             py::arg("initial_belief") = std::nullopt, py::arg("states") = std::nullopt,
             py::arg("actions") = std::nullopt, py::arg("observation_names") = std::nullopt,
             py::arg("sum_tolerance") = 1e-6,
             "A model from arrays: T(s' | s, a) of shape [A, S, S], O(o | a, s') of shape "
             "[A, S, O], R of shape [A, S], [A, S, S] or [A, S, S, O]. Each may also be sparse: a "
             "pair of indices, shape [n, 3] (for R [n, 2], [n, 3] or [n, 4]), and values, shape "
             "[n]; or a dict from tuples of indices to values; probabilities of equal indices add "
             "up. `states`, `actions` and `observation_names` are names or how many there are; "
             "only what no dense array tells is needed. Raises InvalidArgument naming the array or "
             "row that is wrong.");
  bindFiles(module);
  module.def(
      "updated",
      [](const Model& m, const BeliefArgument& belief, const Key& action, const Key& observation) {
    return updated(m, belief.belief(), actionOf(m, action), observationOf(m, observation));
      },
      py::arg("model"), py::arg("belief"), py::arg("action"), py::arg("observation"),
      "The exact Bayesian update of a belief. Raises FailedPrecondition when the observation is "
      "impossible after the action, InvalidArgument, NotFound.");
  module.def(
      "observationProbabilities",
      [](const Model& m, const BeliefArgument& belief, const Key& action) {
    return arrayOf(observationProbabilities(m, belief.belief(), actionOf(m, action)));
      },
      py::arg("model"), py::arg("belief"), py::arg("action"),
      "Pr(o | belief, action) for every observation, shape [num_observations].");
}

}  // namespace kr3::pomdp
