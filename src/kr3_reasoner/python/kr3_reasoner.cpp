// The Python module kr3_reasoner: names are those of the C++ library. One translation unit, since
// pybind11 is costly to compile.

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/chrono.h>
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

namespace
{

using Texts = std::vector<std::string>;

Texts textsOf(const std::vector<Literal>& literals)
{
  Texts texts;
  for (const Literal& literal : literals)
  {
    texts.push_back(toString(literal));
  }
  return texts;
}

/// Set from any thread to end a call of `plan`.
class Cancellation
{
public:
  void cancel() { flag_ = true; }
  [[nodiscard]] bool cancelled() const { return flag_; }

private:
  std::atomic<bool> flag_{false};
};

/// A Reasoner that several Python threads may use: one question at a time, and the interpreter runs
/// on meanwhile.
class SharedReasoner
{
public:
  SharedReasoner(Description description, ReasonerOptions options)
    : reasoner_(std::move(description), std::move(options))
  {
  }

  SharedReasoner(Reasoner reasoner, std::shared_ptr<std::mutex> mutex)
    : mutex_(std::move(mutex)), reasoner_(std::move(reasoner))
  {
  }

  /// Asks a question without the interpreter's lock.
  template <typename Question>
  auto ask(Question question)
  {
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(*mutex_);
    return question(reasoner_);
  }

  /// One that answers what if; both share what was made of the description, and so the lock.
  std::unique_ptr<SharedReasoner> supposing(const std::vector<Record>& hypothetical)
  {
    return std::make_unique<SharedReasoner>(
        ask([&](Reasoner& reasoner) { return reasoner.supposing(hypothetical); }), mutex_);
  }

  /// Plans in a thread of its own, so that Ctrl-C ends it.
  PlanResult plan(const std::string& goal, const PlanOptions& options,
                  const std::shared_ptr<Cancellation>& cancellation)
  {
    constexpr std::chrono::milliseconds kPoll(20);
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(*mutex_);
    std::atomic<bool> cancel{false};
    std::future<PlanResult> result =
        std::async(std::launch::async, [&] { return reasoner_.plan(goal, options, &cancel); });
    bool interrupted = false;
    while (result.wait_for(kPoll) != std::future_status::ready)
    {
      cancel = cancel || (cancellation && cancellation->cancelled());
      if (!interrupted)
      {
        const py::gil_scoped_acquire acquire;
        interrupted = PyErr_CheckSignals() != 0;
        cancel = cancel || interrupted;
      }
    }
    if (interrupted)
    {
      const py::gil_scoped_acquire acquire;
      throw py::error_already_set();
    }
    return result.get();
  }

private:
  // with the reasoners that this one supposes
  std::shared_ptr<std::mutex> mutex_ = std::make_shared<std::mutex>();
  Reasoner reasoner_;
};

void bindErrors(py::module_& module)
{
  static py::object base;  // outlives every call: a module is never unloaded
  static std::vector<py::object> leaves;
  base = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "kr3_reasoner.Error",
      "Base of everything that KR3's cores throw. `code` says what a caller can act on.",
      PyExc_RuntimeError, nullptr));
  base.attr("code") = "INTERNAL";
  module.attr("Error") = base;
  const std::vector<std::pair<ErrorCode, std::string>> codes = {
      {ErrorCode::kInvalidArgument, "InvalidArgument"},
      {ErrorCode::kNotFound, "NotFound"},
      {ErrorCode::kFailedPrecondition, "FailedPrecondition"},
      {ErrorCode::kUnavailable, "Unavailable"},
      {ErrorCode::kResourceExhausted, "ResourceExhausted"},
      {ErrorCode::kDeadlineExceeded, "DeadlineExceeded"},
      {ErrorCode::kCancelled, "Cancelled"},
      {ErrorCode::kInternal, "InternalError"},
  };
  leaves.resize(codes.size() + 1);
  for (const auto& [code, name] : codes)
  {
    py::object& leaf = leaves.at(static_cast<std::size_t>(code));
    leaf = py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc(("kr3_reasoner." + name).c_str(),
                                  "An Error with the code of its name.", base.ptr(), nullptr));
    leaf.attr("code") = toString(code);
    module.attr(name.c_str()) = leaf;
  }
  py::register_exception_translator([](std::exception_ptr thrown) {
    try
    {
      std::rethrow_exception(std::move(thrown));
    }
    catch (const Error& e)
    {
      // what a file holds need not be UTF-8
      const auto text = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
          e.what(), static_cast<Py_ssize_t>(std::string(e.what()).size()), "backslashreplace"));
      PyErr_SetObject(leaves.at(static_cast<std::size_t>(e.code())).ptr(), text.ptr());
    }
  });
}

