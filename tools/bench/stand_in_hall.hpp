#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "core/vec3.hpp"

namespace clearway {

struct Hall {
  std::vector<Vec3> environment, model;
  std::vector<Pose> poses;
};

/// A hall of 70 x 24 x 8 m with machines along a 60 m path of a hollow car body, for measurements
/// without files.
Hall make_hall(std::uint64_t points, std::uint32_t model_points, std::uint32_t poses,
               std::uint64_t seed);

}  // namespace clearway
