#include <utility>

#include <kr3_common/error.hpp>

#include "bindings.hpp"
#include "kr3_pomdp/factored_model.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

Factor factorOf(std::vector<VariableRef> parents, std::vector<VariableRef> of, const Values& values)
{
  return {std::move(parents), std::move(of),
          std::vector<double>(values.data(), values.data() + values.size())};
}

/// @throws NotFound  no such variable
VariableRef refOf(const FactoredModel& model, VariableRole role, const std::string& name)
{
  std::size_t size = model.state.size();
  if (role == VariableRole::kAction)
  {
    size = model.actions.size();
  }
  else if (role == VariableRole::kObservation)
  {
    size = model.observations.size();
  }
  for (std::size_t i = 0; i < size; ++i)
  {
    if (model.variable({role, i}).name == name)
    {
      return {role, i};
    }
  }
  throw NotFound("no variable '" + name + "' in this role");
}

/// The factor's values in the shape of its variables.
py::array_t<double> valuesIn(const FactoredModel& model, const Factor& factor)
{
  if (model.sizeOf(factor) != factor.values.size())
  {
    throw InvalidArgument("a factor of " + std::to_string(factor.values.size()) +
                          " values, expected " + std::to_string(model.sizeOf(factor)));
  }
  std::vector<py::ssize_t> shape;
  for (const std::vector<VariableRef>* refs : {&factor.parents, &factor.of})
  {
    for (const VariableRef& ref : *refs)
    {
      shape.push_back(static_cast<py::ssize_t>(model.variable(ref).values.size()));
    }
  }
  return arrayOf(factor.values, shape);
}

void bindVariables(py::module_& module)
{
  py::class_<Variable>(module, "Variable", "A variable of a factored model.")
      .def(py::init([](std::string name, std::vector<std::string> values) {
             return Variable{std::move(name), std::move(values)};
           }),
           py::arg("name"), py::arg("values"), "Its values are names.")
      .def_readonly("name", &Variable::name, "what it is called")
      .def_readonly("values", &Variable::values, "their names");
  py::class_<StateVariable, Variable>(module, "StateVariable", "A variable of the state.")
      .def(py::init([](std::string name, std::vector<std::string> values, bool observed) {
             return StateVariable{{std::move(name), std::move(values)}, observed};
           }),
           py::arg("name"), py::arg("values"), py::arg("observed") = false, "Its values are names.")
      .def_readonly("observed", &StateVariable::observed,
                    "whether the robot sees it before each action, the first included");
  py::enum_<VariableRole>(module, "VariableRole")
      .value("kPrevious", VariableRole::kPrevious, "of the state before the action")
      .value("kAction", VariableRole::kAction)
      .value("kCurrent", VariableRole::kCurrent, "of the state after it")
      .value("kObservation", VariableRole::kObservation);
  py::class_<VariableRef>(module, "VariableRef", "A variable in a factor.")
      .def(py::init([](VariableRole role, std::size_t index) {
             return VariableRef{role, index};
           }),
           py::arg("role"), py::arg("index"), "The index counts among the variables of its role.")
      .def_readonly("role", &VariableRef::role, "what it is in the factor")
      .def_readonly("index", &VariableRef::index, "among those of its role")
      .def("__eq__", [](const VariableRef& a, const VariableRef& b) { return a == b; });
  py::class_<Factor>(module, "Factor", "A function of some variables.")
      .def(py::init(&factorOf), py::arg("parents"), py::arg("of"), py::arg("values"),
           "The probabilities of the values of `of` given those of `parents`; a reward has no "
           "`of`. Values: one axis for each variable, parents first, or that flattened row by row.")
      .def_readonly("parents", &Factor::parents, "what it is given")
      .def_readonly("of", &Factor::of, "what it gives the probabilities of; none for a reward")
      .def_property_readonly(
          "values", [](const Factor& f) { return arrayOf(f.values); },
          "Flat; the last variable changes fastest.");
}

using ModelClass = py::class_<FactoredModel>;
using Factors = std::vector<Factor> FactoredModel::*;

template <Factors list>
void bindFactors(ModelClass& model, const char* name, const char* add, const char* what)
{
  model.def_property_readonly(
      name, [](const FactoredModel& m) { return m.*list; }, what);
  model.def(
      add, [](FactoredModel& m, Factor factor) { (m.*list).push_back(std::move(factor)); },
      py::arg("factor"), "Adds one; flattened() checks it.");
}

}  // namespace

void bindFactoredModels(py::module_& module)
{
  bindVariables(module);
  ModelClass model(module, "FactoredModel",
                   "A POMDP in factors, a dynamic Bayesian network: products of the probabilities "
                   "of its variables, sums of rewards. flattened() makes a Model of it.");
  model
      .def(py::init([](std::vector<StateVariable> state, std::vector<Variable> actions,
                       std::vector<Variable> observations, double discount) {
             FactoredModel made;
             made.state = std::move(state);
             made.actions = std::move(actions);
             made.observations = std::move(observations);
             made.discount = discount;
             return made;
           }),
           py::arg("state"), py::arg("actions"), py::arg("observations"), py::arg("discount"),
           "Its variables; factors are added afterwards.")
      .def_readonly("state", &FactoredModel::state, "the variables of the state")
      .def_readonly("actions", &FactoredModel::actions, "one of each is chosen at a time")
      .def_readonly("observations", &FactoredModel::observations, "one of each is made at a time")
      .def_readonly("discount", &FactoredModel::discount, "in (0, 1]")
      .def("ref", &refOf, py::arg("role"), py::arg("name"),
           "A variable by its name. Raises NotFound.")
      .def("valuesOf", &valuesIn, py::arg("factor"),
           "The values of a factor, an axis for each variable, parents first.")
      .def("flattened", &FactoredModel::flattened, py::arg("sum_tolerance") = 1e-6,
           py::call_guard<py::gil_scoped_release>(),
           "The flat model: a state is a value of each state variable, named by them joined with "
           "commas; an observation names the seen state variables too. Raises InvalidArgument "
           "naming the factor that is wrong, ResourceExhausted above 2^24 states.");
  bindFactors<&FactoredModel::initial>(model, "initial", "addInitial",
                                       "Factors of kPrevious given kPrevious.");
  bindFactors<&FactoredModel::transitions>(model, "transitions", "addTransition",
                                           "Factors of kCurrent given kPrevious, kAction, "
                                           "kCurrent.");
  bindFactors<&FactoredModel::observing>(model, "observing", "addObserving",
                                         "Factors of kObservation given kAction, kCurrent, "
                                         "kObservation.");
  bindFactors<&FactoredModel::rewards>(model, "rewards", "addReward",
                                       "Factors that give a reward; it is their sum.");
  module.def("loadPomdpx", &loadPomdpx, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
             "Reads a .pomdpx file in its factors; loadModel gives the flat model. Raises "
             "Unavailable, or InvalidArgument with 'file:line:column: message'.");
}

}  // namespace kr3::pomdp