void bindDescription(py::module_& module)
{
  py::class_<SourcePosition>(module, "SourcePosition",
                             "Where something stands in a file; line and column count from 1.")
      .def_readonly("file", &SourcePosition::file)
      .def_readonly("line", &SourcePosition::line)
      .def_readonly("column", &SourcePosition::column);
  py::class_<Description>(module, "Description",
                          "A domain description that passed every check of the language. str() "
                          "gives it in the language.")
      .def("__str__", [](const Description& d) { return toString(d); })
      .def_property_readonly(
          "sorts",
          [](const Description& d) {
    py::dict sorts;
    for (const Sort& sort : d.sorts)
    {
      sorts[py::str(sort.name)] = sort.elements;
    }
    return sorts;
          },
          "The elements of each sort.")
      .def_property_readonly(
          "fluents",
          [](const Description& d) {
    Texts names;
    for (const FluentDeclaration& fluent : d.fluents)
    {
      names.push_back(fluent.name);
    }
    return names;
          },
          "Names of the fluents, statics included.")
      .def_property_readonly(
          "actions",
          [](const Description& d) {
    Texts names;
    for (const ActionDeclaration& action : d.actions)
    {
      names.push_back(action.name);
    }
    return names;
          },
          "Names of the actions, exogenous ones included.");
  module.def("parseDescription",
             py::overload_cast<const std::string&, const std::string&>(&parseDescription),
             py::arg("text"), py::arg("file"),
             "Parses and checks a description; `file` is its name in messages. Raises "
             "InvalidArgument with a line 'file:line:column: message' for each problem.");
  module.def("readDescription", py::overload_cast<const std::string&>(&readDescription),
             py::arg("path"), "Reads and parses a file. Raises NotFound or InvalidArgument.");
  module.def("readDescription",
             py::overload_cast<const std::vector<std::string>&>(&readDescription), py::arg("paths"),
             "Reads one description from several files.");
}

void bindRecords(py::module_& module)
{
  py::enum_<RecordKind>(module, "RecordKind")
      .value("kObserved", RecordKind::kObserved, "obs(literal, value, step)")
      .value("kHappened", RecordKind::kHappened, "hpd(action, step)")
      .value("kAttempted", RecordKind::kAttempted, "attempt(action, step)")
      .value("kInitially", RecordKind::kInitially, "init(literal, value)");
  py::class_<Record>(module, "Record", "One record of a history (Zhang et al. 2014).")
      .def(py::init([](RecordKind kind, std::string statement, bool value, int step,
                       double confidence, std::string source) {
             return Record{kind, std::move(statement), value, step, confidence, std::move(source)};
           }),
           py::arg("kind"), py::arg("statement"), py::arg("value") = true, py::arg("step") = 0,
           py::arg("confidence") = 1.0, py::arg("source") = "robot")
      .def_readwrite("kind", &Record::kind)
      .def_readwrite("statement", &Record::statement, "ground literal or ground action")
      .def_readwrite("value", &Record::value)
      .def_readwrite("step", &Record::step)
      .def_readwrite("confidence", &Record::confidence, "probability that it is right, (0, 1]")
      .def_readwrite("source", &Record::source)
      .def_readonly("position", &Record::position, "in a history file; line 0 if in none")
      .def("__repr__", [](const Record& record) { return toString(record); });
  module.def(
      "parseHistory", &parseHistory, py::arg("text"), py::arg("file"), py::arg("description"),
      "Parses a history: obs(l, bool, step). hpd(a, step). attempt(a, step). init(l, bool).");
  module.def("readHistory", &readHistory, py::arg("path"), py::arg("description"),
             "Reads and parses a history file. Raises NotFound or InvalidArgument.");
}

