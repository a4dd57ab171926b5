#include <exception>
#include <string_view>
#include <utility>

#include <kr3_common/error.hpp>

#include "bindings.hpp"

namespace py = pybind11;

namespace kr3::reasoner
{

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
      const std::string_view message = e.what();
      const auto text = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
          message.data(), static_cast<Py_ssize_t>(message.size()), "backslashreplace"));
      PyErr_SetObject(leaves.at(static_cast<std::size_t>(e.code())).ptr(), text.ptr());
    }
  });
}

}  // namespace kr3::reasoner
