#include <memory>
#include <random>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/belief_planner.hpp"
#include "kr3_pomdp/particle_belief.hpp"
#include "python_model.hpp"

namespace py = pybind11;

namespace kr3::pomdp
{

namespace
{

/// An OnlinePlanner on a flat model.
class ModelPlanner
{
public:
  ModelPlanner(const Model& model, const OnlineOptions& options, const Policy* policy)
    : sampled_(model, policy), planner_(sampled_, options), num_states_(model.numStates())
  {
  }

  [[nodiscard]] OnlineDecision plan(const BeliefArgument& argument, std::uint64_t seed) const
  {
    const Belief belief = argument.belief();
    if (belief.size() != num_states_)
    {
      throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                            std::to_string(num_states_));
    }
    const py::gil_scoped_release release;
    return planner_.plan(sampler(belief), seed);
  }

private:
  SampledModel sampled_;
  OnlinePlanner planner_;
  std::size_t num_states_;
};

/// An OnlinePlanner on a generative model written in Python, with the robot's belief as samples.
class GenerativePlanner
{
public:
  GenerativePlanner(py::object model, const py::iterable& states, const OnlineOptions& options,
                    const ParticleOptions& particles, std::uint64_t seed)
    : model_(std::move(model))
    , planner_(model_, options)
    , particles_(particles)
    , random_(seed)
    , belief_(numbersOf(states))
  {
  }

  void restart(const py::iterable& states)
  {
    belief_ = ParticleBelief(numbersOf(states));
    forget();
  }

  [[nodiscard]] py::list states() const
  {
    py::list objects;
    for (const std::uint64_t number : belief_.states())
    {
      objects.append(model_.state(number));
    }
    return objects;
  }

  OnlineDecision plan()
  {
    const OnlineDecision decision = planner_.plan(belief_.sampler(), random_());
    forget();
    return decision;
  }

  void advance(std::size_t action, const py::object& observation)
  {
    belief_ = updated(model_, belief_, action, model_.observationNumber(observation), particles_,
                      random_);
    forget();
  }

private:
  std::vector<std::uint64_t> numbersOf(const py::iterable& states) const
  {
    std::vector<std::uint64_t> numbers;
    for (const py::handle& state : states)
    {
      numbers.push_back(model_.stateNumber(state));
    }
    return numbers;
  }

  /// Lets go of the states that only planning met.
  void forget() { belief_ = ParticleBelief(model_.keepOnly(belief_.states())); }

