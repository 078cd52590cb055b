#include "cpu/range_kernels.hpp"

#include "core/geometry/predicate.hpp"
#include "core/util/macros.hpp"

namespace clearway {

CLEARWAY_SIMD_CLONES
void squared_distances(Columns points, std::size_t count, const Vec3& m,
                       double* __restrict squared) {
  const double* __restrict x = points.x;
  const double* __restrict y = points.y;
  const double* __restrict z = points.z;
  const Vec3 centre = m;
  for (std::size_t i = 0; i < count; ++i) {
    squared[i] = squared_distance({x[i], y[i], z[i]}, centre);
  }
}

CLEARWAY_SIMD_CLONES
void transform_points(const Pose& pose, Columns model, std::size_t count, MutableColumns moved) {
  const Pose local = pose;
  double* __restrict x = moved.x;
  double* __restrict y = moved.y;
  double* __restrict z = moved.z;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 m = transform(local, {model.x[i], model.y[i], model.z[i]});
    x[i] = m.x;
    y[i] = m.y;
    z[i] = m.z;
  }
}

CLEARWAY_SIMD_CLONES
void collide_any(Columns environment, std::size_t count, Columns moved, std::size_t moved_count,
                 double radius, std::uint8_t* __restrict hit) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 e{environment.x[i], environment.y[i], environment.z[i]};
    std::int64_t any = 0;
    for (std::size_t j = 0; j < moved_count; ++j) {
      any |= collides(e, {moved.x[j], moved.y[j], moved.z[j]}, radius) ? 1 : 0;
    }
    hit[i] = static_cast<std::uint8_t>(any);
  }
}

}  // namespace clearway
