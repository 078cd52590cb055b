#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// A position in a file, for messages.
struct FilePlace {
  const char* unit;  ///< "line", counted from 1, or "byte", counted from 0
  std::uint64_t number;

  std::string text() const { return unit + (" " + std::to_string(number)); }
};

/// Collects the vertices, faces, lines and single points of a file, and refuses what cannot be part
/// of a mesh. Memory grows with what is added, never with what a file declares.
class MeshBuilder {
 public:
  /// name: the file's, for messages.
  explicit MeshBuilder(std::string name) : name_(std::move(name)) {}

  std::size_t vertices() const { return file_.mesh.vertices.size(); }
  std::size_t triangles() const { return file_.mesh.triangles.size(); }
  MeshRemarks& remarks() { return file_.remarks; }

  /// Adds a vertex. Throws InputError for a coordinate that is not finite.
  void add_vertex(const Vec3& vertex, const FilePlace& at);
  /// Adds a face of three corners or more, given as indices from 0. Throws InputError for other
  /// faces and for an index that no vertex has.
  void add_face(std::span<const std::int64_t> corners, const FilePlace& at);
  /// Adds a line through two vertices or more. Throws InputError for fewer, and for an index that
  /// no vertex has.
  void add_line(std::span<const std::int64_t> vertices, const FilePlace& at);
  void add_point(std::int64_t vertex, const FilePlace& at);
  MeshFile finish() { return std::move(file_); }

  [[noreturn]] void refuse_at(const FilePlace& at, const std::string& what) const;

 private:
  /// The index of a vertex, once checked; `what` names what refers to it, for messages.
  std::uint32_t checked(std::int64_t vertex, const char* what, const FilePlace& at) const;
  void add_polygon(const FilePlace& at);

  std::string name_;
  MeshFile file_;
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> places_;
};

}  // namespace clearway
