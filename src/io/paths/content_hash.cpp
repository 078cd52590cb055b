#include "io/paths/content_hash.hpp"

#include <bit>

#include "io/files/xxh64.hpp"

namespace clearway {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Pose) == 12 * sizeof(double));

std::uint64_t hash_of_model(const Model& model) {
  Xxh64Stream hash;
  hash.update(std::as_bytes(std::span(model.vertices)));
  hash.update(std::as_bytes(std::span(model.triangles)));
  hash.update(std::as_bytes(std::span(model.solid_of)));
  return hash.digest();
}

std::uint64_t hash_of_trajectory(std::span<const Pose> poses) {
  return xxh64(std::as_bytes(poses));
}

std::uint64_t hash_of_bodies(std::span<const Body> bodies) {
  std::vector<std::uint64_t> models;
  for (const Body& body : bodies) models.push_back(hash_of_model(body.model));
  return hash_of_bodies(bodies, models);
}

std::uint64_t hash_of_bodies(std::span<const Body> bodies, std::span<const std::uint64_t> models) {
  Xxh64Stream hash;
  const auto add = [&hash](std::uint64_t number) {
    hash.update(std::as_bytes(std::span(&number, 1)));
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    add(body.name.size());
    hash.update(std::as_bytes(std::span(body.name)));
    add(models[i]);
    add(body.path_pose.size());
    hash.update(std::as_bytes(std::span(body.path_pose)));
    add(hash_of_trajectory(body.poses));
    if (body.floor) add(std::bit_cast<std::uint64_t>(*body.floor));
  }
  return hash.digest();
}

}  // namespace clearway
