#include "python/values.hpp"

#include <algorithm>
#include <string>

#include "clearway/error.hpp"
#include "clearway/found_place.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/util/format.hpp"
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

py::list path_stretches_of(const Message& message) {
  py::list stretches;
  for (const PoseRange& stretch : message.stretches) {
    stretches.append(py::make_tuple(stretch.first, stretch.last));
  }
  return stretches;
}

const char* severity_of(const Message& message) {
  return message.severity == Severity::kWarning ? "warning" : "note";
}

void add_messages(py::module_& module) {
  py::class_<Message>(module, "Message", "A note or a warning about a call, for people to read.")
      .def_property_readonly("severity", severity_of, "'note' or 'warning'.")
      .def_property_readonly(
          "code", [](const Message& m) { return text(m.code); },
          "The cause of a warning in one word, such as 'no-poses'; '' for a note.")
      .def_property_readonly(
          "text", [](const Message& m) { return text(m.text); },
          "The text, in one or more sentences.")
      .def_property_readonly("numbers", numbers_of,
                             "The numbers that the text gives, for programs: a dict by name.")
      .def_property_readonly(
          "body", [](const Message& m) { return text(m.body); },
          "The name of the one body that it is about; '' where it is about several or all.")
      .def_property_readonly("stretches", path_stretches_of,
                             "The stretches of the path that the message is about: a list of pairs "
                             "of the first and the last pose, ascending. Empty for a message about "
                             "the whole question.")
      .def("__str__", [](const Message& m) { return text(m.text); })
      .def("__repr__", [](const Message& m) {
        return text(std::string("<") + severity_of(m) + (m.code.empty() ? "" : " ") + m.code +
                    ": " + m.text + ">");
      });
  py::class_<KeptProgress>(module, "ProgressUpdate", "How far a stage of a long call is.")
      .def_property_readonly(
          "stage", [](const KeptProgress& p) { return text(p.stage); },
          "The name of the stage, for people.")
      .def_readonly("done", &KeptProgress::done, "How much of the stage is done.")
      .def_readonly("total", &KeptProgress::total,
                    "How much the stage has in all; 0 where that is not known.")
      .def_property_readonly(
          "unit", [](const KeptProgress& p) { return text(p.unit); },
          "What done and total count, such as 'points'.")
      .def_readonly("finished", &KeptProgress::finished, "Whether the stage has ended.")
      .def("__repr__", [](const KeptProgress& p) {
        return text("<" + p.stage + ": " + std::to_string(p.done) +
                    (p.total > 0 ? " of " + std::to_string(p.total) : "") + " " + p.unit + ">");
      });
}

void add_places(py::module_& module) {
  py::class_<Box>(module, "Box", "A box along the axes, which includes its borders; in metres.")
      .def(py::init([](const py::object& lo, const py::object& hi) {
             return Box{point_of(lo, "lo"), point_of(hi, "hi")};
           }),
           py::arg("lo"), py::arg("hi"),
           R"(__init__(self, lo, hi)
--

Make a box of two corners.

lo: the least coordinates: 3 numbers, metres.
hi: the greatest coordinates: 3 numbers, metres.)")
      .def_property_readonly(
          "lo", [](const Box& box) { return to_array(box.lo); },
          "The least coordinates: 3 float64, metres.")
      .def_property_readonly(
          "hi", [](const Box& box) { return to_array(box.hi); },
          "The greatest coordinates: 3 float64, metres.")
      .def(
          "__eq__", [](const Box& a, const Box& b) { return a == b; }, py::is_operator())
      .def("__repr__", [](const Box& box) {
        const auto list = [](const Vec3& p) { return py::str(to_array(p).attr("tolist")()); };
        return py::str("Box(lo={}, hi={})").format(list(box.lo), list(box.hi));
      });
  py::class_<FoundPlace>(module, "FoundPlace",
                         "A point of the environment that was found, and the pose at which it was.")
      .def_readonly("source", &FoundPlace::source,
                    "The index of the point in the order of the scans.")
      .def_readonly("pose", &FoundPlace::pose, "The index of the pose, from 0.")
      .def_property_readonly(
          "xyz", [](const FoundPlace& p) { return to_array(p.xyz); },
          "The coordinates of the point: 3 float64, metres.")
      .def_readonly("distance", &FoundPlace::distance,
                    "The distance between the point and the model at this pose, metres; 0 where "
                    "distances were not asked for.")
      .def_readonly("point_class", &FoundPlace::point_class,
                    "The class of the point, as the scans have it. None unless they have classes.")
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

FileUnit file_unit(const UnitArgument& unit) {
  const auto* const name = std::get_if<std::string>(&unit);
  return name != nullptr ? FileUnit::named(*name) : FileUnit(std::get<double>(unit));
}

EnvironmentUnit environment_unit_of(const EnvironmentUnitArgument& unit) {
  if (!unit || *unit == UnitArgument("unknown")) return {.is_assumed = true};
  if (*unit == UnitArgument("degree")) return {};
  return {.metres = file_unit(*unit).metres()};
}

void check_unit_is_given(const std::filesystem::path& file,
                         const EnvironmentUnitArgument& environment_unit, const FileUnit& of_file,
                         std::vector<Message>& noted) {
  if (environment_unit) return;
  const auto is_assumed = [](const Message& message) { return message.code == "unit-assumed"; };
  const auto found = std::ranges::find_if(noted, is_assumed);
  if (found == noted.end()) return;
  const auto metres =
      std::ranges::find(found->numbers, "metres", [](const auto& n) { return n.first; });
  const std::string unit = metres == found->numbers.end()
                               ? "another unit than the metre"
                               : "units of " + format_number(metres->second) + " m";
  std::erase_if(noted, is_assumed);
  if (of_file.is_known()) return;
  throw UsageError(file.string() + ": has lengths in " + unit +
                   ", and nothing says into which unit to convert them. Give "
                   "environment_unit=store.metres_per_unit(), or environment_unit=1.0 for a store "
                   "in metres");
}

void add_values(py::module_& module) {
  add_messages(module);
  add_places(module);
  module.attr("METRES_PER_MILLIMETRE") = kMetresPerMillimetre;
  module.attr("METRES_PER_CENTIMETRE") = kMetresPerCentimetre;
  module.attr("METRES_PER_INCH") = kMetresPerInch;
  module.attr("METRES_PER_FOOT") = kMetresPerFoot;
  module.attr("METRES_PER_US_SURVEY_FOOT") = kMetresPerUsSurveyFoot;
}

}  // namespace clearway::python
