#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/describe/field.hpp"

/// What the parts of the Python module have in common. They add no logic to the library: they
/// convert between Python's values and the library's, and let other Python threads run while the
/// library works. None stands for what was not asked for and an empty array for what was not found,
/// so that an absent clearance never looks like a free way. What NumPy would convert in silence is
/// refused where it hides a mistake.
namespace clearway::python {

namespace py = pybind11;

/// A text of the library as a str. The text may contain the name of a file in any encoding.
py::str text(std::string_view bytes);

/// A path from str, bytes or os.PathLike, as Python's own open() takes it.
std::filesystem::path path_of(const py::handle& object);

/// The path as a pathlib.Path.
py::object to_python(const std::filesystem::path& path);

/// The paths from one path or from several of them.
std::vector<std::filesystem::path> paths_of(const py::handle& object);

/// Runs `call`, which must not touch Python, while other Python threads may run too.
template <typename Call>
auto without_gil(Call call) {
  // pybind11's guard is not used: while Python is ending, taking the GIL unwinds this thread, which
  // no destructor may do.
  PyThreadState* const state = PyEval_SaveThread();
  std::optional<std::invoke_result_t<Call>> result;
  std::exception_ptr thrown;
  try {
    result.emplace(call());
  } catch (...) {
    thrown = std::current_exception();
  }
  PyEval_RestoreThread(state);
  if (thrown) std::rethrow_exception(thrown);
  return std::move(*result);
}

/// The value with a name in a table of choices. Throws UsageError where the table does not contain
/// the name.
template <typename Table>
auto value_of(const char* what, const Table& table, const std::string& name) {
  std::string known;
  for (const auto& [other, value] : table) {
    if (name == other) return value;
    known += (known.empty() ? "" : ", ") + std::string(other);
  }
  throw UsageError(std::string(what) + " '" + name + "': expected one of " + known);
}

template <typename Table, typename Value>
const char* name_in(const Table& table, Value value) {
  for (const auto& [name, other] : table) {
    if (other == value) return name;
  }
  return "unknown";
}

void add_watch();                        // watch.cpp
void add_errors(py::module_& module);    // errors.cpp
void add_values(py::module_& module);    // values.cpp
void add_model(py::module_& module);     // model.cpp
void add_store(py::module_& module);     // search.cpp
void add_inputs(py::module_& module);    // inputs.cpp
void add_bodies(py::module_& module);    // bodies.cpp
void add_search(py::module_& module);    // search.cpp
void add_results(py::module_& module);   // results.cpp, after what its answers have
void add_findings(py::module_& module);  // findings.cpp
void add_section(py::module_& module);   // section.cpp

}  // namespace clearway::python
