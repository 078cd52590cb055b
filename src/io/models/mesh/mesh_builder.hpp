#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/vec3.hpp"
#include "io/files/input_error.hpp"

namespace clearway {

/// Triangles over indexed vertices. Every index is that of a vertex, and every coordinate is
/// finite. A line segment from a to b is the triangle a, b, b, and a single point is a, a, a, so
/// that everything that works on triangles works on them too.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Counts of what was found in a mesh file, for remarks.
struct MeshRemarks {
  std::uint64_t polygons = 0;  ///< faces with more than three corners
  std::uint64_t crossing = 0;  ///< polygons whose outline crosses itself
  std::string first_crossing;  ///< position in the file of the first crossing polygon
  /// Greatest distance of a polygon's corner from the polygon's plane, in file units.
  double largest_bend = 0;
  std::string largest_bend_at;  ///< position in the file of the polygon with the largest bend
  std::uint64_t segments = 0;   ///< segments of lines in the file, which are triangles of the mesh
  std::uint64_t single_points = 0;  ///< single points in the file, which are triangles of the mesh
  bool last_line_open = false;      ///< whether the file is text that ends without a line break
};

/// A mesh file as read; it has no triangles where it holds vertices alone.
struct MeshFile {
  TriangleMesh mesh;
  MeshRemarks remarks;
  FileUnit unit = {};  ///< unit that a comment of Clearway names
};

/// Gives equal positions the same index, in the order of their first use. -0 equals 0.
class VertexWelder {
 public:
  /// vertices: the distinct positions by their index. It must outlive this object and be changed by
  /// it alone.
  explicit VertexWelder(std::vector<Vec3>& vertices) : vertices_(vertices), table_(1024, kFree) {}

  /// The index of a finite position.
  std::uint32_t number_of(const Vec3& position) {
    const Vec3 vertex{position.x + 0.0, position.y + 0.0, position.z + 0.0};
    if (2 * (vertices_.size() + 1) > table_.size()) grow();
    std::uint32_t& slot = slot_of(vertex);
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(vertex);
    }
    return slot;
  }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

  static std::uint64_t hash_of(const Vec3& v) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(v[k])) * 0x9E3779B97F4A7C15;
      hash ^= hash >> 29;
    }
    return hash;
  }

  /// The slot of this vertex, or the free one that it will get.
  std::uint32_t& slot_of(const Vec3& vertex) {
    std::size_t at = hash_of(vertex) & (table_.size() - 1);
    while (table_[at] != kFree && vertices_[table_[at]] != vertex) {
      at = (at + 1) & (table_.size() - 1);
    }
    return table_[at];
  }

  void grow() {
    table_.assign(2 * table_.size(), kFree);
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) slot_of(vertices_[i]) = i;
  }

  std::vector<Vec3>& vertices_;
  // Hash table of indices; its size is a power of two, at most half full.
  std::vector<std::uint32_t> table_;
};

/// A place for messages, as "(1, 2.5, 0)".
std::string shown_place(const Vec3& place);

/// A polygon cut into triangles.
struct CutPolygon {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of corners within the polygon
  double bend = 0;  ///< distance of the farthest corner from the plane through the corners' mean
  bool crossing = false;  ///< whether the outline crosses itself, so that the cut is arbitrary
};

/// Most corners of a polygon that is not a fan; more would take too long.
inline constexpr std::size_t kMostCornersToCut = 1024;
/// Most corners of any face.
inline constexpr std::size_t kMostCorners = 1'000'000;

/// Whether all triangles of the fan about the first corner turn the same way.
bool is_fan(std::span<const Vec3> corners);

/// Cuts a polygon with three corners or more into triangles: a fan where is_fan(), otherwise ears,
/// in the projection along the axis in which its normal is largest. Polygons cut into ears may have
/// at most kMostCornersToCut corners. Source: G. Meisters, Polygons have ears, 1975.
CutPolygon cut_polygon(std::span<const Vec3> corners);

/// Collects the vertices, faces, lines and single points of a file, and refuses what cannot be part
/// of a mesh. Memory grows with what is added, never with what a file declares.
class MeshBuilder {
 public:
  /// name: the file's, for messages.
  explicit MeshBuilder(std::string name) : name_(std::move(name)) {}
  MeshBuilder(const MeshBuilder&) = delete;
  MeshBuilder& operator=(const MeshBuilder&) = delete;

  std::size_t vertices() const { return file_.mesh.vertices.size(); }
  MeshRemarks& remarks() { return file_.remarks; }
  void set_unit(const FileUnit& unit) { file_.unit = unit; }

  /// Adds a vertex. Throws InputError for a coordinate that is not finite.
  void add_vertex(const Vec3& vertex, const FilePlace& at);
  /// Adds a face of three corners or more, given as indices from 0. Throws InputError for other
  /// faces and for an index that no vertex has.
  void add_face(std::span<const std::int64_t> corners, const FilePlace& at);
  /// Adds a line through two vertices or more. Throws InputError for fewer, and for an index that
  /// no vertex has.
  void add_line(std::span<const std::int64_t> vertices, const FilePlace& at);
  void add_point(std::int64_t vertex, const FilePlace& at);
  /// Adds a triangle of a file that repeats positions: equal ones become one vertex. Throws as
  /// add_vertex() does.
  void add_triangle(const std::array<Vec3, 3>& corners, const FilePlace& at);
  MeshFile finish() { return std::move(file_); }

  [[noreturn]] void refuse_at(const FilePlace& at, const std::string& what) const;

 private:
  /// The index of a vertex, once checked; `what` names what refers to it, for messages.
  std::uint32_t checked(std::int64_t vertex, const char* what, const FilePlace& at) const;
  void check_vertex(const Vec3& vertex, const FilePlace& at) const;
  void add_polygon(const FilePlace& at);

  std::string name_;
  MeshFile file_;
  VertexWelder welder_{file_.mesh.vertices};
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> places_;
};

}  // namespace clearway