void bindDiagnosis(py::module_& module)
{
  py::enum_<Answer>(module, "Answer")
      .value("kFalse", Answer::kFalse)
      .value("kTrue", Answer::kTrue)
      .value("kUnknown", Answer::kUnknown);
  py::enum_<AssumptionKind>(module, "AssumptionKind")
      .value("kException", AssumptionKind::kException, "to a default")
      .value("kExogenous", AssumptionKind::kExogenous, "an exogenous action")
      .value("kFailure", AssumptionKind::kFailure, "of an attempt")
      .value("kWrongRecord", AssumptionKind::kWrongRecord, "a sensing error");
  py::class_<Assumption>(module, "Assumption", "One element of a minimal explanation.")
      .def_readonly("kind", &Assumption::kind)
      .def_readonly("statement", &Assumption::statement)
      .def_readonly("sentence", &Assumption::sentence, "in words")
      .def_readonly("price", &Assumption::price)
      .def_readonly("defaults", &Assumption::defaults)
      .def_readonly("because", &Assumption::because,
                    "records (indices) that contradict the history without it")
      .def_readonly("because_in_words", &Assumption::because_in_words)
      .def("__repr__", [](const Assumption& a) { return a.statement; });
  py::class_<ExplanationAlternative>(module, "ExplanationAlternative",
                                     "One minimal explanation of a history.")
      .def_readonly("assumptions", &ExplanationAlternative::assumptions)
      .def_readonly("price", &ExplanationAlternative::price)
      .def_readonly("in_words", &ExplanationAlternative::in_words);
  py::class_<Diagnosis>(module, "Diagnosis", "Minimal explanations of the history.")
      .def_readonly("consistent", &Diagnosis::consistent)
      .def_readonly("cost", &Diagnosis::cost, "minimal price")
      .def_readonly("explanations", &Diagnosis::explanations, "lists of statements")
      .def_readonly("in_words", &Diagnosis::in_words, "each explanation for people")
      .def_readonly("alternatives", &Diagnosis::alternatives, "the same, with prices and reasons")
      .def_readonly("conflict", &Diagnosis::conflict,
                    "when inconsistent: a minimal set of conflicting records")
      .def_readonly("conflict_records", &Diagnosis::conflict_records, "the same, as indices");
  py::class_<Retraction>(module, "Retraction",
                         "Doubtful records that would have to be given up together.")
      .def_readonly("records", &Retraction::records)
      .def_readonly("log_odds", &Retraction::log_odds)
      .def_readonly("opens", &Retraction::opens)
      .def_readonly("in_words", &Retraction::in_words);
  py::class_<HistoryModel>(module, "HistoryModel",
                           "One model of a history: a path of states with an explanation.")
      .def_readonly("assumed", &HistoryModel::assumed)
      .def_property_readonly(
          "states",
          [](const HistoryModel& model) {
    std::vector<Texts> states;
    for (const std::vector<Literal>& state : model.states)
    {
      states.push_back(textsOf(state));
    }
    return states;
          },
          "at each step the value of every fluent, as a literal")
      .def_readonly("actions", &HistoryModel::actions, "what occurs at each step but the last");
}

