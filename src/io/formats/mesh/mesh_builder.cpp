#include "io/formats/mesh/mesh_builder.hpp"

#include <cmath>
#include <limits>

#include "core/util/format.hpp"
#include "io/formats/mesh/polygon.hpp"
#include "io/system/input_error.hpp"

namespace clearway {

void MeshBuilder::refuse_at(const FilePlace& at, const std::string& what) const {
  refuse(name_, at.text() + ": " + what);
}

void MeshBuilder::add_vertex(const Vec3& vertex, const FilePlace& at) {
  if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
    refuse_at(at, "vertex (" + shown(vertex.x) + ", " + shown(vertex.y) + ", " + shown(vertex.z) +
                      "); expected finite coordinates");
  }
  if (vertices() > std::numeric_limits<std::uint32_t>::max() - 1) {
    refuse_at(at, "more than 4,294,967,295 vertices; expected fewer");
  }
  file_.mesh.vertices.push_back(vertex);
}

std::uint32_t MeshBuilder::checked(std::int64_t vertex, const char* what,
                                   const FilePlace& at) const {
  if (vertex < 0 || vertex >= static_cast<std::int64_t>(vertices())) {
    refuse_at(at, std::string(what) + " names vertex " + std::to_string(vertex) +
                      " (counted from 0), of " + std::to_string(vertices()) +
                      "; expected a vertex of the file");
  }
  return static_cast<std::uint32_t>(vertex);
}

void MeshBuilder::add_line(std::span<const std::int64_t> vertices, const FilePlace& at) {
  if (vertices.size() < 2) {
    refuse_at(at, "a line through " + counted(vertices.size(), "vertex", "vertices") +
                      "; expected 2 or more");
  }
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const std::uint32_t from = checked(vertices[i - 1], "a line", at);
    const std::uint32_t to = checked(vertices[i], "a line", at);
    file_.mesh.triangles.push_back({from, to, to});
  }
  file_.remarks.segments += vertices.size() - 1;
}

void MeshBuilder::add_point(std::int64_t vertex, const FilePlace& at) {
  const std::uint32_t place = checked(vertex, "a point", at);
  file_.mesh.triangles.push_back({place, place, place});
  ++file_.remarks.single_points;
}

void MeshBuilder::add_face(std::span<const std::int64_t> corners, const FilePlace& at) {
  if (corners.size() < 3) {
    refuse_at(at, "a face with " + std::to_string(corners.size()) + " corners; expected 3 or more");
  }
  if (corners.size() > kMostCorners) {
    refuse_at(at, "a face with " + format_count(corners.size()) + " corners; expected at most " +
                      format_count(kMostCorners) + ". Export the mesh as triangles");
  }
  corners_.clear();
  for (const std::int64_t corner : corners) {
    corners_.push_back(checked(corner, "a face", at));
  }
  if (corners_.size() == 3) {
    file_.mesh.triangles.push_back({corners_[0], corners_[1], corners_[2]});
  } else {
    add_polygon(at);
  }
}

void MeshBuilder::add_polygon(const FilePlace& at) {
  places_.clear();
  for (const std::uint32_t corner : corners_) places_.push_back(file_.mesh.vertices[corner]);
  if (corners_.size() > kMostCornersToCut && !is_fan(places_)) {
    refuse_at(at, "a face with " + format_count(corners_.size()) +
                      " corners that is not convex; expected at most " +
                      format_count(kMostCornersToCut) + ". Export the mesh as triangles");
  }
  const CutPolygon cut = cut_polygon(places_);
  for (const auto& [a, b, c] : cut.triangles) {
    file_.mesh.triangles.push_back({corners_[a], corners_[b], corners_[c]});
  }
  MeshRemarks& remarks = file_.remarks;
  ++remarks.polygons;
  if (cut.crossing && remarks.crossing++ == 0) remarks.first_crossing = at.text();
  if (cut.bend > remarks.largest_bend) {
    remarks.largest_bend = cut.bend;
    remarks.largest_bend_at = at.text();
  }
}

}  // namespace clearway
