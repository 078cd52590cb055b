#include "bench/stand_in_hall.hpp"

#include <array>
#include <cmath>
#include <random>

#include "core/box.hpp"

namespace clearway {
namespace {

using Random = std::mt19937_64;

/// A random point of the surface of a box.
Vec3 on_surface(const Box& box, Random& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 size{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const std::array areas{size.y * size.z, size.x * size.z, size.x * size.y};
  std::discrete_distribution<int> face({areas[0], areas[1], areas[2]});
  const int axis = face(random);
  Vec3 p{};
  for (int k = 0; k < 3; ++k) p[k] = box.lo[k] + size[k] * unit(random);
  p[axis] = unit(random) < 0.5 ? box.lo[axis] : box.hi[axis];
  return p;
}

double path_y(double x) { return 1.5 * std::sin(x / 9); }

std::vector<Box> make_boxes(Random& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Box> boxes{{{-5, -12, 0}, {65, 12, 8}}};
  for (double x = 0; x < 60; x += 1.5) {
    for (const double side : {-1.0, 1.0}) {
      const double gap = 0.2 + 1.4 * unit(random);
      const double near = path_y(x) + side * gap;
      const double far = near + side * (0.6 + unit(random));
      boxes.push_back(
          {{x, std::min(near, far), 0.0}, {x + 0.8, std::max(near, far), 0.5 + 2 * unit(random)}});
    }
  }
  return boxes;
}

}  // namespace

Hall make_hall(std::uint64_t points, std::uint32_t model_points, std::uint32_t poses,
               std::uint64_t seed) {
  Random random(seed);
  std::normal_distribution<double> noise(0, 0.003);
  Hall hall;
  const std::vector<Box> boxes = make_boxes(random);
  std::vector<double> areas;
  for (const Box& box : boxes) {
    const Vec3 s{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
    areas.push_back(s.x * s.y + s.y * s.z + s.x * s.z);
  }
  std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
  for (std::uint64_t i = 0; i < points; ++i) {
    Vec3 p = on_surface(boxes[pick(random)], random);
    for (int k = 0; k < 3; ++k) p[k] += noise(random);
    hall.environment.push_back(p);
  }
  const std::array<Box, 2> body{Box{{-2.3, -0.9, 0.25}, {2.3, 0.9, 1.0}},
                                Box{{-1.5, -0.75, 1.0}, {1.1, 0.75, 1.6}}};
  for (std::uint32_t i = 0; i < model_points; ++i) {
    hall.model.push_back(on_surface(body[i % 3 == 0 ? 1 : 0], random));
  }
  for (std::uint32_t i = 0; i < poses; ++i) {
    const double x = 60.0 * i / poses;
    const double heading = std::atan(1.5 / 9 * std::cos(x / 9));
    const double c = std::cos(heading), s = std::sin(heading);
    hall.poses.push_back({{c, -s, 0, s, c, 0, 0, 0, 1}, {x, path_y(x), 0}});
  }
  return hall;
}

}  // namespace clearway
