#include <exception>
#include <string>
#include <string_view>

#include "core/messages/remedies.hpp"
#include "python/python.hpp"

namespace clearway::python {
namespace {

/// The exception classes, which live as long as the process.
struct Classes {
  PyObject *error, *usage, *input, *resource, *interrupted;
};
Classes error_classes{};

PyObject* add_class(py::module_& module, const char* name, const char* doc, py::tuple bases) {
  PyObject* made = PyErr_NewExceptionWithDoc((std::string("clearway.") + name).c_str(), doc,
                                             bases.ptr(), nullptr);
  if (made == nullptr) throw py::error_already_set();
  module.attr(name) = py::handle(made);
  return made;
}

void raise(PyObject* type, const Error& error) {
  const py::object raised = py::handle(type)(text(error.what()));
  const std::string_view remedy = kind_of(error.remedy()).name;
  if (!remedy.empty()) raised.attr("remedy") = text(remedy);
  raised.attr("amount") = error.amount();
  PyErr_SetObject(type, raised.ptr());
}

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const UsageError& error) {
    raise(error_classes.usage, error);
  } catch (const InputError& error) {
    raise(error_classes.input, error);
  } catch (const ResourceError& error) {
    raise(error_classes.resource, error);
  } catch (const Interrupted& error) {
    raise(error_classes.interrupted, error);
  } catch (const Error& error) {
    raise(error_classes.error, error);
  }
}

}  // namespace

void add_errors(py::module_& module) {
  const py::handle plain = PyExc_Exception, value = PyExc_ValueError;
  error_classes.error = add_class(
      module, "Error",
      "Raised where a call cannot be done. The text says what happened and where.\n\n"
      "remedy: what would help, such as 'overwrite' or 'more_memory'; None where nothing is "
      "known.\n"
      "amount: the number of the remedy, such as the bytes that are enough; 0 where it has none.",
      py::make_tuple(plain));
  const py::handle error = error_classes.error;
  error.attr("remedy") = py::none();
  error.attr("amount") = 0.0;
  error_classes.usage =
      add_class(module, "UsageError",
                "Raised for arguments that contradict each other, or ask for what cannot be done.",
                py::make_tuple(error, value));
  error_classes.input = add_class(
      module, "InputError", "Raised for an input that is malformed, damaged or not supported.",
      py::make_tuple(error));
  error_classes.resource =
      add_class(module, "ResourceError",
                "Raised where a file cannot be read or written, or memory or a GPU is missing.",
                py::make_tuple(error));
  error_classes.interrupted = add_class(
      module, "Interrupted",
      "Raised where a call was stopped on request. Nothing that was found is lost: the same "
      "search with resume=True goes on.",
      py::make_tuple(error));
  py::register_local_exception_translator(translate);
}

}  // namespace clearway::python
