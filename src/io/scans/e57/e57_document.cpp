#include "io/scans/e57/e57_document.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <pugixml.hpp>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/xml_text.hpp"
#include "io/paths/pose_input.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

bool is_utf8_name(std::string_view encoding) {
  constexpr std::string_view kName = "utf-8";
  return std::equal(encoding.begin(), encoding.end(), kName.begin(), kName.end(),
                    [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a + 32 == b); });
}

/// The XML section of an E57 file, which names places by their byte in the file.
class E57Xml : public XmlText {
 public:
  explicit E57Xml(E57Container& file)
      : XmlText(file.pages.name(), "the XML section",
                [&pages = file.pages, start = file.xml_start](std::uint64_t offset) {
                  return "byte " + std::to_string(pages.physical(start + offset));
                }) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 26;
    constexpr std::uint64_t kMostMarkup = std::uint64_t{1} << 21;
    const std::uint64_t most = std::min(kMostBytes, file.pages.size() - file.xml_start);
    if (file.xml_bytes > most) {
      refuse_byte(name(), 32, "an XML section of {} bytes; expected {}", file.xml_bytes,
                  file.xml_bytes > kMostBytes ? "at most " + std::to_string(kMostBytes)
                                              : "it to end before the file");
    }
    std::vector<char> bytes(file.xml_bytes);
    file.pages.read(file.xml_start, std::as_writable_bytes(std::span(bytes)), "the XML section");
    parse(std::move(bytes), kMostMarkup, "e57Root");
    check_encoding();
    if (type_of(root()) != "Structure") refuse_at(root(), "expected the type Structure");
  }

  /// The child of that name, or an empty node. Throws for a second child of the name and for
  /// another E57 type.
  pugi::xml_node find(pugi::xml_node parent, const char* name, std::string_view type) const {
    const pugi::xml_node node = parent.child(name);
    if (!node) return node;
    if (const pugi::xml_node second = node.next_sibling(name)) {
      refuse_at(second, "stands twice; expected it once in its parent");
    }
    if (type_of(node) != type) {
      refuse_at(node, "has the type " + excerpt(type_of(node)) + "; expected " + std::string(type));
    }
    return node;
  }

  std::string_view type_of(pugi::xml_node node) const {
    return attribute(node, "type").value_or("");
  }

  /// The number in an element of type Float or Integer; 0 where the element is empty, as E57
  /// defines.
  double number(pugi::xml_node node) const {
    const std::string value = text(node);
    const std::string_view digits = without_space_around(value);
    if (digits.empty()) return 0;
    const auto result = whole_number_of<double>(digits);
    if (!result) refuse_at(node, "is " + excerpt(digits) + "; expected a number");
    return *result;
  }

  /// The numbers in a structure's children of type Float, all of which must exist.
  template <std::size_t count>
  std::array<double, count> numbers(pugi::xml_node structure,
                                    const std::array<const char*, count>& names) const {
    std::array<double, count> out{};
    for (std::size_t i = 0; i < count; ++i) out[i] = number(get(structure, names[i], "Float"));
    return out;
  }

  /// The child of that name. Throws as find() does, and for a missing child.
  pugi::xml_node get(pugi::xml_node parent, const char* name, std::string_view type) const {
    const pugi::xml_node node = find(parent, name, type);
    if (!node) refuse_at(parent, "has no " + std::string(name) + "; expected one");
    return node;
  }

 private:
  void check_encoding() const {
    const pugi::xml_attribute encoding = first_node().attribute("encoding");
    const bool is_declaration = first_node().type() == pugi::node_declaration;
    if (!is_declaration || !encoding || is_utf8_name(encoding.value())) return;
    refuse_offset(
        0, "the XML section is in the encoding " + excerpt(encoding.value()) + "; expected UTF-8");
  }
};

/// Names of the fields, in the order of E57Place.
constexpr std::string_view kPlaceNames[] = {
    "cartesianX",     "cartesianY",       "cartesianZ",         "cartesianInvalidState",
    "sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState"};
static_assert(std::size(kPlaceNames) == kE57Places);

