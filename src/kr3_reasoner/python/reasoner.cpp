#include <chrono>
#include <map>
#include <memory>
#include <utility>

#include "shared_reasoner.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

namespace
{

using R = SharedReasoner;
using ReasonerClass = py::class_<R>;

std::vector<std::string> textsOf(const std::vector<Literal>& literals,
                                 const Description& description)
{
  std::vector<std::string> texts;
  texts.reserve(literals.size());
  for (const Literal& literal : literals)
  {
    texts.push_back(toString(literal, description));
  }
  return texts;
}

std::vector<PrintedModel> printed(std::vector<HistoryModel> models, const Description& description)
{
  std::vector<PrintedModel> texts;
  texts.reserve(models.size());
  for (HistoryModel& model : models)
  {
    PrintedModel& text = texts.emplace_back();
    text.assumed = std::move(model.assumed);
    text.actions = std::move(model.actions);
    text.first_step = model.first_step;
    for (const std::vector<Literal>& state : model.states)
    {
      text.states.push_back(textsOf(state, description));
    }
  }
  return texts;
}

void bindOptions(py::module_& module)
{
  py::class_<ReasonerOptions>(module, "ReasonerOptions",
                              "What a diagnosis may assume, and at what price.")
      .def(py::init([](bool exogenous, int exception_weight, int exogenous_weight,
                       std::map<std::string, int> default_weights, int least_step, int window,
                       int max_combinations) {
             ReasonerOptions options;
             options.window = window;
             options.max_combinations = max_combinations;
             options.diagnose_exogenous = exogenous;
             options.exception_weight = exception_weight;
             options.exogenous_weight = exogenous_weight;
             options.default_weights = std::move(default_weights);
             options.least_step = least_step;
             return options;
           }),
           py::kw_only(), py::arg("diagnose_exogenous") = false, py::arg("exception_weight") = 1,
           py::arg("exogenous_weight") = 1,
           py::arg("default_weights") = std::map<std::string, int>(), py::arg("least_step") = 0,
           py::arg("window") = 0, py::arg("max_combinations") = 1000)
      .def_readwrite("diagnose_exogenous", &ReasonerOptions::diagnose_exogenous,
                     "whether exogenous actions compete with exceptions from the start; otherwise "
                     "they are assumed only if no exception explains the history")
      .def_readwrite("exception_weight", &ReasonerOptions::exception_weight,
                     "price of one exception to a default, at least 1")
      .def_readwrite("exogenous_weight", &ReasonerOptions::exogenous_weight,
                     "price of one exogenous action, and of one failed attempt, at least 1")
      .def_readwrite("default_weights", &ReasonerOptions::default_weights,
                     "price of an exception to the named default, where it differs")
      .def_readwrite("least_step", &ReasonerOptions::least_step,
                     "the current step is at least this, even if no record is about it")
      .def_readwrite("window", &ReasonerOptions::window,
                     "about how many steps the history keeps; 0: all of them")
      .def_readwrite("max_combinations", &ReasonerOptions::max_combinations,
                     "of values that are kept when the history is progressed");
  py::class_<Cancellation, std::shared_ptr<Cancellation>>(
      module, "Cancellation", "Ends a call of plan from another thread: it raises Cancelled.")
      .def(py::init<>())
      .def("cancel", &Cancellation::cancel, "May be called from any thread.")
      .def("cancelled", &Cancellation::cancelled, "Whether cancel was called.");
}

void bindHistory(ReasonerClass& reasoner)
{
  reasoner
      .def_property_readonly(
          "description", [](R& r) { return r.look([](Reasoner& q) { return q.description(); }); },
          "The description that it reasons about.")
      .def(
          "history", [](R& r) { return r.look([](Reasoner& q) { return q.history(); }); },
          "The records.")
      .def(
          "currentStep", [](R& r) { return r.look([](Reasoner& q) { return q.currentStep(); }); },
          "The largest step among the records, or one more when an action is recorded there.")
      .def(
          "setHistory",
          [](R& r, std::vector<Record> records) {
    r.ask([&](Reasoner& q) { q.setHistory(std::move(records)); });
          },
          py::arg("records"),
          "Replaces the history; all records are taken or none. Raises InvalidArgument.")
      .def(
          "addRecords",
          [](R& r, const std::vector<Record>& records) {
    r.ask([&](Reasoner& q) { q.addRecords(records); });
          },
          py::arg("records"),
          "Extends the history; all records are taken or none. Raises InvalidArgument.")
      .def(
          "firstStep", [](R& r) { return r.look([](Reasoner& q) { return q.firstStep(); }); },
          "The step at which the history begins: 0 until it is progressed.")
      .def(
          "progress",
          [](R& r, int step) { return r.ask([&](Reasoner& q) { return q.progress(step); }); },
          py::arg("step"),
          "Lets the history begin at a later step. What earlier records say about it is kept; all "
          "answers about later steps stay the same. Raises InvalidArgument, FailedPrecondition.")
      .def(
          "setLimits", [](R& r, std::chrono::milliseconds time_limit) { r.limitTime(time_limit); },
          py::arg("time_limit"),
          "Wall time of each question that follows, 0 for none; one that takes longer raises "
          "DeadlineExceeded.");
}

void bindEntailment(ReasonerClass& reasoner)
{
  reasoner
      .def(
          "entails",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.entails(literal, step); });
          },
          py::arg("literal"), py::arg("step"),
          "Is the literal true in all models with a minimal explanation? Raises "
          "FailedPrecondition when the history is inconsistent.")
      .def(
          "possible",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.possible(literal, step); });
          },
          py::arg("literal"), py::arg("step"), "Is the literal true in some such model?")
      .def(
          "models",
          [](R& r, std::size_t limit) {
    return r.ask([&](Reasoner& q) { return printed(q.models(limit), q.description()); });
          },
          py::arg("limit") = 1000, "The models of the history, each once; limit 0 for all.")
      .def(
          "entailedAt",
          [](R& r, int step) {
    return r.ask([&](Reasoner& q) { return textsOf(q.entailedAt(step), q.description()); });
          },
          py::arg("step"),
          "All literals f = v (and f != v where no value of f is entailed) that are entailed at a "
          "step.")
      .def(
          "possibleValues",
          [](R& r, const std::string& fluent, int step) {
    return r.ask([&](Reasoner& q) { return q.possibleValues(fluent, step); });
          },
          py::arg("fluent"), py::arg("step"),
          "The values that a ground fluent takes at a step in some model, in the order of its "
          "sort.");
}

