#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// Where in a file something stands.
struct FilePlace {
  const char* unit;  ///< "line", from 1, or "byte", from 0
  std::uint64_t number;

  std::string text() const { return unit + (" " + std::to_string(number)); }
};

/// Collects the vertices, faces, lines and single points of a file, and refuses what cannot be part
/// of a mesh. Memory grows with what was added, never with what a file declares.
class MeshBuilder {
 public:
  /// name: of the file, for messages
  explicit MeshBuilder(std::string name) : name_(std::move(name)) {}

  std::size_t vertices() const { return file_.mesh.vertices.size(); }
  std::size_t triangles() const { return file_.mesh.triangles.size(); }
  MeshRemarks& remarks() { return file_.remarks; }

  /// Throws InputError for a coordinate that is not finite.
  void add_vertex(const Vec3& vertex, const FilePlace& at);
  /// A face of three corners or more; indices from 0. Throws InputError for other faces and for an
  /// index that no vertex has.
  void add_face(std::span<const std::int64_t> corners, const FilePlace& at);
  /// A line through two vertices or more. Throws InputError for fewer, and as add_face().
  void add_line(std::span<const std::int64_t> vertices, const FilePlace& at);
  void add_point(std::int64_t vertex, const FilePlace& at);
  MeshFile finish() { return std::move(file_); }

  [[noreturn]] void refuse_at(const FilePlace& at, const std::string& what) const;

 private:
  /// The number of a vertex that `what` names.
  std::uint32_t checked(std::int64_t vertex, const char* what, const FilePlace& at) const;
  void add_polygon(const FilePlace& at);

  std::string name_;
  MeshFile file_;
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> places_;
};

}  // namespace clearway