E57Field integer_field(const E57Xml& xml, pugi::xml_node node, bool scaled) {
  using Limits = std::numeric_limits<std::int64_t>;
  E57Field field;
  field.kind = E57Field::Kind::kInteger;
  field.minimum = xml.number_attribute<std::int64_t>(node, "minimum").value_or(Limits::min());
  const auto maximum = xml.number_attribute<std::int64_t>(node, "maximum").value_or(Limits::max());
  if (maximum < field.minimum) {
    xml.refuse_at(node, fmt::format("goes from {} to {}; expected minimum <= maximum",
                                    field.minimum, maximum));
  }
  field.bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(maximum) -
                                                    static_cast<std::uint64_t>(field.minimum)));
  if (!scaled) return field;
  field.scale = xml.number_attribute<double>(node, "scale").value_or(1);
  field.offset = xml.number_attribute<double>(node, "offset").value_or(0);
  if (!std::isfinite(field.scale) || field.scale == 0 || !std::isfinite(field.offset)) {
    xml.refuse_at(node,
                  "has a scale or an offset that is 0 or not finite; expected a scale "
                  "other than 0");
  }
  return field;
}

E57Field float_field(const E57Xml& xml, pugi::xml_node node) {
  const std::string_view precision = xml.attribute(node, "precision").value_or("double");
  if (precision == "single") return {.kind = E57Field::Kind::kFloat32, .bits = 32};
  if (precision == "double") return {.kind = E57Field::Kind::kFloat64, .bits = 64};
  xml.refuse_at(node, "has another precision; expected single or double");
}

E57Field field_of(const E57Xml& xml, pugi::xml_node node) {
  const std::string_view type = xml.type_of(node);
  if (type == "Float") return float_field(xml, node);
  if (type == "Integer") return integer_field(xml, node, false);
  if (type == "ScaledInteger") return integer_field(xml, node, true);
  if (type == "String") return {};
  xml.refuse_at(node,
                "has a type that no point can have; expected Float, Integer, ScaledInteger or "
                "String");
}

void note_place(const E57Xml& xml, pugi::xml_node node, E57Scan& scan) {
  const auto* const found =
      std::find(std::begin(kPlaceNames), std::end(kPlaceNames), std::string_view(node.name()));
  if (found == std::end(kPlaceNames)) return;
  std::uint32_t& place = scan.places[static_cast<std::size_t>(found - kPlaceNames)];
  if (place != kNoE57Stream) xml.refuse_at(node, "stands twice; expected it once in a prototype");
  if (scan.fields.back().kind == E57Field::Kind::kText) {
    xml.refuse_at(node, "is a text; expected a number");
  }
  place = static_cast<std::uint32_t>(scan.fields.size() - 1);
}

bool is_branch(std::string_view type) { return type == "Structure" || type == "Vector"; }

/// The next element in document order within `top` that is neither `node` nor inside it.
pugi::xml_node next_behind(pugi::xml_node node, pugi::xml_node top) {
  while (node != top && !node.next_sibling()) node = node.parent();
  return node == top ? pugi::xml_node() : node.next_sibling();
}

/// Throws InputError where a scan has some but not all of three fields.
void check_complete(const E57Xml& xml, pugi::xml_node prototype, const E57Scan& scan,
                    E57Place first, E57Place second, E57Place third) {
  if (!scan.has(first) && !scan.has(second) && !scan.has(third)) return;
  for (const E57Place place : {first, second, third}) {
    if (scan.has(place)) continue;
    xml.refuse_at(prototype,
                  fmt::format("has no {} beside {} or its like; expected all three coordinates",
                              kPlaceNames[place], kPlaceNames[first]));
  }
}

/// Throws InputError for codecs other than bit packing, the only one that E57 1.0 defines and which
/// needs no entry.
void check_codecs(const E57Xml& xml, pugi::xml_node points) {
  for (const pugi::xml_node codec : xml.find(points, "codecs", "Vector").children()) {
    for (const pugi::xml_node part : codec.children()) {
      const std::string_view name = part.name();
      if (part.type() != pugi::node_element || name == "inputs" || name == "bitPackCodec") continue;
      xml.refuse_at(part,
                    "is a codec that is not read; expected bitPackCodec. Export the scan "
                    "without compression, or as LAS or PLY");
    }
  }
}

