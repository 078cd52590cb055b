#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/geometry/predicate.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/models/surface_of.hpp"

namespace clearway {

/// A triangle laid flat: its longest side from (0, 0) to (length, 0), the third corner at (foot,
/// height), 0 <= foot <= length. Distances are those in space, up to rounding.
class TriangleFrame {
 public:
  TriangleFrame(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double ab = squared_distance(a, b), bc = squared_distance(b, c),
                 ca = squared_distance(c, a);
    const bool first = ab >= bc && ab >= ca;
    const bool second = !first && bc >= ca;
    origin_ = first ? a : second ? b : c;
    const Vec3& end = first ? b : second ? c : a;
    const Vec3& apex = first ? c : second ? a : b;
    along_ = difference(end, origin_);
    up_ = difference(apex, origin_);
    length = std::sqrt(rounded_dot(along_, along_));
    if (!(length > 0)) return;
    const Vec3 normal{along_.y * up_.z - along_.z * up_.y, along_.z * up_.x - along_.x * up_.z,
                      along_.x * up_.y - along_.y * up_.x};
    height = std::sqrt(rounded_dot(normal, normal)) / length;
    foot = std::clamp(rounded_dot(along_, up_) / length, 0.0, length);
  }

  /// Makes the triangle its longest side alone.
  void flatten() { height = 0; }

  /// The position in space of a place in or near the triangle.
  Vec3 in_space(const FlatPlace& place) const {
    const double t = height > 0 ? place.y / height : 0;
    return combined((place.x - foot * t) / length, t);
  }

  /// The position in space of the triangle's place nearest to a place at a height from 0 to
  /// `height`. It is a combination of the corners with weights from 0 to 1.
  Vec3 nearest_in_space(const FlatPlace& place) const {
    const double t = height > 0 ? std::clamp(place.y / height, 0.0, 1.0) : 0;
    const double s = (place.x - foot * t) / length;
    if (height == 0) return combined(std::clamp(s, 0.0, 1.0), 0);
    if (s >= 0 && s + t <= 1) return combined(s, t);
    const double left = part_of_side(place, {0, 0});
    const double right = part_of_side(place, {length, 0});
    if (s < 0) return combined(0, left);
    return combined(1 - right, right);
  }

  /// The greatest distance of a place of the triangle from its nearest corner; requires height > 0.
  double corner_distance() const {
    const double left = std::hypot(foot, height), right = std::hypot(length - foot, height);
    if (left * left + right * right > length * length) return left * right / (2 * height);
    return std::max(left * left / (2 * foot), right * right / (2 * (length - foot)));
  }

  double length = 0, height = 0, foot = 0;

 private:
  Vec3 combined(double s, double t) const {
    return {origin_.x + s * along_.x + t * up_.x, origin_.y + s * along_.y + t * up_.y,
            origin_.z + s * along_.z + t * up_.z};
  }

  /// Position of the nearest place on the side from `end` to the third corner, from 0 to 1.
  double part_of_side(const FlatPlace& place, const FlatPlace& end) const {
    const double x = foot - end.x;
    const double dot = (place.x - end.x) * x + (place.y - end.y) * height;
    return std::clamp(dot / (x * x + height * height), 0.0, 1.0);
  }

  Vec3 origin_{}, along_{}, up_{};  ///< a corner, and the vectors from it to the other two
};

/// Distances of points to their nearest neighbours, metres.
struct PointGaps {
  double median = 0, largest = 0;
  std::uint64_t repeated = 0;  ///< number of points at the place of another one, which are left out
};

/// The gaps of points; zeros for fewer than two places.
PointGaps gaps_of(std::span<const Vec3> points);

inline constexpr std::uint64_t kMostSamples = 50'000'000;
inline constexpr double kLeastSpacing = 1e-9, kLargestSpacing = 1e9;  // metres

/// Points on a mesh's surface such that no place of it is farther than `spacing` from the nearest:
/// the vertices of its triangles, followed by the other points that are needed. Each lies on its
/// triangle up to an error of 2^-48 of the largest coordinate. The same mesh gives the same points
/// in the same order. Throws InputError, which begins with `name`, where more than kMostSamples are
/// needed, and for a spacing too fine for the size of the coordinates.
std::vector<Vec3> sample_mesh(const TriangleMesh& mesh, double spacing, const std::string& name);

/// Greatest distance of a place of the triangles from the nearest vertex of its own triangle,
/// metres.
double distance_to_vertices(const TriangleMesh& mesh);

/// A spacing that gives about this many samples besides the vertices, and is never refused.
double spacing_for(const TriangleMesh& mesh, double samples);

/// About this many points on a mesh's surface besides its vertices, for drawing.
inline std::vector<Vec3> drawn_points(const TriangleMesh& mesh, double samples) {
  return sample_mesh(mesh, spacing_for(mesh, samples), "the model");
}

}  // namespace clearway
