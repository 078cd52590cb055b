#include <array>
#include <limits>
#include <span>

#include "io/formats/e57/e57_prototype.hpp"
#include "io/formats/e57/e57_scan.hpp"
#include "io/formats/e57/e57_xml.hpp"
#include "io/trajectory/pose_input.hpp"

namespace clearway {
namespace {

/// The numbers of a structure's children, all of which must exist.
template <std::size_t count>
std::array<double, count> numbers_of(const E57Xml& xml, pugi::xml_node structure,
                                     const std::array<const char*, count>& names) {
  std::array<double, count> numbers{};
  for (std::size_t i = 0; i < count; ++i) {
    numbers[i] = xml.number(xml.get(structure, names[i], "Float"));
  }
  return numbers;
}

std::optional<Pose> read_pose(const E57Xml& xml, pugi::xml_node scan) {
  const pugi::xml_node pose = xml.find(scan, "pose", "Structure");
  if (!pose) return std::nullopt;
  std::array<double, 4> quaternion{0, 0, 0, 1};
  std::array<double, 3> translation{};
  if (const auto node = xml.find(pose, "rotation", "Structure")) {
    quaternion = numbers_of<4>(xml, node, {"x", "y", "z", "w"});
  }
  if (const auto node = xml.find(pose, "translation", "Structure")) {
    translation = numbers_of<3>(xml, node, {"x", "y", "z"});
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
