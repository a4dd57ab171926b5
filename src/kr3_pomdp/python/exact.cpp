#include "bindings.hpp"
#include "kr3_pomdp/exact_solver.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

void bindExactSolver(py::module_& module)
{
  const ExactLimits defaults;
  py::class_<ExactSolution>(module, "ExactSolution",
                            "The optimal value function, as the maximum of alpha vectors over all "
                            "states.")
      .def_readonly("stages", &ExactSolution::stages,
                    "with a horizon, element k is for k + 1 steps to go; else one for all steps")
      .def_readonly("error", &ExactSolution::error,
                    "the value at any belief is at most the optimum, and at most this much below")
      .def_readonly("iterations", &ExactSolution::iterations, "of value iteration")
      .def(
          "valueAt",
          [](const ExactSolution& s, const BeliefArgument& b) { return s.valueAt(b.belief()); },
          py::arg("belief"), "With all steps to go. Raises InvalidArgument.");
  module.def(
      "solveExactly",
      [](const Model& model, std::size_t horizon, double precision, std::size_t max_vectors,
         double time_s) {
    return solveExactly(model, {horizon, precision, max_vectors, time_s});
      },
      py::arg("model"), py::kw_only(), py::arg("horizon") = defaults.horizon,
      py::arg("precision") = defaults.precision, py::arg("max_vectors") = defaults.max_vectors,
      py::arg("time_s") = defaults.time_s, py::call_guard<py::gil_scoped_release>(),
      "Solves a small model exactly at every belief (incremental pruning): over `horizon` steps, "
      "with discount 1 too, or for ever (0) to within `precision`. Its work grows exponentially; "
      "`max_vectors` and `time_s` (wall time, 0 for none) bound it. Raises InvalidArgument, "
      "ResourceExhausted, DeadlineExceeded.");
}

}  // namespace kr3::pomdp