  PythonModel model_;
  OnlinePlanner planner_;
  ParticleOptions particles_;
  std::mt19937_64 random_;
  ParticleBelief belief_;
};

void bindOptions(py::module_& module)
{
  const OnlineOptions defaults;
  py::class_<OnlineOptions>(module, "OnlineOptions", "How OnlinePlanner searches.")
      .def(py::init([](std::size_t num_scenarios, std::size_t max_depth, double regularisation,
                       double target, double time_s, std::uint64_t max_expansions) {
             return OnlineOptions{num_scenarios, max_depth, regularisation,
                                  target,        time_s,    max_expansions};
           }),
           py::kw_only(), py::arg("num_scenarios") = defaults.num_scenarios,
           py::arg("max_depth") = defaults.max_depth,
           py::arg("regularisation") = defaults.regularisation, py::arg("target") = defaults.target,
           py::arg("time_s") = defaults.time_s, py::arg("max_expansions") = defaults.max_expansions,
           "See the attributes.")
      .def_readwrite("num_scenarios", &OnlineOptions::num_scenarios, "samples of the belief")
      .def_readwrite("max_depth", &OnlineOptions::max_depth, "steps ahead")
      .def_readwrite("regularisation", &OnlineOptions::regularisation,
                     "price of one more node in a plan's tree, at least 0: plans made for few "
                     "samples must gain as much")
      .def_readwrite("target", &OnlineOptions::target,
                     "of the gap at the root that a trial leaves, in (0, 1)")
      .def_readwrite("time_s", &OnlineOptions::time_s, "wall time of a decision; 0: no limit")
      .def_readwrite("max_expansions", &OnlineOptions::max_expansions,
                     "counted work, repeats exactly; 0: no limit");
  py::class_<OnlineDecision>(module, "OnlineDecision", "What to do, and how sure that is.")
      .def_readonly("action", &OnlineDecision::action, "its index")
      .def_readonly("lower", &OnlineDecision::lower, "of the value over the scenarios, regularised")
      .def_readonly("upper", &OnlineDecision::upper, "of the value over the scenarios")
      .def_readonly("expansions", &OnlineDecision::expansions, "counted work")
      .def_readonly("num_nodes", &OnlineDecision::num_nodes, "of the tree");
  const ParticleOptions particles;
  py::class_<ParticleOptions>(module, "ParticleOptions", "Of a belief as samples.")
      .def(py::init([](std::size_t num_particles, std::size_t tries) {
             return ParticleOptions{num_particles, tries};
           }),
           py::kw_only(), py::arg("num_particles") = particles.num_particles,
           py::arg("tries") = particles.tries, "See the attributes.")
      .def_readwrite("num_particles", &ParticleOptions::num_particles, "how many are kept")
      .def_readwrite("tries", &ParticleOptions::tries,
                     "without observationProbability: samples for an update, per particle");
}

void bindModelPlanner(py::module_& module)
{
  py::class_<ModelPlanner>(module, "OnlinePlanner",
                           "Plans one action at a time by sampling (DESPOT) on a Model. Without a "
                           "policy its first lower bound is to act as if the state were known.")
      .def(py::init<const Model&, const OnlineOptions&, const Policy*>(), py::arg("model"),
           py::arg("options") = OnlineOptions(), py::arg("policy") = nullptr,
           py::keep_alive<1, 2>(), py::keep_alive<1, 4>(),
           "Raises InvalidArgument: an option out of range, a policy that does not fit.")
      .def("plan", &ModelPlanner::plan, py::arg("belief"), py::arg("seed") = 1,
           "The action at a belief; counted work and one seed repeat exactly.");
}

void bindBeliefPlanner(py::module_& module)
{
  using Released = py::call_guard<py::gil_scoped_release>;
  const BeliefPlannerOptions defaults;
  py::class_<BeliefPlannerOptions>(module, "BeliefPlannerOptions", "How BeliefPlanner searches.")
      .def(py::init([](double precision, double time_s, std::uint64_t max_expansions) {
             return BeliefPlannerOptions{precision, time_s, max_expansions};
           }),
           py::kw_only(), py::arg("precision") = defaults.precision,
           py::arg("time_s") = defaults.time_s, py::arg("max_expansions") = defaults.max_expansions,
           "See the attributes.")
      .def_readwrite("precision", &BeliefPlannerOptions::precision,
                     "gap at the belief below which it stops, at least 0")
      .def_readwrite("time_s", &BeliefPlannerOptions::time_s,
                     "wall time of a decision; 0: no limit")
      .def_readwrite("max_expansions", &BeliefPlannerOptions::max_expansions,
                     "counted work, repeats exactly; 0: no limit");
  py::class_<BeliefDecision>(module, "BeliefDecision", "What to do, and how sure that is.")
      .def_readonly("action", &BeliefDecision::action, "its index")
      .def_readonly("lower", &BeliefDecision::lower, "planning on like this earns at least this")
      .def_readonly("upper", &BeliefDecision::upper, "nobody earns more")
      .def_readonly("expansions", &BeliefDecision::expansions, "counted work");
  py::class_<BeliefPlanner>(module, "BeliefPlanner",
                            "Plans one action at a time on a Model by searching the tree of exact "
                            "beliefs, with an offline policy as its lower bound, than which it "
                            "never does worse. It keeps the robot's belief.")
      .def(py::init<const Model&, const Policy&, const BeliefPlannerOptions&>(), py::arg("model"),
           py::arg("policy"), py::arg("options") = BeliefPlannerOptions(), Released(),
           "At the model's initial belief, or at the first of its initial outcomes. Raises "
           "InvalidArgument.")
      .def_property_readonly(
          "belief", [](const BeliefPlanner& p) { return p.belief(); }, "Where the robot is.")
      .def(
          "restart",
          [](BeliefPlanner& p, const BeliefArgument& belief) { p.restart(belief.belief()); },
          py::arg("belief"),
          "Begins anew at a belief that can follow from the model's initial one. Raises "
          "InvalidArgument.")
      .def("plan", &BeliefPlanner::plan, Released(), "The action here.")
      .def("advance", &BeliefPlanner::advance, py::arg("action"), py::arg("observation"),
           Released(),
           "Goes on to the next belief and gives the probability that the observation had. Raises "
           "FailedPrecondition when it was impossible, InvalidArgument.");
}

}  // namespace

void bindPlanning(py::module_& module)
{
  bindOptions(module);
  bindModelPlanner(module);
  bindBeliefPlanner(module);
  py::class_<GenerativePlanner>(
      module, "GenerativePlanner",
      "Plans one action at a time by sampling (DESPOT) on a model written in Python, and keeps the "
      "robot's belief as samples. The model is any object with the methods numActions(), "
      "discount(), step(state, action, random) -> (next_state, observation, reward, terminal), "
      "where the same random number in [0, 1) gives the same step, and upperBound(state), no less "
      "than what can be earned from there. It may have defaultAction(states), the action of a "
      "simple policy (else 0), observationProbability(action, next_state, observation), which "
      "makes beliefs better, and perturbed(state, random), a state near by for when an observation "
      "contradicts all samples. States and observations are any objects that can be hashed.")
      .def(py::init<py::object, const py::iterable&, const OnlineOptions&, const ParticleOptions&,
                    std::uint64_t>(),
           py::arg("model"), py::arg("states"), py::arg("options") = OnlineOptions(),
           py::arg("particles") = ParticleOptions(), py::arg("seed") = 1,
           "`states` are samples of the initial belief. Raises InvalidArgument: a method is "
           "missing, an option out of range, no states.")
      .def_property_readonly("states", &GenerativePlanner::states, "The samples of the belief.")
      .def("restart", &GenerativePlanner::restart, py::arg("states"),
           "Begins anew with these samples.")
      .def("plan", &GenerativePlanner::plan,
           "The action here. What the model's methods raise goes through; Ctrl-C ends it.")
      .def("advance", &GenerativePlanner::advance, py::arg("action"), py::arg("observation"),
           "Goes on to the belief after an action and an observation. Raises FailedPrecondition "
           "when no sample agrees with the observation.");
}

}  // namespace kr3::pomdp
