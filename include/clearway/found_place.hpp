#pragma once

#include <cstdint>
#include <optional>

#include "clearway/vec3.hpp"

namespace clearway {

/// An environment point of the answer, and the pose that it belongs to.
struct FoundPlace {
  std::uint64_t source = 0;
  std::uint32_t pose = 0;
  Vec3 xyz{};
  double distance = 0;     ///< metres, if a distance was asked for
  std::uint32_t body = 0;  ///< index of the body, in queries with bodies; not set for a profile
  /// Class of the point, as the scans have it; nullopt unless they have classes.
  std::optional<std::uint8_t> point_class = {};
  friend bool operator==(const FoundPlace&, const FoundPlace&) = default;
};

}  // namespace clearway
