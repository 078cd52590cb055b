#include "scene/vehicles/vehicles.hpp"

#include <algorithm>
#include <cmath>

#include "scene/scene.hpp"

namespace clearway::scene {
namespace {

/// A superellipse of exponent 4 over the floor, from left to right, with its width at each height
/// times narrowed(height).
template <typename Narrowed>
std::vector<Vec3> hoop(int steps, const Vec3& floor, double half_width, double top,
                       Narrowed narrowed) {
  std::vector<Vec3> out;
  for (int i = 0; i <= steps; ++i) {
    const SineCosine angle = sine_cosine(kPi * i / steps);
    const double z = floor.z + (top - floor.z) * std::sqrt(std::max(0.0, angle.sine));
    const double y = half_width * narrowed(z) * std::sqrt(std::abs(angle.cosine));
    out.push_back({floor.x, angle.cosine < 0 ? -y : y, z});
  }
  return out;
}

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

  /// The section at a share of the length, drawn in above the belt line.
  std::vector<Vec3> section(double share) const {
    return hoop(96, {share * size.length, 0, 0.1}, half_width(share), top(share),
                [&](double z) { return 1 - 0.5 * std::max(0.0, z / size.height - 0.6); });
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

/// Adds the bucket, which slopes down towards the cutting edge and is open to the front.
void add_bucket(Mesh& mesh) {
  const double back = 3.1, edge = 4.8, half = 1.3;
  mesh.add_quad({back, -half, 0.45}, {edge, -half, 0.2}, {edge, half, 0.2}, {back, half, 0.45});
  mesh.add_quad({back, -half, 0.45}, {back, half, 0.45}, {back - 0.15, half, 1.5},
                {back - 0.15, -half, 1.5});
  mesh.add_quad({back - 0.15, -half, 1.5}, {back - 0.15, half, 1.5}, {back + 0.35, half, 1.75},
                {back + 0.35, -half, 1.75});
  for (const double y : {-half, half}) {
    mesh.add_quad({back, y, 0.45}, {edge, y, 0.2}, {edge - 0.5, y, 0.9}, {back + 0.3, y, 1.7});
  }
  for (int tooth = -4; tooth <= 4; ++tooth) {
    const double y = 0.3 * tooth;
    mesh.add_box({edge, y - 0.05, 0.17}, {edge + 0.15, y + 0.05, 0.24});
  }
}

void add_frame_and_cab(Mesh& mesh) {
  mesh.add_box({-4.65, -1.15, 0.75}, {-1.0, 1.15, 1.65});  // engine
  mesh.add_box({-4.4, -0.85, 1.65}, {-1.4, 0.85, 1.85});   // its hood
  mesh.add_box({-4.65, -0.6, 0.4}, {-0.9, 0.6, 0.75});     // rear frame
  mesh.add_box({-0.9, -0.25, 0.5}, {0.4, 0.25, 1.2});      // joint
  mesh.add_box({0.3, -0.75, 0.45}, {2.6, 0.75, 1.3});      // front frame
  mesh.add_box({-1.3, 0.3, 1.1}, {0.0, 1.25, 2.2});        // cab
  mesh.add_box({-1.35, 0.25, 2.2}, {0.05, 1.3, 2.28});     // its roof
  for (const double side : {-1.0, 1.0}) {
    mesh.add_box({-4.1, side * 1.0 - 0.2, 1.45}, {-2.2, side * 1.0 + 0.2, 1.6});  // mudguards
    mesh.add_box({0.9, side * 0.45 - 0.1, 1.2}, {2.9, side * 0.45 + 0.1, 1.55});  // boom
  }
}

constexpr double kHalfLength = 12.5, kHalfWidth = 1.4, kFloor = 0.95, kRoof = 3.9;

std::vector<Vec3> section(double x) {
  const double beyond = std::max(0.0, std::abs(x) - 11.8) / 0.7;
  return hoop(64, {x, 0, kFloor}, kHalfWidth * (1 - 0.12 * beyond * beyond), kRoof,
              [](double) { return 1.0; });
}

/// Whether a window is there; windows of 1.2 m lie every 1.8 m.
bool is_window(const Vec3& p) {
  const double along = p.x / 1.8 - std::floor(p.x / 1.8);
  return std::abs(p.x) < 9 && std::abs(p.y) > 1.1 && p.z > 2.0 && p.z < 2.9 && along < 0.66;
}

void add_body(Mesh& mesh) {
  mesh.add_skin(
      150, [](int i) { return section(kHalfLength * (2.0 * i / 150 - 1)); }, is_window);
  for (const double x : {-kHalfLength, kHalfLength}) {
    mesh.add_quad({x, -1.2, kFloor}, {x, 1.2, kFloor}, {x, 1.2, 3.5}, {x, -1.2, 3.5});
  }
  mesh.add_quad({-kHalfLength, -1.38, kFloor}, {kHalfLength, -1.38, kFloor},
                {kHalfLength, 1.38, kFloor}, {-kHalfLength, 1.38, kFloor});
}

void add_bogie(Mesh& mesh, double pivot) {
  constexpr double kHalfBase = 1.25, kWheel = 0.46, kHalfGauge = 0.75;
  for (const double x : {pivot - kHalfBase, pivot + kHalfBase}) {
    for (const double y : {-kHalfGauge, kHalfGauge}) mesh.add_wheel({x, y, kWheel}, kWheel, 0.13);
    mesh.add_box({x - 0.08, -0.75, kWheel - 0.08}, {x + 0.08, 0.75, kWheel + 0.08});
    mesh.add_box({x - 0.5, -0.7, 0.1}, {x + 0.5, 0.7, 0.3});  // brake gear
  }
  for (const double side : {-1.0, 1.0}) {
    mesh.add_box({pivot - 1.7, side * 1.0 - 0.12, 0.4}, {pivot + 1.7, side * 1.0 + 0.12, 0.75});
    mesh.add_box({pivot - 0.55, side * kHalfGauge - 0.07, 0.08},
                 {pivot + 0.55, side * kHalfGauge + 0.07, 0.2});  // track brakes
  }
}

void add_underframe(Mesh& mesh) {
  mesh.add_box({-7.5, -1.25, 0.35}, {-4.2, 1.25, kFloor});
  mesh.add_box({-3.4, -1.25, 0.4}, {0.2, -0.2, kFloor});
  mesh.add_box({-2.8, 0.3, 0.4}, {2.4, 1.25, kFloor});
  mesh.add_box({3.2, -1.25, 0.35}, {7.2, 1.25, kFloor});
  for (const double x : {-8.3, 8.3}) {  // steps
    for (const double y : {-1.45, 1.45})
      mesh.add_box({x - 0.4, y - 0.15, 0.45}, {x + 0.4, y + 0.1, 0.5});
  }
}

}  // namespace

Mesh car_body(const CarBodySize& size) {
  const Outline outline{size};
  Mesh mesh;
  mesh.add_skin(
      120, [&](int i) { return outline.section(i / 120.0 - 0.5); },
      [&](const Vec3& p) { return outline.is_open(p); });
  add_floor(mesh, size);
  add_cross_parts(mesh, size);
  return mesh;
}

Mesh front_loader() {
  Mesh mesh;
  for (const double x : {-3.0, 1.7}) {
    for (const double y : {-0.92, 0.92}) mesh.add_wheel({x, y, 0.82}, 0.82, 0.62);
    mesh.add_box({x - 0.2, -0.6, 0.55}, {x + 0.2, 0.6, 1.0});
  }
  add_frame_and_cab(mesh);
  add_bucket(mesh);
  return mesh;
}

Mesh train_wagon() {
  Mesh mesh;
  add_body(mesh);
  add_underframe(mesh);
  for (const double side : {-0.5, 0.5}) add_bogie(mesh, side * kBogieDistance);
  return mesh;
}

Mesh lorry() {
  Mesh mesh;
  mesh.add_box({3.6, -1.25, 0.45}, {6, 1.25, 3.2});    // cab
  mesh.add_box({-6, -1.25, 0.9}, {3.4, 1.25, 1.2});    // bed
  mesh.add_box({-5.6, -0.5, 0.6}, {4.2, 0.5, 0.9});    // frame
  mesh.add_box({-5.5, -1.45, 1.2}, {3.1, 1.45, 4.0});  // load
  mesh.add_box({4.6, -1.55, 2.0}, {4.8, -1.25, 2.4});  // mirrors
  mesh.add_box({4.6, 1.25, 2.0}, {4.8, 1.55, 2.4});
  return mesh;
}

}  // namespace clearway::scene