void bindWhy(ReasonerClass& reasoner)
{
  reasoner
      .def(
          "diagnose", [](R& r) { return r.ask([](Reasoner& q) { return q.diagnose(); }); },
          "The minimal explanations of the history, or a minimal set of conflicting records.")
      .def(
          "explain",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.explain(literal, step); });
          },
          py::arg("literal"), py::arg("step"),
          "Why is the literal entailed? A proof, minimal and sufficient.")
      .def(
          "whyUnknown",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.whyUnknown(literal, step); });
          },
          py::arg("literal"), py::arg("step"),
          "Why is the literal not known, and would observing its fluent now settle it?")
      .def(
          "supposing",
          [](R& r, const std::vector<Record>& hypothetical) { return r.supposing(hypothetical); },
          py::arg("hypothetical"),
          "What if these records were in the history as well? A reasoner that answers; this one "
          "does not change. Raises InvalidArgument.")
      .def(
          "retractions", [](R& r) { return r.ask([](Reasoner& q) { return q.retractions(); }); },
          "Which doubtful records (confidence below 1) would have to be given up so that the "
          "history is consistent; most doubtful first, at most eight sets.")
      .def(
          "retractionsFor",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.retractionsFor(literal, step); });
          },
          py::arg("literal"), py::arg("step"), "The same, so that a literal is possible at a step.")
      .def(
          "leastCertainRefutation",
          [](R& r, const std::string& fluent) {
    return r.ask([&](Reasoner& q) { return q.leastCertainRefutation(fluent); });
          },
          py::arg("fluent"),
          "The least certain refutation of a value of a ground fluent at the current step.");
}

void bindPlanning(ReasonerClass& reasoner)
{
  reasoner
      .def(
          "plan",
          [](R& r, const std::string& goal, const PlanOptions& options,
             const std::shared_ptr<Cancellation>& cancel) {
    return r.ask([&](Reasoner& q) { return q.plan(goal, options); }, cancel);
          },
          py::arg("goal"), py::arg("options") = PlanOptions(),
          py::arg("cancel") = std::shared_ptr<Cancellation>(),
          "Plans from the current step, one for each hypothesis. Ctrl-C and `cancel` end it. "
          "Raises InvalidArgument, DeadlineExceeded or Cancelled.")
      .def(
          "relevant",
          [](R& r, const std::string& goal) {
    return r.ask([&](Reasoner& q) { return q.relevant(goal); });
          },
          py::arg("goal"), "What can matter to a goal, and why.")
      .def(
          "translation", [](R& r) { return r.ask([](Reasoner& q) { return q.translation(); }); },
          "The answer set program of the history, for plain clingo.")
      .def(
          "translation",
          [](R& r, const std::string& goal, int length) {
    return r.ask([&](Reasoner& q) { return q.translation(goal, length); });
          },
          py::arg("goal"), py::arg("length"),
          "The same with a goal: the trajectories on which a plan of this length reaches it.");
}

}  // namespace

void bindReasoner(py::module_& module)
{
  bindOptions(module);
  ReasonerClass reasoner(module, "Reasoner",
                         "The high-level reasoner: a description, a growing history, and questions "
                         "about them, answered by clingo. Threads may share one; their questions "
                         "wait for each other, the interpreter runs on meanwhile, and Ctrl-C ends "
                         "a question.");
  reasoner.def(py::init<Description, ReasonerOptions>(), py::arg("description"),
               py::arg("options") = ReasonerOptions());
  bindHistory(reasoner);
  bindEntailment(reasoner);
  bindWhy(reasoner);
  bindPlanning(reasoner);
}

}  // namespace kr3::reasoner