void bindExplanation(py::module_& module)
{
  py::enum_<ReasonKind>(module, "ReasonKind")
      .value("kObserved", ReasonKind::kObserved)
      .value("kHappened", ReasonKind::kHappened)
      .value("kCaused", ReasonKind::kCaused)
      .value("kInertia", ReasonKind::kInertia)
      .value("kConstraint", ReasonKind::kConstraint)
      .value("kDefinition", ReasonKind::kDefinition)
      .value("kExecutability", ReasonKind::kExecutability)
      .value("kOnlyValue", ReasonKind::kOnlyValue)
      .value("kStatic", ReasonKind::kStatic)
      .value("kDefault", ReasonKind::kDefault)
      .value("kException", ReasonKind::kException)
      .value("kAssumed", ReasonKind::kAssumed)
      .value("kChange", ReasonKind::kChange)
      .value("kContradiction", ReasonKind::kContradiction)
      .value("kSupposed", ReasonKind::kSupposed)
      .value("kCases", ReasonKind::kCases)
      .value("kTogether", ReasonKind::kTogether)
      .value("kAgain", ReasonKind::kAgain)
      .value("kCarried", ReasonKind::kCarried);
  py::class_<Reason>(module, "Reason", "A node of a proof. Its children are what it rests on.")
      .def_readonly("kind", &Reason::kind)
      .def_readonly("statement", &Reason::statement)
      .def_readonly("step", &Reason::step)
      .def_property_readonly(
          "record",
          [](const Reason& reason) -> py::object {
            return reason.record == kNoRecord ? py::object(py::none())
                                              : py::object(py::int_(reason.record));
          },
          "index into the history, or None")
      .def_readonly("default_name", &Reason::default_name)
      .def_readonly("position", &Reason::position)
      .def_readonly("sentence", &Reason::sentence, "this node in words, without its children")
      .def_readonly("children", &Reason::children);
  py::class_<Explanation>(module, "Explanation", "Why a literal is entailed.")
      .def_readonly("entailed", &Explanation::entailed)
      .def_readonly("reasons", &Explanation::reasons, "in words, from the literal downwards")
      .def_readonly("records", &Explanation::records)
      .def_readonly("record_indices", &Explanation::record_indices)
      .def_readonly("defaults", &Explanation::defaults)
      .def_readonly("proof", &Explanation::proof, "meaningful when entailed");
}

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
      .def_readwrite("preference", &PlanOptions::preference)
      .def_readwrite("all", &PlanOptions::all, "all plans that are equally good")
      .def_readwrite("max_plans", &PlanOptions::max_plans)
      .def_readwrite("relevant_only", &PlanOptions::relevant_only)
      .def_readwrite("extra_share", &PlanOptions::extra_share);
  py::class_<ProblemSize>(module, "ProblemSize", "The size of a description with its history.")
      .def_readonly("fluents", &ProblemSize::fluents)
      .def_readonly("constants", &ProblemSize::constants)
      .def_readonly("actions", &ProblemSize::actions)
      .def_readonly("records", &ProblemSize::records);
  py::class_<Plan>(module, "Plan", "A plan under a hypothesis.")
      .def_readonly("hypothesis", &Plan::hypothesis, "literals; empty when nothing is assumed")
      .def_readonly("steps", &Plan::steps, "ground actions that occur together, a list a step")
      .def_readonly("cost", &Plan::cost);
  py::class_<PlanResult>(module, "PlanResult", "Plans, or why there is none.")
      .def_readonly("goal_entailed", &PlanResult::goal_entailed, "nothing to do")
      .def_readonly("plans", &PlanResult::plans, "one a hypothesis, more with `all`")
      .def_readonly("complete", &PlanResult::complete)
      .def_readonly("reason", &PlanResult::reason, "when there is no plan: why")
      .def_readonly("cpu_s", &PlanResult::cpu_s)
      .def_readonly("considered", &PlanResult::considered)
      .def_readonly("whole", &PlanResult::whole)
      .def_readonly("widened", &PlanResult::widened);
  py::class_<RelevantItem>(module, "RelevantItem",
                           "A constant, fluent or action that can matter to a goal, and why.")
      .def_readonly("name", &RelevantItem::name)
      .def_readonly("why", &RelevantItem::why, "from the goal to the item, a sentence a step");
  py::class_<RelevantPart>(module, "RelevantPart", "What can matter to a goal.")
      .def_readonly("constants", &RelevantPart::constants)
      .def_readonly("fluents", &RelevantPart::fluents)
      .def_readonly("actions", &RelevantPart::actions)
      .def_readonly("records", &RelevantPart::records)
      .def_readonly("considered", &RelevantPart::considered)
      .def_readonly("whole", &RelevantPart::whole);
  py::class_<Cancellation, std::shared_ptr<Cancellation>>(
      module, "Cancellation", "Ends a call of plan from another thread: it raises Cancelled.")
      .def(py::init<>())
      .def("cancel", &Cancellation::cancel)
      .def("cancelled", &Cancellation::cancelled);
}

