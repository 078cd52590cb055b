#include <algorithm>
#include <cmath>

#include "scene/vehicles/models.hpp"

namespace clearway::scene {
namespace {

constexpr int kSections = 120, kAround = 96;

/// The outline of the body, with x as a share of the length from its middle.
struct Outline {
  CarBodySize size;

  double top(double share) const {
    constexpr double kAt[] = {-0.5, -0.44, -0.36, 0.1, 0.27, 0.46, 0.5};
    constexpr double kHeight[] = {0.55, 0.72, 0.97, 1.0, 0.66, 0.58, 0.42};
    int i = 1;
    while (i < 6 && share > kAt[i]) ++i;
    const double f = (share - kAt[i - 1]) / (kAt[i] - kAt[i - 1]);
    return size.height * (kHeight[i - 1] + f * (kHeight[i] - kHeight[i - 1]));
  }

  double half_width(double share) const {
    const double beyond = std::max(0.0, std::abs(share) - 0.36) / 0.14;
    return size.width / 2 * (1 - 0.14 * beyond * beyond);
  }

  /// The section at a share of the length: a superellipse of exponent 4 over the sills, drawn in
  /// above the belt line.
  std::vector<Vec3> section(double share) const {
    constexpr double kSill = 0.1;
    std::vector<Vec3> out;
    for (int i = 0; i <= kAround; ++i) {
      const SineCosine angle = sine_cosine(kPi * i / kAround);
      const double z = kSill + (top(share) - kSill) * std::sqrt(std::max(0.0, angle.sine));
      const double above_belt = std::max(0.0, z / size.height - 0.6);
      const double y = half_width(share) * (1 - 0.5 * above_belt) *
                       std::sqrt(std::abs(angle.cosine)) * (angle.cosine < 0 ? -1 : 1);
      out.push_back({share * size.length, y, z});
    }
    return out;
  }

  bool is_open(const Vec3& p) const {
    const double x = p.x / size.length, y = std::abs(p.y) / size.width, z = p.z / size.height;
    const bool side = y > 0.33;
    const bool door =
        side && z > 0.16 && z < 0.9 && ((x > -0.04 && x < 0.17) || (x > -0.27 && x < -0.07));
    const bool rear_window = side && z > 0.62 && z < 0.88 && x > -0.37 && x < -0.3;
    const bool windscreen = x > 0.11 && x < 0.255 && y < 0.34 && z > 0.6;
    const bool tailgate = x < -0.4 && y < 0.36;
    return door || rear_window || windscreen || tailgate || in_wheel_arch(p);
  }

  bool in_wheel_arch(const Vec3& p) const {
    const double z = p.z - 0.18, radius = 0.25 * size.height;
    for (const double share : {-0.29, 0.31}) {
      const double x = p.x - share * size.length;
      if (x * x + z * z < radius * radius && std::abs(p.y) > 0.3 * size.width) return true;
    }
    return false;
  }
};

/// Adds the lower structure: frame rails (the lowest parts), sills, cross members, floor and
/// bulkhead.
void add_floor(Mesh& mesh, const CarBodySize& size) {
  const double end = 0.47 * size.length, half = size.width / 2;
  for (const double side : {-1.0, 1.0}) {
    mesh.add_box({-end, side * 0.25 * size.width - 0.06, 0},
                 {end, side * 0.25 * size.width + 0.06, 0.12});
    mesh.add_box({-0.2 * size.length, side * (half - 0.1) - 0.07, 0.03},
                 {0.22 * size.length, side * (half - 0.1) + 0.07, 0.18});
  }
  constexpr int kPlates = 40;
  for (int i = 0; i < kPlates; ++i) {
    const double x0 = -end + 2 * end * i / kPlates, x1 = x0 + 2 * end / kPlates;
    const double z = i % 4 == 0 ? 0.1 : 0.12;
    mesh.add_quad({x0, -0.4 * size.width, z}, {x1, -0.4 * size.width, z}, {x1, 0.4 * size.width, z},
                  {x0, 0.4 * size.width, z});
  }
  for (const double share : {-0.45, -0.3, -0.15, 0.0, 0.12, 0.3, 0.46}) {
    const double x = share * size.length;
    mesh.add_box({x - 0.05, -0.42 * size.width, 0.05}, {x + 0.05, 0.42 * size.width, 0.2});
  }
  const double bulkhead = 0.23 * size.length;
  mesh.add_quad({bulkhead, -0.42 * size.width, 0.1}, {bulkhead, 0.42 * size.width, 0.1},
                {bulkhead, 0.4 * size.width, 0.6 * size.height},
                {bulkhead, -0.4 * size.width, 0.6 * size.height});
}

void add_cross_parts(Mesh& mesh, const CarBodySize& size) {
  const double front = 0.48 * size.length, width = size.width;
  mesh.add_box({front, -0.4 * width, 0.25}, {front + 0.08, 0.4 * width, 0.38});
  mesh.add_box({front - 0.1, -0.36 * width, 0.5}, {front - 0.04, 0.36 * width, 0.56});
  mesh.add_box({-0.49 * size.length, -0.4 * width, 0.15},
               {-0.47 * size.length, 0.4 * width, 0.5 * size.height});
  mesh.add_box({0.17 * size.length, -0.42 * width, 0.58 * size.height},
               {0.19 * size.length, 0.42 * width, 0.64 * size.height});
  mesh.add_quad({-0.28 * size.length, -0.38 * width, 0.25},
                {-0.12 * size.length, -0.38 * width, 0.3}, {-0.12 * size.length, 0.38 * width, 0.3},
                {-0.28 * size.length, 0.38 * width, 0.25});
}

}  // namespace

Mesh car_body(const CarBodySize& size) {
  const Outline outline{size};
  std::vector<std::vector<Vec3>> sections;
  for (int i = 0; i <= kSections; ++i) {
    sections.push_back(outline.section(static_cast<double>(i) / kSections - 0.5));
  }
  Mesh mesh;
  mesh.add_skin(sections, [&](const Vec3& p) { return outline.is_open(p); });
  add_floor(mesh, size);
  add_cross_parts(mesh, size);
  return mesh;
}

}  // namespace clearway::scene
