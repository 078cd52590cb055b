#pragma once

#include <cstddef>
#include <cstdint>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

/// The inner loops of range searches, compiled for several vector widths. They round as the
/// predicate does, because they are the predicate, over columns.
namespace clearway {

/// Coordinates of points by axis, metres. A view that does not own them.
struct Columns {
  const double* x;
  const double* y;
  const double* z;
};

/// Coordinates of points by axis to write to, metres. A view that does not own them.
struct MutableColumns {
  double* x;
  double* y;
  double* z;

  operator Columns() const { return {x, y, z}; }
};

/// squared[i] = d2 between point i and m.
void squared_distances(Columns points, std::size_t count, const Vec3& m, double* squared);

/// moved[i] = transform(pose, model point i).
void transform_points(const Pose& pose, Columns model, std::size_t count, MutableColumns moved);

/// hit[i] = 1 if environment point i collides with any of the moved model points, otherwise 0.
void collide_any(Columns environment, std::size_t count, Columns moved, std::size_t moved_count,
                 double radius, std::uint8_t* hit);

}  // namespace clearway