/// Reads from the element `points` which bytestreams a scan has and which of them hold coordinates.
/// Fields of extensions count as bytestreams and are not read.
void read_e57_prototype(const E57Xml& xml, pugi::xml_node points, E57Scan& scan) {
  const pugi::xml_node prototype = xml.get(points, "prototype", "Structure");
  for (pugi::xml_node node = prototype.first_child(); node;) {
    const bool is_element = node.type() == pugi::node_element;
    if (is_element && is_branch(xml.type_of(node)) && node.first_child()) {
      node = node.first_child();
      continue;
    }
    if (is_element && !is_branch(xml.type_of(node))) {
      scan.fields.push_back(field_of(xml, node));
      if (node.parent() == prototype) note_place(xml, node, scan);
    }
    node = next_behind(node, prototype);
  }
  check_complete(xml, prototype, scan, kE57X, kE57Y, kE57Z);
  check_complete(xml, prototype, scan, kE57Range, kE57Azimuth, kE57Elevation);
  check_codecs(xml, points);
}

std::optional<Pose> read_pose(const E57Xml& xml, pugi::xml_node scan) {
  const pugi::xml_node pose = xml.find(scan, "pose", "Structure");
  if (!pose) return std::nullopt;
  std::array<double, 4> quaternion{0, 0, 0, 1};
  std::array<double, 3> translation{};
  if (const auto node = xml.find(pose, "rotation", "Structure")) {
    quaternion = xml.numbers<4>(node, {"x", "y", "z", "w"});
  }
  if (const auto node = xml.find(pose, "translation", "Structure")) {
    translation = xml.numbers<3>(node, {"x", "y", "z"});
  }
  Pose result;
  const Objection objection = pose_of_quaternion(translation, quaternion, result);
  if (!objection.text.empty()) xml.refuse_at(pose, objection.text);
  return result;
}

/// Reads the declared bounds, which serve only for a warning, so that incomplete ones or those not
/// of type Float count as absent.
std::optional<Box> read_bounds(const E57Xml& xml, pugi::xml_node scan) {
  const pugi::xml_node bounds = xml.find(scan, "cartesianBounds", "Structure");
  constexpr const char* kNames[3][2] = {
      {"xMinimum", "xMaximum"}, {"yMinimum", "yMaximum"}, {"zMinimum", "zMaximum"}};
  Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    const pugi::xml_node least = bounds.child(kNames[axis][0]);
    const pugi::xml_node greatest = bounds.child(kNames[axis][1]);
    if (!least || !greatest || xml.type_of(least) != "Float" || xml.type_of(greatest) != "Float") {
      return std::nullopt;
    }
    box.lo[axis] = xml.number(least);
    box.hi[axis] = xml.number(greatest);
  }
  return box;
}

template <typename Number>
Number required(const E57Xml& xml, pugi::xml_node node, const char* name) {
  const auto value = xml.number_attribute<Number>(node, name);
  if (!value) xml.refuse_at(node, "has no attribute " + std::string(name) + "; expected one");
  return *value;
}

E57Scan read_scan(const E57Xml& xml, pugi::xml_node node, std::size_t number) {
  E57Scan scan;
  scan.number = number;
  scan.places.fill(kNoE57Stream);
  const pugi::xml_node points = xml.find(node, "points", "CompressedVector");
  if (!points) return scan;
  scan.records = required<std::uint64_t>(xml, points, "recordCount");
  scan.file_offset = required<std::uint64_t>(xml, points, "fileOffset");
  read_e57_prototype(xml, points, scan);
  scan.pose = read_pose(xml, node);
  scan.bounds = read_bounds(xml, node);
  return scan;
}

}  // namespace

E57Document read_e57_document(E57Container& file) {
  const E57Xml xml(file);
  E57Document document;
  if (const auto node = xml.find(xml.root(), "coordinateMetadata", "String")) {
    document.crs = xml.text(node);
  }
  for (const pugi::xml_node node : xml.find(xml.root(), "data3D", "Vector").children()) {
    if (node.type() != pugi::node_element) continue;
    if (std::string_view(node.name()) != "vectorChild" || xml.type_of(node) != "Structure") {
      xml.refuse_at(node, "is no scan; expected vectorChild of type Structure");
    }
    document.scans.push_back(read_scan(xml, node, document.scans.size() + 1));
  }
  return document;
}

}  // namespace clearway
