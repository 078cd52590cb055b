#include "io/models/mesh/mesh_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

struct PlanePlace {
  double x, y;
};

/// Normal of the triangle (0, i, i + 1), as long as twice its area.
Vec3 fan_normal(std::span<const Vec3> corners, std::size_t i) {
  const Vec3 u = difference(corners[i], corners[0]), v = difference(corners[i + 1], corners[0]);
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

double norm_of(const Vec3& v) { return std::hypot(v.x, v.y, v.z); }

/// The sum of the fan's normals, which does not depend on the order of the corners. Where they
/// cancel because the outline crosses itself, the largest of them.
Vec3 polygon_normal(std::span<const Vec3> corners) {
  constexpr double kCancelled = 1e-9;
  Vec3 sum{0, 0, 0}, largest{0, 0, 0};
  double lengths = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 normal = fan_normal(corners, i);
    for (int k = 0; k < 3; ++k) sum[k] += normal[k];
    lengths += norm_of(normal);
    if (norm_of(normal) > norm_of(largest)) largest = normal;
  }
  return norm_of(sum) > kCancelled * lengths ? sum : largest;
}

/// The corners projected along the normal's largest axis, counter-clockwise, relative to the first
/// corner.
std::vector<PlanePlace> projected(std::span<const Vec3> corners, const Vec3& normal) {
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  }
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool turned = normal[axis] < 0;
  std::vector<PlanePlace> places;
  places.reserve(corners.size());
  for (const Vec3& corner : corners) {
    const double x = corner[u] - corners[0][u], y = corner[v] - corners[0][v];
    places.push_back(turned ? PlanePlace{y, x} : PlanePlace{x, y});
  }
  return places;
}

/// Twice the signed area of a, b, c: above 0 where they turn left.
double turn(const PlanePlace& a, const PlanePlace& b, const PlanePlace& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_fan(const std::vector<PlanePlace>& places) {
  for (std::size_t i = 1; i + 1 < places.size(); ++i) {
    if (!(turn(places[0], places[i], places[i + 1]) >= 0)) return false;
  }
  return true;
}

/// Whether two sides cross in the interior of both. Takes time quadratic in the number of corners.
bool crosses_itself(const std::vector<PlanePlace>& places) {
  const std::size_t count = places.size();
  for (std::size_t i = 0; i + 2 < count; ++i) {
    const PlanePlace &a = places[i], &b = places[i + 1];
    for (std::size_t k = i + 2; k < count; ++k) {
      const PlanePlace &c = places[k], &d = places[(k + 1) % count];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
    }
  }
  return false;
}

double bend_of(std::span<const Vec3> corners, const Vec3& normal) {
  const double length = norm_of(normal);
  if (!(length > 0) || !std::isfinite(length)) return 0;
  Vec3 mean{0, 0, 0};
  const auto count = static_cast<double>(corners.size());
  for (const Vec3& corner : corners) {
    for (int k = 0; k < 3; ++k) mean[k] += corner[k] / count;
  }
  double bend = 0;
  for (const Vec3& corner : corners) {
    double height = 0;
    for (int k = 0; k < 3; ++k) height += (corner[k] - mean[k]) * (normal[k] / length);
    bend = std::max(bend, std::abs(height));
  }
  return bend;
}

void cut_fan(std::size_t corners, CutPolygon& cut) {
  cut.triangles.clear();
  for (std::uint32_t i = 1; i + 1 < corners; ++i) cut.triangles.push_back({0, i, i + 1});
}

/// The rest of a polygon from which ears are cut. Only the neighbours of a corner that was cut are
/// tested again, so the time is quadratic in the number of corners.
class EarCutter {
 public:
  explicit EarCutter(const std::vector<PlanePlace>& places) : places_(places) {
    const auto count = static_cast<std::uint32_t>(places.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      next_.push_back((i + 1) % count);
      before_.push_back((i + count - 1) % count);
    }
    for (std::uint32_t i = 0; i < count; ++i) ear_.push_back(is_ear(i));
  }

  /// Cuts ears until nothing is left; returns false where no ear is left because the outline
  /// crosses itself.
  bool cut(CutPolygon& cut) {
    std::uint32_t at = 0, looked_at = 0;
    for (std::size_t left = places_.size(); left > 3;) {
      if (!ear_[at]) {
        if (++looked_at > left) return false;
        at = next_[at];
        continue;
      }
      looked_at = 0;
      cut.triangles.push_back({before_[at], at, next_[at]});
      at = take_out(at);
      --left;
    }
    cut.triangles.push_back({before_[at], at, next_[at]});
    return true;
  }

 private:
  /// Removes a corner and returns the next one.
  std::uint32_t take_out(std::uint32_t corner) {
    const std::uint32_t before = before_[corner], next = next_[corner];
    next_[before] = next;
    before_[next] = before;
    ear_[before] = is_ear(before);
    ear_[next] = is_ear(next);
    return next;
  }

  bool is_ear(std::uint32_t corner) const {
    const PlanePlace& a = places_[before_[corner]];
    const PlanePlace& b = places_[corner];
    const PlanePlace& c = places_[next_[corner]];
    if (!(turn(a, b, c) >= 0)) return false;
    for (std::uint32_t i = next_[next_[corner]]; i != before_[corner]; i = next_[i]) {
      const PlanePlace& p = places_[i];
      const bool on_corner = same(p, a) || same(p, b) || same(p, c);
      if (!on_corner && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) {
        return false;
      }
    }
    return true;
  }

  static bool same(const PlanePlace& a, const PlanePlace& b) { return a.x == b.x && a.y == b.y; }

  const std::vector<PlanePlace>& places_;
  std::vector<std::uint32_t> next_, before_;
  std::vector<bool> ear_;
};

}  // namespace

