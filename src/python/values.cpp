#include "python/values.hpp"

#include <string>

#include "clearway/found_place.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "python/arrays.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using Severity = Message::Severity;

py::dict numbers_of(const Message& message) {
  py::dict numbers;
  for (const auto& [name, value] : message.numbers) numbers[text(name)] = value;
  return numbers;
}

const char* severity_of(const Message& message) {
  return message.severity == Severity::kWarning ? "warning" : "note";
}

void add_messages(py::module_& module) {
  py::class_<Message>(module, "Message", "Something to tell people about a call.")
      .def_property_readonly("severity", severity_of, "'note' or 'warning'.")
      .def_property_readonly(
          "code", [](const Message& m) { return text(m.code); },
          "Of a warning: the same for the same cause, such as 'no-poses'.")
      .def_property_readonly(
          "text", [](const Message& m) { return text(m.text); }, "For people.")
      .def_property_readonly("numbers", numbers_of, "The numbers of the text, by name.")
      .def("__str__", [](const Message& m) { return text(m.text); })
      .def("__repr__", [](const Message& m) {
        return text(std::string("<") + severity_of(m) + (m.code.empty() ? "" : " ") + m.code +
                    ": " + m.text + ">");
      });
  py::class_<KeptProgress>(module, "ProgressUpdate", "How far a stage of a long call is.")
      .def_property_readonly(
          "stage", [](const KeptProgress& p) { return text(p.stage); }, "For people.")
      .def_readonly("done", &KeptProgress::done)
      .def_readonly("total", &KeptProgress::total, "0: not known.")
      .def_property_readonly(
          "unit", [](const KeptProgress& p) { return text(p.unit); }, "Of done and total.")
      .def_readonly("finished", &KeptProgress::finished, "Whether the stage ended.")
      .def("__repr__", [](const KeptProgress& p) {
        return text("<" + p.stage + ": " + std::to_string(p.done) +
                    (p.total > 0 ? " of " + std::to_string(p.total) : "") + " " + p.unit + ">");
      });
}

Vec3 corner_of(const py::handle& object) {
  const py::array array = py::module_::import("numpy").attr("asarray")(object, "float64");
  if (array.ndim() != 1 || array.size() != 3) {
    throw UsageError("Box: expected 3 numbers for each corner");
  }
  const auto numbers = Doubles::ensure(array);
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

void add_places(py::module_& module) {
  py::class_<Box>(module, "Box", "A box along the axes, both corners included. Metres.")
      .def(py::init([](const py::object& lo, const py::object& hi) {
             return Box{corner_of(lo), corner_of(hi)};
           }),
           py::arg("lo"), py::arg("hi"))
      .def_property_readonly(
          "lo", [](const Box& box) { return to_array(box.lo); },
          "The least coordinates: 3 float64.")
      .def_property_readonly(
          "hi", [](const Box& box) { return to_array(box.hi); },
          "The greatest coordinates: 3 float64.")
      .def(
          "__eq__", [](const Box& a, const Box& b) { return a == b; }, py::is_operator())
      .def("__repr__", [](const Box& box) {
        const auto list = [](const Vec3& p) { return py::str(to_array(p).attr("tolist")()); };
        return py::str("Box(lo={}, hi={})").format(list(box.lo), list(box.hi));
      });
  py::class_<FoundPlace>(module, "FoundPlace",
                         "An environment point, and the pose at which it counts.")
      .def_readonly("source", &FoundPlace::source, "Index of the point in the order of the scans.")
      .def_readonly("pose", &FoundPlace::pose, "Index of the pose, from 0.")
      .def_property_readonly(
          "xyz", [](const FoundPlace& p) { return to_array(p.xyz); }, "3 float64, metres.")
      .def_readonly("distance", &FoundPlace::distance, "Metres, where one was asked for.")
      .def("__repr__", [](const FoundPlace& p) {
        return py::str("<point {} at pose {}, {} m>").format(p.source, p.pose, p.distance);
      });
}

}  // namespace

py::list to_list(const std::vector<Message>& messages) {
  py::list list;
  append_to(list, messages);
  return list;
}

std::vector<Message> messages_of(const py::handle& object) {
  std::vector<Message> messages;
  if (object.is_none()) return messages;
  for (const py::handle message : py::iter(object)) {
    if (!py::isinstance<Message>(message)) throw py::type_error("expected a list of Message");
    messages.push_back(message.cast<Message>());
  }
  return messages;
}

void append_to(const py::handle& list, const std::vector<Message>& messages) {
  if (list.is_none()) return;
  for (const Message& message : messages) list.attr("append")(message);
}

std::string warning_words(const std::vector<Message>& warnings) {
  if (warnings.empty()) return "";
  std::string words = "; " + std::to_string(warnings.size()) +
                      (warnings.size() == 1 ? " warning: " : " warnings: ");
  for (const Message& warning : warnings) {
    words += (&warning == &warnings.front() ? "" : ", ") + warning.code;
  }
  return words;
}

void add_values(py::module_& module) {
  add_messages(module);
  add_places(module);
  module.attr("METRES_PER_MILLIMETRE") = kMetresPerMillimetre;
  module.attr("METRES_PER_CENTIMETRE") = kMetresPerCentimetre;
  module.attr("METRES_PER_INCH") = kMetresPerInch;
  module.attr("METRES_PER_FOOT") = kMetresPerFoot;
}

}  // namespace clearway::python
