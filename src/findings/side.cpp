#include "findings/side.hpp"

#include <array>
#include <limits>

namespace clearway {
namespace {

int line_of(Axis axis) { return static_cast<int>(axis) / 2; }

Vec3 direction_of(Axis axis) {
  Vec3 out{0, 0, 0};
  out[line_of(axis)] = static_cast<int>(axis) % 2 == 0 ? 1 : -1;
  return out;
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// By Cramer's rule: rotations from text are not quite orthonormal.
Vec3 in_model_frame(const Vec3& place, const Pose& pose) {
  const double* r = pose.rotation;
  const double* p = pose.translation;
  const Vec3 from{place.x - p[0], place.y - p[1], place.z - p[2]};
  const Vec3 x{r[0], r[3], r[6]}, y{r[1], r[4], r[7]}, z{r[2], r[5], r[8]};
  const double volume = dot(x, cross(y, z));
  return {dot(from, cross(y, z)) / volume, dot(x, cross(from, z)) / volume,
          dot(x, cross(y, from)) / volume};
}

/// How far a place is beyond the box in a direction along an axis; negative inside.
double beyond(const Vec3& place, const Box& box, const Vec3& direction) {
  for (int k = 0; k < 3; ++k) {
    if (direction[k] > 0) return place[k] - box.hi[k];
    if (direction[k] < 0) return box.lo[k] - place[k];
  }
  return 0;
}

Vec3 opposite(const Vec3& v) { return {-v.x, -v.y, -v.z}; }

}  // namespace

const char* name_of(Side side) {
  switch (side) {
    case Side::kUnknown:
      return "unknown";
    case Side::kLeft:
      return "left";
    case Side::kRight:
      return "right";
    case Side::kAbove:
      return "above";
    case Side::kBelow:
      return "below";
    case Side::kFront:
      return "front";
    case Side::kBehind:
      return "behind";
  }
  return "";
}

bool along_one_line(Axis a, Axis b) { return line_of(a) == line_of(b); }

Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up) {
  const Vec3 there = in_model_frame(place, pose);
  const Vec3 ahead = direction_of(forward), above = direction_of(up);
  return {dot(there, ahead), dot(there, cross(above, ahead)), dot(there, above)};
}

Side side_of(const Vec3& place, const Pose& pose, const Box& model, Axis forward, Axis up) {
  const Vec3 there = in_model_frame(place, pose);
  const Vec3 ahead = direction_of(forward), above = direction_of(up);
  const Vec3 left = cross(above, ahead);
  const std::array<std::pair<Side, Vec3>, 6> sides{{{Side::kLeft, left},
                                                    {Side::kRight, opposite(left)},
                                                    {Side::kAbove, above},
                                                    {Side::kBelow, opposite(above)},
                                                    {Side::kFront, ahead},
                                                    {Side::kBehind, opposite(ahead)}}};
  Side side = Side::kUnknown;
  double farthest = -std::numeric_limits<double>::infinity();
  for (const auto& [name, direction] : sides) {
    const double far = beyond(there, model, direction);
    if (far > farthest) {
      farthest = far;
      side = name;
    }
  }
  return side;
}

}  // namespace clearway
