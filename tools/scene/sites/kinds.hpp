#pragma once

#include <memory>

#include "scene/scene.hpp"

/// One function makes each kind of scene; make_scene of scene.hpp chooses.
namespace clearway::scene {

std::unique_ptr<const Scene> make_hall(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_plant(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_mine(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_tunnel(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_road(const Sizes& sizes, std::uint64_t seed);

/// Streams of random numbers; the scanner has the streams 1 to 3.
enum Stream : std::uint64_t { kModelStream = 10, kLayoutStream = 11, kShapeStream = 12 };

/// The place of pose `number` of `count` on the way from begin to end, both reached.
inline double along(double begin, double end, std::uint64_t number, std::uint64_t count) {
  if (count < 2) return (begin + end) / 2;
  return begin + (end - begin) * (static_cast<double>(number) / static_cast<double>(count - 1));
}

}  // namespace clearway::scene
