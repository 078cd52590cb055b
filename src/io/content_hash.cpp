#include "io/content_hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>

namespace clearway {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Pose) == 12 * sizeof(double));

std::uint64_t hash_of_model(std::span<const Vec3> points) {
  return XXH64(points.data(), points.size_bytes(), 0);
}

std::uint64_t hash_of_trajectory(std::span<const Pose> poses) {
  return XXH64(poses.data(), poses.size_bytes(), 0);
}

}  // namespace clearway
