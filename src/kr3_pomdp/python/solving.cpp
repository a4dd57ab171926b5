#include <chrono>
#include <exception>
#include <functional>
#include <utility>

#include <kr3_common/error.hpp>

#include "bindings.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

using Listener = std::function<py::object(const SolverProgress&)>;

/// Solves without the interpreter, which is asked now and then whether to go on.
/// @throws pybind11::error_already_set  Ctrl-C, or what the listener raised
SolveResult solveListening(const Model& model, const SolverLimits& limits,
                           const std::optional<Listener>& keep_going, double period_s)
{
  if (!keep_going && limits.precision == 0.0 && limits.time_s == 0.0 && limits.max_backups == 0 &&
      limits.max_memory_bytes == 0)
  {
    throw InvalidArgument("precision 0 without time, backups, memory or keep_going: no limit");
  }
  using Clock = std::chrono::steady_clock;
  constexpr double kPollSignals = 0.02;
  std::exception_ptr raised;
  Clock::time_point polled = Clock::now();
  Clock::time_point told = polled - std::chrono::hours(1);
  const auto listen = [&](const SolverProgress& progress) {
    const Clock::time_point now = Clock::now();
    const auto passed = [&](Clock::time_point since, double seconds) {
      return std::chrono::duration<double>(now - since).count() >= seconds;
    };
    const bool tell = keep_going && passed(told, period_s);
    if (!tell && !passed(polled, kPollSignals))
    {
      return true;
    }
    polled = now;
    const py::gil_scoped_acquire acquire;
    try
    {
      if (PyErr_CheckSignals() != 0)
      {
        throw py::error_already_set();
      }
      if (tell)
      {
        told = now;
        return !(*keep_going)(progress).is(py::bool_(false));
      }
      return true;
    }
    catch (...)
    {
      raised = std::current_exception();
      return false;
    }
  };
  std::optional<SolveResult> result;
  {
    const py::gil_scoped_release release;
    result = solve(model, limits, listen);
  }
  if (raised)
  {
    std::rethrow_exception(raised);
  }
  return *std::move(result);
}

void bindLimits(py::module_& module)
{
  py::class_<SolverLimits>(module, "SolverLimits",
                           "When to stop solving, whichever comes first. With counted work alone a "
                           "run repeats exactly.")
      .def(py::init([](double precision, double time_s, std::uint64_t max_backups,
                       std::size_t max_memory_bytes, int num_threads) {
             return SolverLimits{precision, time_s, max_backups, max_memory_bytes, num_threads};
           }),
           py::kw_only(), py::arg("precision") = SolverLimits().precision,
           py::arg("time_s") = SolverLimits().time_s,
           py::arg("max_backups") = SolverLimits().max_backups,
           py::arg("max_memory_bytes") = SolverLimits().max_memory_bytes,
           py::arg("num_threads") = SolverLimits().num_threads, "See the attributes.")
      .def_readwrite("precision", &SolverLimits::precision,
                     "gap between the bounds at the initial belief, at least 0")
      .def_readwrite("time_s", &SolverLimits::time_s, "wall time; 0: no limit")
      .def_readwrite("max_backups", &SolverLimits::max_backups, "point-based backups; 0: no limit")
      .def_readwrite("max_memory_bytes", &SolverLimits::max_memory_bytes,
                     "held by the search, without the model; 0: no limit")
      .def_readwrite("num_threads", &SolverLimits::num_threads, "at least 1");
  py::class_<SolverProgress>(module, "SolverProgress", "How far solving is.")
      .def_readonly("lower", &SolverProgress::lower, "at the initial belief; never falls")
      .def_readonly("upper", &SolverProgress::upper, "at the initial belief; never rises")
      .def_readonly("backups", &SolverProgress::backups, "so far")
      .def_readonly("num_alpha_vectors", &SolverProgress::num_alpha_vectors, "of the policy so far")
      .def_readonly("elapsed_s", &SolverProgress::elapsed_s, "wall time")
      .def_readonly("memory_bytes", &SolverProgress::memory_bytes, "held by the search");
}