void bindReasoner(py::module_& module)
{
  py::class_<ReasonerOptions>(module, "ReasonerOptions",
                              "What a diagnosis may assume, and at what price.")
      .def(py::init([](bool exogenous, int exception_weight, int exogenous_weight,
                       std::map<std::string, int> default_weights) {
             ReasonerOptions options;
             options.diagnose_exogenous = exogenous;
             options.exception_weight = exception_weight;
             options.exogenous_weight = exogenous_weight;
             options.default_weights = std::move(default_weights);
             return options;
           }),
           py::kw_only(), py::arg("diagnose_exogenous") = false, py::arg("exception_weight") = 1,
           py::arg("exogenous_weight") = 1,
           py::arg("default_weights") = std::map<std::string, int>())
      .def_readwrite("diagnose_exogenous", &ReasonerOptions::diagnose_exogenous)
      .def_readwrite("exception_weight", &ReasonerOptions::exception_weight)
      .def_readwrite("exogenous_weight", &ReasonerOptions::exogenous_weight)
      .def_readwrite("default_weights", &ReasonerOptions::default_weights);

  using R = SharedReasoner;
  py::class_<R>(module, "Reasoner",
                "The high-level reasoner: a description, a growing history, and questions about "
                "them, answered by clingo. Threads may share one; their questions wait for each "
                "other, and the interpreter runs on meanwhile.")
      .def(py::init<Description, ReasonerOptions>(), py::arg("description"),
           py::arg("options") = ReasonerOptions())
      .def_property_readonly(
          "description", [](R& r) { return r.ask([](Reasoner& q) { return q.description(); }); })
      .def("history", [](R& r) { return r.ask([](Reasoner& q) { return q.history(); }); })
      .def("currentStep", [](R& r) { return r.ask([](Reasoner& q) { return q.currentStep(); }); })
      .def(
          "setHistory",
          [](R& r, std::vector<Record> records) {
    r.ask([&](Reasoner& q) { q.setHistory(std::move(records)); });
          },
          py::arg("records"), "Replaces the history; all records are taken or none.")
      .def(
          "addRecords",
          [](R& r, const std::vector<Record>& records) {
    r.ask([&](Reasoner& q) { q.addRecords(records); });
          },
          py::arg("records"), "Extends the history; all records are taken or none.")
      .def("diagnose", [](R& r) { return r.ask([](Reasoner& q) { return q.diagnose(); }); })
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
    return r.ask([&](Reasoner& q) { return q.models(limit); });
          },
          py::arg("limit") = 1000, "The models of the history, each once; limit 0 for all.")
      .def(
          "entailedAt",
          [](R& r, int step) {
    return r.ask([&](Reasoner& q) { return textsOf(q.entailedAt(step)); });
          },
          py::arg("step"), "All literals that are entailed at a step.")
      .def(
          "possibleValues",
          [](R& r, const std::string& fluent, int step) {
    return r.ask([&](Reasoner& q) { return q.possibleValues(fluent, step); });
          },
          py::arg("fluent"), py::arg("step"), "The values that a fluent takes in some model.")
      .def(
          "explain",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.explain(literal, step); });
          },
          py::arg("literal"), py::arg("step"), "Why is the literal entailed?")
      .def(
          "supposing",
          [](R& r, const std::vector<Record>& hypothetical) { return r.supposing(hypothetical); },
          py::arg("hypothetical"),
          "What if these records were in the history as well? A reasoner that answers; this one "
          "does not change.")
      .def("retractions", [](R& r) { return r.ask([](Reasoner& q) { return q.retractions(); }); })
      .def(
          "retractionsFor",
          [](R& r, const std::string& literal, int step) {
    return r.ask([&](Reasoner& q) { return q.retractionsFor(literal, step); });
          },
          py::arg("literal"), py::arg("step"))
      .def(
          "leastCertainRefutation",
          [](R& r, const std::string& fluent) {
    return r.ask([&](Reasoner& q) { return q.leastCertainRefutation(fluent); });
          },
          py::arg("fluent"))
      .def("plan", &R::plan, py::arg("goal"), py::arg("options") = PlanOptions(),
           py::arg("cancel") = std::shared_ptr<Cancellation>(),
           "Plans from the current step, one for each hypothesis. Ctrl-C and `cancel` end it. "
           "Raises InvalidArgument, DeadlineExceeded or Cancelled.")
      .def(
          "translation", [](R& r) { return r.ask([](Reasoner& q) { return q.translation(); }); },
          "The answer set program of the history, for plain clingo.")
      .def(
          "relevant",
          [](R& r, const std::string& goal) {
    return r.ask([&](Reasoner& q) { return q.relevant(goal); });
          },
          py::arg("goal"), "What can matter to a goal, and why.")
      .def(
          "translation",
          [](R& r, const std::string& goal, int length) {
    return r.ask([&](Reasoner& q) { return q.translation(goal, length); });
          },
          py::arg("goal"), py::arg("length"),
          "The same with a goal: the trajectories on which a plan of this length reaches it.");
}

}  // namespace

}  // namespace kr3::reasoner

PYBIND11_MODULE(kr3_reasoner, module)
{
  module.doc() =
      "High-level reasoning of KR3: an action language, histories with defaults, entailment, "
      "diagnosis and planning. Names are those of the C++ library; statements are texts in the "
      "language.";
  kr3::reasoner::bindErrors(module);
  kr3::reasoner::bindDescription(module);
  kr3::reasoner::bindRecords(module);
  kr3::reasoner::bindDiagnosis(module);
  kr3::reasoner::bindExplanation(module);
  kr3::reasoner::bindPlans(module);
  kr3::reasoner::bindReasoner(module);
}
