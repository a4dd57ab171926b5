#include <utility>

#include "bindings.hpp"
#include "kr3_reasoner/sparc.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

namespace
{

using Texts = std::vector<std::string>;

void bindDescription(py::module_& module)
{
  py::class_<SourcePosition>(module, "SourcePosition",
                             "Where something stands in a file; line and column count from 1.")
      .def_readonly("file", &SourcePosition::file, "its name as it was given")
      .def_readonly("line", &SourcePosition::line, "0: in no file")
      .def_readonly("column", &SourcePosition::column, "in bytes");
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
             "Reads one description from several files. Raises NotFound or InvalidArgument.");
  module.def("parseRefinement", &parseRefinement, py::arg("text"), py::arg("file"), py::arg("base"),
             "Parses a refinement of the description `base`. Raises InvalidArgument.");
  module.def("readRefinement", &readRefinement, py::arg("path"), py::arg("base"),
             "Reads and parses a refinement of the description `base`. Raises NotFound or "
             "InvalidArgument.");
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
      .def_readwrite("kind", &Record::kind, "what the record says")
      .def_readwrite("statement", &Record::statement, "ground literal or ground action")
      .def_readwrite("value", &Record::value, "of kObserved and kInitially: true or false")
      .def_readwrite("step", &Record::step, "0 or more; of kInitially 0")
      .def_readwrite("confidence", &Record::confidence, "probability that it is right, (0, 1]")
      .def_readwrite("source", &Record::source, "who says so")
      .def_readonly("position", &Record::position, "in a history file; line 0 if in none")
      .def("__repr__", [](const Record& record) { return toString(record); });
  module.def(
      "parseHistory", &parseHistory, py::arg("text"), py::arg("file"), py::arg("description"),
      "Parses a history: obs(l, bool, step). hpd(a, step). attempt(a, step). init(l, bool).");
  module.def("readHistory", &readHistory, py::arg("path"), py::arg("description"),
             "Reads and parses a history file. Raises NotFound or InvalidArgument.");
}

void bindImport(py::module_& module)
{
  py::class_<SparcImport>(module, "SparcImport", "What a SPARC program says, in KR3's language.")
      .def_readonly("description", &SparcImport::description, "of the domain")
      .def_readonly("history", &SparcImport::history, "what the program states about its steps")
      .def_readonly("goals", &SparcImport::goals, "one for each rule goal(I) :- ...");
  module.def("importSparc", &importSparc, py::arg("text"), py::arg("file"),
             "Translates a SPARC program of the common subset; `file` is its name in messages. "
             "Raises InvalidArgument with the place of every statement that is not in the subset.");
  module.def("readSparc", &readSparc, py::arg("path"),
             "Reads and translates a SPARC program. Raises NotFound or InvalidArgument.");
}

}  // namespace

void bindLanguage(py::module_& module)
{
  bindDescription(module);
  bindRecords(module);
  bindImport(module);
}

}  // namespace kr3::reasoner
