#include <exception>
#include <string>
#include <string_view>

#include "core/messages/remedies.hpp"
#include "python/python.hpp"

namespace clearway::python {
namespace {

template <typename Kind>
bool is_a(const Error* error) {
  return dynamic_cast<const Kind*>(error) != nullptr;
}

/// An exception class, which lives as long as the process.
struct ErrorClass {
  const char* name;
  const char* doc;
  bool (*holds)(const Error*);  ///< whether an error of the library is one
  PyObject* made = nullptr;
};

/// The class of all errors, and then those that are derived from it.
ErrorClass error_classes[] = {
    {"Error",
     "Raised where a call cannot be done. The text says what happened and where.\n\n"
     "remedy: what would help, such as 'overwrite' or 'more_memory'; None where nothing is "
     "known.\n"
     "amount: the number of the remedy, such as the bytes that are enough; 0 where it has none.",
     is_a<Error>},
    {"UsageError",
     "Raised for arguments that contradict each other, or ask for what cannot be done.",
     is_a<UsageError>},
    {"InputError", "Raised for an input that is malformed, damaged or not supported.",
     is_a<InputError>},
    {"ResourceError",
     "Raised where a file cannot be read or written, or memory or a GPU is missing.",
     is_a<ResourceError>},
    {"Interrupted",
     "Raised where a call was stopped on request. Nothing that was found is lost: the same "
     "search with resume=True goes on.",
     is_a<Interrupted>}};

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    PyObject* type = nullptr;
    for (const ErrorClass& each : error_classes) {
      if (each.holds(&error)) type = each.made;
    }
    const py::object raised = py::handle(type)(text(error.what()));
    const std::string_view remedy = kind_of(error.remedy()).name;
    if (!remedy.empty()) raised.attr("remedy") = text(remedy);
    raised.attr("amount") = error.amount();
    PyErr_SetObject(type, raised.ptr());
  }
}

}  // namespace

void add_errors(py::module_& module) {
  for (ErrorClass& each : error_classes) {
    py::list bases;
    bases.append(py::handle(&each == error_classes ? PyExc_Exception : error_classes->made));
    // What is wrong with an argument is a ValueError, too.
    if (std::string_view(each.name) == "UsageError") bases.append(py::handle(PyExc_ValueError));
    each.made = PyErr_NewExceptionWithDoc((std::string("clearway.") + each.name).c_str(), each.doc,
                                          py::tuple(bases).ptr(), nullptr);
    if (each.made == nullptr) throw py::error_already_set();
    module.attr(each.name) = py::handle(each.made);
  }
  const py::handle error = error_classes->made;
  error.attr("remedy") = py::none();
  error.attr("amount") = 0.0;
  py::register_local_exception_translator(translate);
}

}  // namespace clearway::python