std::string shown_place(const Vec3& place) {
  return "(" + format_number(place.x) + ", " + format_number(place.y) + ", " +
         format_number(place.z) + ")";
}

bool is_fan(std::span<const Vec3> corners) {
  return is_fan(projected(corners, polygon_normal(corners)));
}

CutPolygon cut_polygon(std::span<const Vec3> corners) {
  CutPolygon cut;
  if (corners.size() == 3) {
    cut.triangles = {{0, 1, 2}};
    return cut;
  }
  const Vec3 normal = polygon_normal(corners);
  cut.bend = bend_of(corners, normal);
  const std::vector<PlanePlace> places = projected(corners, normal);
  if (is_fan(places)) {
    cut_fan(corners.size(), cut);
    return cut;
  }
  cut.crossing = crosses_itself(places);
  if (!EarCutter(places).cut(cut)) {
    cut.crossing = true;
    cut_fan(corners.size(), cut);
  }
  return cut;
}

void MeshBuilder::refuse_at(const FilePlace& at, const std::string& what) const {
  refuse(name_, at.text() + ": " + what);
}

void MeshBuilder::check_vertex(const Vec3& vertex, const FilePlace& at) const {
  if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
    refuse_at(at, "vertex " + shown_place(vertex) + "; expected finite coordinates");
  }
  if (vertices() > std::numeric_limits<std::uint32_t>::max() - 1) {
    refuse_at(at, "more than 4,294,967,295 vertices; expected fewer");
  }
}

void MeshBuilder::add_vertex(const Vec3& vertex, const FilePlace& at) {
  check_vertex(vertex, at);
  file_.mesh.vertices.push_back(vertex);
}

void MeshBuilder::add_triangle(const std::array<Vec3, 3>& corners, const FilePlace& at) {
  std::array<std::uint32_t, 3> triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    check_vertex(corners[i], at);
    triangle[i] = welder_.number_of(corners[i]);
  }
  file_.mesh.triangles.push_back(triangle);
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
