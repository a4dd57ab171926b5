#include <chrono>
#include <functional>
#include <utility>

#include "bindings.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

void bindPlans(py::module_& module)
{
  py::enum_<PlanPreference>(module, "PlanPreference")
      .value("kShortest", PlanPreference::kShortest, "fewest steps, then fewest actions")
      .value("kCheapestShortest", PlanPreference::kCheapestShortest,
             "fewest steps, then the least cost")
      .value("kCheapest", PlanPreference::kCheapest, "the least cost up to the longest horizon");
  py::class_<PlanOptions>(module, "PlanOptions", "Which plans are wanted, and within which limits.")
      .def(py::init([](int max_horizon, std::chrono::milliseconds time_limit,
                       std::function<void(int)> on_horizon, PlanPreference preference, bool all,
                       int max_plans, bool relevant_only) {
             PlanOptions options;
             options.max_horizon = max_horizon;
             options.time_limit = time_limit;
             options.on_horizon = std::move(on_horizon);
             options.preference = preference;
             options.all = all;
             options.max_plans = max_plans;
             options.relevant_only = relevant_only;
             return options;
           }),
           py::kw_only(), py::arg("max_horizon") = PlanOptions().max_horizon,
           py::arg("time_limit") = PlanOptions().time_limit, py::arg("on_horizon") = nullptr,
           py::arg("preference") = PlanPreference::kShortest, py::arg("all") = false,
           py::arg("max_plans") = PlanOptions().max_plans, py::arg("relevant_only") = true)
      .def_readwrite("max_horizon", &PlanOptions::max_horizon, "steps of the longest plan to try")
      .def_readwrite("time_limit", &PlanOptions::time_limit, "wall time, a timedelta or seconds")
      .def_readwrite("on_horizon", &PlanOptions::on_horizon, "called with each horizon, if set")
      .def_readwrite("preference", &PlanOptions::preference, "which plans are wanted")
      .def_readwrite("all", &PlanOptions::all, "all plans that are equally good")
      .def_readwrite("max_plans", &PlanOptions::max_plans,
                     "with `all`: at most so many for a hypothesis")
      .def_readwrite("relevant_only", &PlanOptions::relevant_only,
                     "plan on what can matter to the goal; the answer is the same")
      .def_readwrite("extra_share", &PlanOptions::extra_share,
                     "this share of the constants that do not matter is kept, in [0, 1]");
  py::class_<ProblemSize>(module, "ProblemSize", "The size of a description with its history.")
      .def_readonly("fluents", &ProblemSize::fluents, "ground, statics left out")
      .def_readonly("constants", &ProblemSize::constants, "elements of sorts")
      .def_readonly("actions", &ProblemSize::actions, "ground, exogenous ones left out")
      .def_readonly("records", &ProblemSize::records, "of the history");
  py::class_<Plan>(module, "Plan", "A plan under a hypothesis.")
      .def_readonly("hypothesis", &Plan::hypothesis, "literals; empty when nothing is assumed")
      .def_readonly("steps", &Plan::steps, "ground actions that occur together, a list a step")
      .def_readonly("cost", &Plan::cost, "of its actions, the largest under the hypothesis");
  py::class_<PlanResult>(module, "PlanResult", "Plans, or why there is none.")
      .def_readonly("goal_entailed", &PlanResult::goal_entailed, "nothing to do")
      .def_readonly("plans", &PlanResult::plans, "one a hypothesis, more with `all`")
      .def_readonly("complete", &PlanResult::complete,
                    "False when max_plans or the time limit left plans out")
      .def_readonly("covers_all", &PlanResult::covers_all,
                    "False when some possible state has no plan within the horizon")
      .def_readonly("reason", &PlanResult::reason, "when there is no plan: why")
      .def_readonly("cpu_s", &PlanResult::cpu_s, "CPU time that planning took, in seconds")
      .def_readonly("considered", &PlanResult::considered, "what was planned with")
      .def_readonly("whole", &PlanResult::whole, "of how much")
      .def_readonly("widened", &PlanResult::widened,
                    "how often the relevant part was too small and was computed anew");
  py::class_<RelevantItem>(module, "RelevantItem",
                           "A constant, fluent or action that can matter to a goal, and why.")
      .def_readonly("name", &RelevantItem::name, "as in the language")
      .def_readonly("why", &RelevantItem::why, "from the goal to the item, a sentence a step");
  py::class_<RelevantPart>(module, "RelevantPart", "What can matter to a goal.")
      .def_readonly("constants", &RelevantPart::constants, "elements of sorts")
      .def_readonly("fluents", &RelevantPart::fluents, "ground; a plan depends on no others")
      .def_readonly("actions", &RelevantPart::actions,
                    "ground; an argument that may be anything relevant is _")
      .def_readonly("records", &RelevantPart::records, "about relevant fluents and actions")
      .def_readonly("considered", &RelevantPart::considered, "the size of this part")
      .def_readonly("whole", &RelevantPart::whole, "of how much");
}

}  // namespace kr3::reasoner
