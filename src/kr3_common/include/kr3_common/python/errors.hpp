#pragma once

#include <exception>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "kr3_common/error.hpp"

namespace kr3
{

/// Gives a Python module the exception `Error` and a leaf of it for each code, and raises them for
/// what the library throws. Each module has its own, so that two modules in one program do not take
/// each other's.
///
/// The header is for Python modules alone: who includes it finds pybind11 himself.
inline void bindErrors(pybind11::module_& module)
{
  namespace py = pybind11;
  static std::map<ErrorCode, py::object> leaves;  // outlives every call: a module is never unloaded
  const std::string prefix = py::cast<std::string>(module.attr("__name__")) + ".";
  const auto make = [](const std::string& name, const char* documentation, PyObject* base) {
    return py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc(name.c_str(), documentation, base, nullptr));
  };
  const py::object base =
      make(prefix + "Error",
           "Base of everything that KR3's cores throw. `code` says what a caller can act on.",
           PyExc_RuntimeError);
  base.attr("code") = toString(ErrorCode::kInternal);
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
  for (const auto& [code, name] : codes)
  {
    const py::object leaf = make(prefix + name, "An Error with the code of its name.", base.ptr());
    leaf.attr("code") = toString(code);
    module.attr(name.c_str()) = leaf;
    leaves[code] = leaf;
  }
  py::register_local_exception_translator([](std::exception_ptr thrown) {
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
      PyErr_SetObject(leaves.at(e.code()).ptr(), text.ptr());
    }
  });
}

}  // namespace kr3