void bindSolve(py::module_& module)
{
  py::enum_<StopReason>(module, "StopReason")
      .value("kPrecision", StopReason::kPrecision)
      .value("kTimeLimit", StopReason::kTimeLimit)
      .value("kBackupLimit", StopReason::kBackupLimit)
      .value("kCancelled", StopReason::kCancelled, "keep_going said no")
      .value("kMemoryLimit", StopReason::kMemoryLimit)
      .def(
          "__str__", [](StopReason reason) { return toString(reason); }, py::prepend());
  py::class_<SolveResult>(module, "SolveResult", "A policy with its bounds.")
      .def_readonly("policy", &SolveResult::policy, "the best one found")
      .def_readonly("lower", &SolveResult::lower, "what the policy earns at least")
      .def_readonly("upper", &SolveResult::upper, "no policy earns more")
      .def_readonly("backups", &SolveResult::backups, "counted work")
      .def_readonly("reason", &SolveResult::reason, "why it stopped")
      .def_readonly("elapsed_s", &SolveResult::elapsed_s, "wall time")
      .def_readonly("cpu_s", &SolveResult::cpu_s, "CPU time, of all its threads")
      .def_readonly("memory_bytes", &SolveResult::memory_bytes, "held by the search at its end");
  module.def("solve", &solveListening, py::arg("model"), py::arg("limits") = SolverLimits(),
             py::arg("keep_going") = std::nullopt, py::arg("period_s") = 0.05,
             "Solves a model from its initial belief with lower and upper bounds, anytime. "
             "`keep_going` is called at most every `period_s` seconds of wall time; when it "
             "returns False, the result is the best policy so far. Other Python threads run on "
             "meanwhile; Ctrl-C ends it with KeyboardInterrupt. Raises InvalidArgument: a limit "
             "out of range, or none that can end the run.");
}

void bindSimulation(py::module_& module)
{
  py::class_<std::mt19937_64>(module, "Random",
                              "Random numbers; one seed gives the same ones everywhere.")
      .def(py::init<std::uint64_t>(), py::arg("seed"), "A generator of its own.")
      .def(
          "uniform",
          [](std::mt19937_64& random) { return static_cast<double>(random() >> 11U) * 0x1.0p-53; },
          "The next number in [0, 1).");
  py::class_<SampledStep>(module, "SampledStep", "One sampled step of the world.")
      .def_readonly("next_state", &SampledStep::next_state, "its index")
      .def_readonly("observation", &SampledStep::observation, "its index");
  module.def(
      "sampleStep",
      [](const Model& m, const Key& state, const Key& action, std::mt19937_64& random) {
    return sampleStep(m, stateOf(m, state), actionOf(m, action), random);
      },
      py::arg("model"), py::arg("state"), py::arg("action"), py::arg("random"),
      "Samples the next state and the observation; the reward is in rewardArray(). Raises "
      "InvalidArgument, NotFound.");
  module.def(
      "sampleState",
      [](const BeliefArgument& belief, std::mt19937_64& random) {
    return sampleState(belief.belief(), random);
      },
      py::arg("belief"), py::arg("random"), "Samples the index of a state.");
}

void bindEvaluation(py::module_& module)
{
  py::class_<EvaluationLimits>(module, "EvaluationLimits", "How much to simulate.")
      .def(py::init([](std::uint64_t trials, double truncation, std::uint64_t max_steps,
                       int num_threads) {
             EvaluationLimits limits;
             limits.trials = trials;
             limits.truncation = truncation;
             limits.max_steps = max_steps;
             limits.num_threads = num_threads;
             return limits;
           }),
           py::kw_only(), py::arg("trials") = EvaluationLimits().trials,
           py::arg("truncation") = EvaluationLimits().truncation,
           py::arg("max_steps") = EvaluationLimits().max_steps,
           py::arg("num_threads") = EvaluationLimits().num_threads, "See the attributes.")
      .def_readwrite("trials", &EvaluationLimits::trials, "how many")
      .def_readwrite("truncation", &EvaluationLimits::truncation,
                     "a trial ends when its discount is below this")
      .def_readwrite("max_steps", &EvaluationLimits::max_steps, "of a trial")
      .def_readwrite("num_threads", &EvaluationLimits::num_threads,
                     "at least 1; the result is the same for any number");
  py::class_<Evaluation>(module, "Evaluation", "The discounted return of a policy, simulated.")
      .def_readonly("mean", &Evaluation::mean, "over the trials")
      .def_readonly("standard_error", &Evaluation::standard_error, "of the mean")
      .def_readonly("half_width_95", &Evaluation::half_width_95,
                    "the mean is within this of the true value with 95 % confidence")
      .def_readonly("trials", &Evaluation::trials, "how many")
      .def_readonly("mean_steps", &Evaluation::mean_steps, "of a trial")
      .def_readonly("finished", &Evaluation::finished,
                    "part of the trials that came to where all is over");
  module.def("evaluate", &evaluate, py::arg("model"), py::arg("policy"),
             py::arg("limits") = EvaluationLimits(), py::arg("seed") = 1,
             py::call_guard<py::gil_scoped_release>(),
             "Simulates a policy from the initial belief. Raises InvalidArgument: a policy that "
             "does not fit the model, no trials.");
}

}  // namespace

void bindSolving(py::module_& module)
{
  bindLimits(module);
  bindSolve(module);
  bindSimulation(module);
  bindEvaluation(module);
}

}  // namespace kr3::pomdp
