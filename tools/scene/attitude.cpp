#include "scene/attitude.hpp"

#include "scene/vector.hpp"

namespace clearway::scene {

Pose pose_along(const Vec3& position, const Vec3& forward, const Attitude& attitude) {
  const Vec3 ahead = normalised(forward);
  const Vec3 aside = normalised(cross({0, 0, 1}, ahead));
  const Vec3 above = cross(ahead, aside);
  const Vec3 x = normalised(ahead + attitude.yaw * aside + attitude.pitch * above);
  const Vec3 across = aside + attitude.roll * above;
  const Vec3 y = normalised(across - dot(across, x) * x);
  const Vec3 z = cross(x, y);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, {position.x, position.y, position.z}};
}

}  // namespace clearway::scene
