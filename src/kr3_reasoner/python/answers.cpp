#include <cstddef>
#include <optional>

#include "bindings.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

namespace
{

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
      .def_readonly("kind", &Assumption::kind, "what is assumed")
      .def_readonly("statement", &Assumption::statement, "'init(f(x) = v, false)', 'a(x) at 2'")
      .def_readonly("sentence", &Assumption::sentence, "in words")
      .def_readonly("price", &Assumption::price, "of a wrong record: 100 times its log-odds")
      .def_readonly("defaults", &Assumption::defaults,
                    "ground defaults to which this is an exception")
      .def_readonly("because", &Assumption::because,
                    "records (indices) that contradict the history without it")
      .def_readonly("because_in_words", &Assumption::because_in_words,
                    "empty when no proof was found within bounds")
      .def("__repr__", [](const Assumption& a) { return a.statement; });
  py::class_<ExplanationAlternative>(module, "ExplanationAlternative",
                                     "One minimal explanation of a history.")
      .def_readonly("assumptions", &ExplanationAlternative::assumptions, "its elements")
      .def_readonly("price", &ExplanationAlternative::price, "the sum over its elements")
      .def_readonly("in_words", &ExplanationAlternative::in_words, "for people");
  py::class_<ExplanationPart>(module, "ExplanationPart",
                              "What explains a part of what is unexpected; any of its explanations "
                              "goes with any of those of the other parts.")
      .def_readonly("price", &ExplanationPart::price, "of each of them")
      .def_readonly("explanations", &ExplanationPart::explanations, "lists of statements")
      .def_readonly("in_words", &ExplanationPart::in_words, "each for people")
      .def_readonly("complete", &ExplanationPart::complete, "whether there are no others");
  py::class_<Diagnosis>(module, "Diagnosis", "Minimal explanations of the history.")
      .def_readonly("consistent", &Diagnosis::consistent, "whether there is an explanation")
      .def_readonly("cost", &Diagnosis::cost, "minimal price")
      .def_readonly("explanations", &Diagnosis::explanations, "lists of statements")
      .def_readonly("in_words", &Diagnosis::in_words, "each explanation for people")
      .def_readonly("alternatives", &Diagnosis::alternatives, "the same, with prices and reasons")
      .def_readonly("complete", &Diagnosis::complete,
                    "whether explanations has all of them, not the first 200 of more")
      .def_readonly("parts", &Diagnosis::parts, "of which the explanations are put together")
      .def_readonly("conflict", &Diagnosis::conflict,
                    "when inconsistent: a minimal set of conflicting records")
      .def_readonly("conflict_records", &Diagnosis::conflict_records,
                    "the same, as indices into the history")
      .def_readonly("conflict_in_words", &Diagnosis::conflict_in_words,
                    "with files and lines where records have them");
  py::class_<Retraction>(module, "Retraction",
                         "Doubtful records that would have to be given up together.")
      .def_readonly("records", &Retraction::records, "indices into the history")
      .def_readonly("log_odds", &Retraction::log_odds,
                    "sum over the records; the smaller, the more doubtful")
      .def_readonly("opens", &Retraction::opens,
                    "the literal that becomes possible; empty: consistency")
      .def_readonly("in_words", &Retraction::in_words, "for people");
  py::class_<PrintedModel>(module, "HistoryModel",
                           "One model of a history: a path of states with an explanation.")
      .def_readonly("assumed", &PrintedModel::assumed, "as in Diagnosis.explanations")
      .def_readonly("states", &PrintedModel::states,
                    "at each step the value of every fluent, as a literal")
      .def_readonly("actions", &PrintedModel::actions, "what occurs at each step but the last")
      .def_readonly("first_step", &PrintedModel::first_step, "of states and actions");
  py::class_<Progress>(module, "Progress", "What became of a wish to progress a history.")
      .def_readonly("first_step", &Progress::first_step, "where the history begins now")
      .def_readonly("num_records", &Progress::num_records, "that are left")
      .def_readonly("kept_because", &Progress::kept_because,
                    "what could not be represented, in words");
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
      .def_readonly("kind", &Reason::kind, "how it is known")
      .def_readonly("statement", &Reason::statement,
                    "what is known: a ground literal or action; empty for a contradiction")
      .def_readonly("step", &Reason::step, "when it holds or happens")
      .def_property_readonly(
          "record",
          [](const Reason& reason) {
    return reason.record == kNoRecord ? std::nullopt : std::optional<std::size_t>(reason.record);
          },
          "index into the history, or None")
      .def_readonly("default_name", &Reason::default_name, "ground, as 'd(x)'")
      .def_readonly("position", &Reason::position, "of the law, the default or the record")
      .def_readonly("sentence", &Reason::sentence, "this node in words, without its children")
      .def_readonly("children", &Reason::children, "what this node rests on");
  py::enum_<LawKind>(module, "LawKind")
      .value("kCausal", LawKind::kCausal)
      .value("kConstraint", LawKind::kConstraint)
      .value("kDefinition", LawKind::kDefinition)
      .value("kExecutability", LawKind::kExecutability);
  py::class_<CitedLaw>(module, "CitedLaw", "A law of the description that an explanation rests on.")
      .def_readonly("kind", &CitedLaw::kind, "which law it is")
      .def_readonly("about", &CitedLaw::about,
                    "the action, or the fluent of the head; empty for 'false if ...'")
      .def_readonly("positions", &CitedLaw::positions, "of its rules: several for a definition");
  py::class_<Explanation>(module, "Explanation", "Why a literal is entailed.")
      .def_readonly("entailed", &Explanation::entailed, "whether the literal is entailed at all")
      .def_readonly("reasons", &Explanation::reasons, "in words, from the literal downwards")
      .def_readonly("records", &Explanation::records, "the records it rests on")
      .def_readonly("record_indices", &Explanation::record_indices,
                    "the same, as indices into the history")
      .def_readonly("defaults", &Explanation::defaults, "ground defaults it rests on, as 'd(x)'")
      .def_readonly("laws", &Explanation::laws, "it rests on")
      .def_readonly("proof", &Explanation::proof, "meaningful when entailed");
  py::class_<OpenQuestion>(module, "OpenQuestion",
                           "What is open about a literal, and what would settle it.")
      .def_readonly("open", &OpenQuestion::open, "whether it is possible and not entailed")
      .def_readonly("values", &OpenQuestion::values, "that its fluent may have at the step")
      .def_readonly("deciding", &OpenQuestion::deciding,
                    "fluents whose value at the current step would settle it")
      .def_readonly("reasons", &OpenQuestion::reasons, "in words, one sentence each");
}

}  // namespace

void bindAnswers(py::module_& module)
{
  bindDiagnosis(module);
  bindExplanation(module);
}

}  // namespace kr3::reasoner
