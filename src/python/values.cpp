#include "python/values.hpp"

#include <algorithm>
#include <string>

#include "clearway/error.hpp"
#include "clearway/found_place.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/answer.hpp"
#include "core/util/format.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
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

constexpr std::tuple kMessageFacts{
    fact<&Message::code>("The cause of a warning in one word, such as 'no-poses'; '' for a note."),
    fact<&Message::text>("The text, in one or more sentences."),
    fact<&Message::body>("The name of the one body that it is about; '' where it is about several "
                         "or all."),
    fact<&Message::stretches>("The stretches of the path that the message is about: a list of "
                              "pairs of the first and the last pose, ascending. Empty for a "
                              "message about the whole question.")};

constexpr std::tuple kProgressFacts{
    fact<&KeptProgress::stage>("The name of the stage, for people."),
    fact<&KeptProgress::done>("How much of the stage is done."),
    fact<&KeptProgress::total>("How much the stage has in all; 0 where that is not known."),
    fact<&KeptProgress::unit>("What done and total count, such as 'points'."),
    fact<&KeptProgress::finished>("Whether the stage has ended.")};

void add_messages(py::module_& module) {
  auto message = add_class<Message>(
      module, "Message", "A note or a warning about a call, for people to read.", kMessageFacts);
  message.def_property_readonly("severity", severity_of, "'note' or 'warning'.")
      .def_property_readonly("numbers", numbers_of,
                             "The numbers that the text gives, for programs: a dict by name.")
      .def("__str__", [](const Message& m) { return text(m.text); });
  add_repr(message, [](const Message& m) {
    return std::string("<") + severity_of(m) + (m.code.empty() ? "" : " ") + m.code + ": " +
           m.text + ">";
  });
  auto progress = add_class<KeptProgress>(module, "ProgressUpdate",
                                          "How far a stage of a long call is.", kProgressFacts);
  add_repr(progress, [](const KeptProgress& p) {
    return "<" + p.stage + ": " + std::to_string(p.done) +
           (p.total > 0 ? " of " + std::to_string(p.total) : "") + " " + p.unit + ">";
  });
}

constexpr std::tuple kBoxFacts{fact<&Box::lo>("The least coordinates: 3 float64, metres."),
                               fact<&Box::hi>("The greatest coordinates: 3 float64, metres.")};

void add_places(py::module_& module) {
  auto box = add_class<Box>(
      module, "Box", "A box along the axes, which includes its borders; in metres.", kBoxFacts);
  box.def(py::init([](const py::kwargs& given) {
            return Box{point_of(given["lo"], "lo"), point_of(given["hi"], "hi")};
          }),
          R"(__init__(self, lo: Array, hi: Array)
--

Make a box of two corners.

lo: the least coordinates: 3 numbers, metres.
hi: the greatest coordinates: 3 numbers, metres.)")
      .def(
          "__eq__", [](const Box& a, const Box& b) { return a == b; }, py::is_operator());
  add_repr(box, [](const Box& b) {
    const auto list = [](const Vec3& p) { return py::str(to_array(p).attr("tolist")()); };
    return py::str("Box(lo={}, hi={})").format(list(b.lo), list(b.hi));
  });
  auto place = add_class<FoundPlace>(
      module, "FoundPlace",
      "A point of the environment that was found, and the pose at which it was.");
  add_repr(place, [](const FoundPlace& p) {
    return py::str("<point {} at pose {}, {} m>").format(p.source, p.pose, p.distance);
  });
}

}  // namespace

void append_to(const py::kwargs& given, const std::vector<Message>& messages) {
  const py::object list = given["messages"];
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

EnvironmentUnit environment_unit_of(const std::optional<UnitArgument>& unit) {
  if (!unit || *unit == UnitArgument("unknown")) {
    return {.is_assumed = true, .is_given = unit.has_value()};
  }
  if (*unit == UnitArgument("degree")) return {};
  return {.metres = file_unit(*unit).metres()};
}

void check_unit_is_given(const std::filesystem::path& file, const EnvironmentUnit& environment,
                         const FileUnit& of_file, std::vector<Message>& noted) {
  if (environment.is_given) return;
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
