#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/path.hpp"
#include "scene/scanning/roughness.hpp"
#include "scene/vector.hpp"

namespace clearway::scene {

/// One side of the room around the path: inside is normal_v * v + normal_w * w < distance.
struct Wall {
  double normal_v, normal_w, distance;
  Roughness rough{};
};

/// The convex cross-section of the room from an arc length on. A ray may leave an open room, but
/// not downwards.
struct Room {
  double begin_s;
  std::vector<Wall> walls;
  bool open = false;
};

/// An upright solid beside the path: a box turned about the vertical or, when round, a cylinder. It
/// is given in path coordinates, so it bends with the path.
struct Prism {
  double s, v;                     ///< centre
  double half_length, half_width;  ///< along and across; both the radius when round
  double bottom, top;              ///< heights
  SineCosine turn{0, 1};
  bool round = false;
  Roughness rough{};
};

inline Prism box(double s, double v, double half_length, double half_width, double bottom,
                 double top, Roughness rough = {}) {
  return {s, v, half_length, half_width, bottom, top, {0, 1}, false, rough};
}
inline Prism pole(double s, double v, double radius, double bottom, double top,
                  Roughness rough = {}) {
  return {s, v, radius, radius, bottom, top, {0, 1}, true, rough};
}

/// All that a scanner may see, in path coordinates.
class World {
 public:
  explicit World(std::vector<Room> rooms) : rooms_(std::move(rooms)) {}

  void add(const Prism& prism) { prisms_.push_back(prism); }
  /// Adds a box along the whole path.
  void add_everywhere(double left, double right, double bottom, double top, Roughness rough = {});
  /// Sorts the prisms for prisms_near. Those near the seam of a closed path are repeated on both
  /// sides.
  void finish(const Path& path, double reach);

  std::span<const Room> rooms() const { return rooms_; }
  const Room& room_at(double s) const;
  /// The prisms whose centres lie within reach + their own radius of s (and maybe others).
  std::span<const Prism> prisms_near(double s, double reach) const;
  std::span<const Prism> prisms_everywhere() const { return everywhere_; }

 private:
  std::vector<Room> rooms_;
  std::vector<Prism> prisms_;
  std::vector<Prism> everywhere_;
  double greatest_radius_ = 0;
};

}  // namespace clearway::scene
