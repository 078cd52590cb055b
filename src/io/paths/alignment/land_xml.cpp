#include "io/paths/alignment/land_xml.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "clearway/file_unit.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/text_lines.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

/// The values of linearUnit in LandXML 1.2, in metres.
constexpr NamedValue<double> kMetric[] = {
    {"millimeter", 0.001}, {"centimeter", 0.01}, {"meter", 1}, {"kilometer", 1000}};
constexpr NamedValue<double> kImperial[] = {{"foot", kMetresPerFoot},
                                            {"USSurveyFoot", kMetresPerUsSurveyFoot},
                                            {"inch", kMetresPerInch},
                                            {"mile", 1609.344}};
/// Those of elevationUnit, which have other names.
constexpr NamedValue<double> kHeights[] = {
    {"meter", 1}, {"kilometer", 1000}, {"feet", kMetresPerFoot}, {"miles", 1609.344}};

std::vector<char> bytes_of(const std::filesystem::path& path) {
  const File file = File::open_regular(path);
  const std::uint64_t bytes = file.size_bytes();
  if (bytes > LandXml::kMostBytes) {
    refuse(file.name(), "has " + format_size(bytes) + "; expected LandXML of at most " +
                            format_size(LandXml::kMostBytes) +
                            ". Export the alignment without the surfaces of the project");
  }
  std::vector<char> text(bytes);
  if (bytes > 0) file.read_at(0, std::as_writable_bytes(std::span(text)));
  refuse_foreign(file.name(), {text.data(), text.size()});
  return text;
}

/// "line 7", by counting the line breaks before an offset of the file.
std::string line_at(const std::filesystem::path& path, std::uint64_t offset) {
  const std::vector<char> text = bytes_of(path);
  const std::size_t before = std::min<std::uint64_t>(offset, text.size());
  return "line " + std::to_string(1 + count_line_breaks({text.data(), before}));
}

}  // namespace

LandXml::LandXml(const std::filesystem::path& path, AxisOrder order)
    : XmlText(path.string(), "the file",
              [path](std::uint64_t offset) { return line_at(path, offset); }),
      order_(order) {
  parse(bytes_of(path), kMostMarkup, "LandXML");
  read_unit();
}

void LandXml::read_unit() {
  const pugi::xml_node units = only_child(root(), "Units");
  if (!units) {
    refuse_at(root(), "has no Units; expected Metric or Imperial with the attribute linearUnit");
  }
  const pugi::xml_node metric = only_child(units, "Metric");
  const pugi::xml_node imperial = only_child(units, "Imperial");
  if (bool(metric) == bool(imperial)) {
    refuse_at(units, std::string(metric ? "has both Metric and" : "has neither Metric nor") +
                         " Imperial; expected one of them");
  }
  const pugi::xml_node system = metric ? metric : imperial;
  imperial_ = bool(imperial);
  metres_ = metric ? named(system, "linearUnit", kMetric, {},
                           " in Metric, or foot, USSurveyFoot, inch, mile in Imperial")
                   : named(system, "linearUnit", kImperial, {},
                           " in Imperial, or millimeter, centimeter, meter, kilometer in Metric");
  unit_name_ = without_space_around(*attribute(system, "linearUnit"));
  const double heights = named(system, "elevationUnit", kHeights, std::optional(metres_));
  if (std::abs(heights - metres_) <= kSameHeights * metres_) return;
  refuse_at(system, "has elevationUnit=" + excerpt(*attribute(system, "elevationUnit")) +
                        " and linearUnit=" + excerpt(unit_name_) +
                        "; expected one unit for heights and lengths");
}

std::string LandXml::swapped_advice() const {
  return std::string("The coordinates were read as ") +
         (order_ == AxisOrder::kNorthingEasting
              ? "northing, easting; if the file has easting first, give --order en"
              : "easting, northing; if the file has northing first, give --order ne");
}

pugi::xml_node LandXml::only_child(pugi::xml_node parent, const char* name,
                                   const char* otherwise) const {
  const pugi::xml_node node = parent.child(name);
  if (const pugi::xml_node second = node.next_sibling(name)) {
    refuse_at(second, "stands twice in its " + excerpt(parent.name()) + "; expected it once" +
                          std::string(otherwise));
  }
  return node;
}

std::string LandXml::name_of(pugi::xml_node node) const {
  const std::string name(attribute(node, "name").value_or(""));
  if (valid_utf8(name) == name) return name;
  // A name that is in another encoding is taken as ISO 8859-1.
  std::wstring letters;
  for (const char c : name) letters += static_cast<wchar_t>(static_cast<unsigned char>(c));
  return pugi::as_utf8(letters);
}

std::optional<double> LandXml::number(pugi::xml_node node, const char* name) const {
  const auto value = number_attribute<double>(node, name);
  if (value && !std::isfinite(*value)) {
    refuse_value(node, name, "a finite number");
  }
  return value;
}

std::optional<double> LandXml::length(pugi::xml_node node, const char* name, double least) const {
  const auto value = number(node, name);
  if (!value) return value;
  if (!(*value >= least)) {
    refuse_value(node, name, format_number(least) + " or more");
  }
  return in_metres(*value);
}

std::vector<double> LandXml::numbers(pugi::xml_node node, std::size_t least, std::size_t most,
                                     const char* what) const {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::string all = text(node);
  std::vector<double> found;
  for (std::size_t at = all.find_first_not_of(kSpace); at != std::string::npos;
       at = all.find_first_not_of(kSpace, at)) {
    const std::size_t end = std::min(all.find_first_of(kSpace, at), all.size());
    const std::string_view word = std::string_view(all).substr(at, end - at);
    const auto value = whole_number_of<double>(word);
    if (!value || !std::isfinite(*value)) {
      refuse_at(node, "holds " + excerpt(word) + "; expected " + what +
                          " as finite numbers with decimal points, separated by blanks");
    }
    if (found.size() == most) {
      refuse_at(node, "holds more than " + std::to_string(most) + " numbers; expected " + what);
    }
    found.push_back(*value);
    at = end;
  }
  if (found.size() < least) {
    refuse_at(node, "holds " + counted(found.size(), "number") + "; expected " + what);
  }
  return found;
}

std::optional<std::complex<double>> LandXml::find_place(pugi::xml_node parent,
                                                        const char* name) const {
  const pugi::xml_node node = only_child(parent, name);
  if (!node) return std::nullopt;
  if (attribute(node, "pntRef")) {
    refuse_at(node,
              "refers to a point by pntRef, which is not read; expected its coordinates. "
              "Export the alignment with coordinates");
  }
  const auto values = numbers(node, 2, 3, "a northing and an easting");
  const double first = in_metres(values[0]), second = in_metres(values[1]);
  return order_ == AxisOrder::kNorthingEasting ? std::complex(second, first)
                                               : std::complex(first, second);
}

std::complex<double> LandXml::place(pugi::xml_node parent, const char* name) const {
  const auto found = find_place(parent, name);
  if (!found) refuse_at(parent, "has no {}; expected a northing and an easting", name);
  return *found;
}

}  // namespace clearway
