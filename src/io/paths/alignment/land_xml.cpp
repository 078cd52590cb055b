#include "io/paths/alignment/land_xml.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "clearway/file_unit.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_lines.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

struct LandUnit {
  std::string_view name;
  bool imperial;
  double metres;
};

/// The values of linearUnit in LandXML 1.2.
constexpr LandUnit kUnits[] = {{"millimeter", false, 0.001},
                               {"centimeter", false, 0.01},
                               {"meter", false, 1},
                               {"kilometer", false, 1000},
                               {"foot", true, kMetresPerFoot},
                               {"USSurveyFoot", true, kMetresPerUsSurveyFoot},
                               {"inch", true, kMetresPerInch},
                               {"mile", true, 1609.344}};

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

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int more = lead < 0x80       ? 0
                     : lead >> 5 == 6  ? 1
                     : lead >> 4 == 14 ? 2
                     : lead >> 3 == 30 ? 3
                                       : -1;
    if (more < 0) return false;
    for (int k = 0; k < more; ++k) {
      if (i == text.size() || (static_cast<unsigned char>(text[i++]) >> 6) != 2) return false;
    }
  }
  return true;
}

/// A name in UTF-8; one that is in another encoding is taken as ISO 8859-1.
std::string utf8_of(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string name;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80) {
      name += c;
    } else {
      name += static_cast<char>(0xC0 | code >> 6);
      name += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return name;
}

std::string list_of_units() {
  std::string list;
  for (const LandUnit& unit : kUnits) list += (list.empty() ? "" : ", ") + std::string(unit.name);
  return list;
}

}  // namespace

LandXml::LandXml(const std::filesystem::path& path)
    : XmlText(path.string(), "the file",
              [path](std::uint64_t offset) { return line_at(path, offset); }) {
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
  const auto name = attribute(system, "linearUnit");
  if (!name) refuse_at(system, "has no attribute linearUnit; expected the unit of lengths");
  const auto* const unit = std::ranges::find_if(kUnits, [&](const LandUnit& known) {
    return known.name == *name && known.imperial == bool(imperial);
  });
  if (unit == std::end(kUnits)) {
    refuse_at(system, "has linearUnit=" + excerpt(*name) + "; expected one of " + list_of_units() +
                          ", the first four in Metric and the others in Imperial");
  }
  metres_ = unit->metres;
  unit_name_ = unit->name;
  imperial_ = unit->imperial;
  check_heights(system);
}

void LandXml::check_heights(pugi::xml_node system) const {
  const auto name = attribute(system, "elevationUnit");
  if (!name) return;
  // Here LandXML has other names than for linearUnit.
  constexpr std::pair<std::string_view, double> kHeights[] = {
      {"meter", 1}, {"kilometer", 1000}, {"feet", kMetresPerFoot}, {"miles", 1609.344}};
  const auto* const unit =
      std::ranges::find(kHeights, *name, &std::pair<std::string_view, double>::first);
  if (unit != std::end(kHeights) && std::abs(unit->second - metres_) <= kSameHeights * metres_) {
    return;
  }
  refuse_at(system, "has elevationUnit=" + excerpt(*name) + " and linearUnit=" +
                        excerpt(unit_name_) + "; expected one unit for heights and lengths");
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
  return utf8_of(attribute(node, "name").value_or(""));
}

std::optional<double> LandXml::number(pugi::xml_node node, const char* name) const {
  const auto value = number_attribute<double>(node, name);
  if (value && !std::isfinite(*value)) {
    refuse_at(node, "has " + std::string(name) + "=" + excerpt(*attribute(node, name)) +
                        "; expected a finite number");
  }
  return value;
}

std::optional<double> LandXml::length(pugi::xml_node node, const char* name) const {
  auto value = number(node, name);
  if (value) *value = UnitFactor(metres_)(*value);
  return value;
}

double LandXml::required_length(pugi::xml_node node, const char* name, const char* what) const {
  const auto value = length(node, name);
  if (!value) refuse_at(node, "has no attribute " + std::string(name) + "; expected " + what);
  return *value;
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

std::optional<std::complex<double>> LandXml::find_point(pugi::xml_node parent,
                                                        const char* name) const {
  const pugi::xml_node node = only_child(parent, name);
  if (!node) return std::nullopt;
  if (attribute(node, "pntRef")) {
    refuse_at(node,
              "refers to a point by pntRef, which is not read; expected its coordinates. "
              "Export the alignment with coordinates");
  }
  const auto values = numbers(node, 2, 3, "a northing and an easting");
  const UnitFactor metres(metres_);
  return std::complex(metres(values[0]), metres(values[1]));
}

std::complex<double> LandXml::point(pugi::xml_node parent, const char* name) const {
  const auto found = find_point(parent, name);
  if (!found)
    refuse_at(parent, "has no " + std::string(name) + "; expected a northing and an easting");
  return *found;
}

}  // namespace clearway
