#include "scene/scene.hpp"

#include "clearway/error.hpp"
#include "scene/sites/kinds.hpp"
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

namespace {

struct Entry {
  std::string_view name;
  Sizes full_sizes;
  std::unique_ptr<const Scene> (*make)(const Sizes& sizes, std::uint64_t seed);
};

/// In the order of Kind.
constexpr Entry kEntries[] = {{"hall", {55872714, 214489, 17234}, make_hall},
                              {"plant", {350109065, 434700, 398999}, make_plant},
                              {"mine", {806183400, 100000, 17795}, make_mine},
                              {"tunnel", {18919000, 28622, 19392}, make_tunnel},
                              {"road", {20000000, 100000, 4000}, make_road}};

const Entry& entry_of(Kind kind) { return kEntries[static_cast<int>(kind)]; }

}  // namespace

std::string_view name_of(Kind kind) { return entry_of(kind).name; }

Kind kind_named(std::string_view name) {
  for (const Kind kind : kAllKinds) {
    if (name_of(kind) == name) return kind;
  }
  throw UsageError("no such scene: " + std::string(name));
}

Sizes full_sizes(Kind kind) { return entry_of(kind).full_sizes; }

std::unique_ptr<const Scene> make_scene(Kind kind, const Sizes& sizes, std::uint64_t seed) {
  if (sizes.points == 0 || sizes.model_points == 0 || sizes.poses == 0) {
    throw UsageError("a scene needs at least one environment point, model point and pose");
  }
  return entry_of(kind).make(sizes, seed);
}

}  // namespace clearway::scene
