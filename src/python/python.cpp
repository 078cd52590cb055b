#include "python/python.hpp"

namespace clearway::python {

py::str text(std::string_view bytes) {
  PyObject* decoded =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

std::filesystem::path path_of(const py::handle& object) {
  PyObject* encoded = nullptr;
  if (PyUnicode_FSConverter(object.ptr(), &encoded) == 0) throw py::error_already_set();
  const auto bytes = py::reinterpret_steal<py::bytes>(encoded);
  return std::string(bytes);
}

py::object to_python(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  const auto name = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<Py_ssize_t>(bytes.size())));
  if (!name) throw py::error_already_set();
  return py::module_::import("pathlib").attr("Path")(name);
}

std::vector<std::filesystem::path> paths_of(const py::handle& object) {
  if (py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) ||
      py::hasattr(object, "__fspath__")) {
    return {path_of(object)};
  }
  std::vector<std::filesystem::path> paths;
  for (const py::handle path : py::iter(object)) paths.push_back(path_of(path));
  return paths;
}

}  // namespace clearway::python
