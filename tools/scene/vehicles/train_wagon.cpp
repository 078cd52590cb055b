#include <algorithm>
#include <cmath>

#include "scene/scene.hpp"
#include "scene/vehicles/models.hpp"

namespace clearway::scene {
namespace {

constexpr double kHalfLength = 12.5, kHalfWidth = 1.4, kFloor = 0.95, kRoof = 3.9;

std::vector<Vec3> section(double x) {
  constexpr int kSteps = 64;
  const double beyond = std::max(0.0, std::abs(x) - 11.8) / 0.7;
  const double half = kHalfWidth * (1 - 0.12 * beyond * beyond);
  std::vector<Vec3> out;
  for (int i = 0; i <= kSteps; ++i) {
    const SineCosine angle = sine_cosine(kPi * i / kSteps);
    const double y = half * std::sqrt(std::abs(angle.cosine)) * (angle.cosine < 0 ? -1 : 1);
    out.push_back({x, y, kFloor + (kRoof - kFloor) * std::sqrt(std::max(0.0, angle.sine))});
  }
  return out;
}

/// Whether a window is there; windows of 1.2 m lie every 1.8 m.
bool is_window(const Vec3& p) {
  const double along = p.x / 1.8 - std::floor(p.x / 1.8);
  return std::abs(p.x) < 9 && std::abs(p.y) > 1.1 && p.z > 2.0 && p.z < 2.9 && along < 0.66;
}

void add_body(Mesh& mesh) {
  std::vector<std::vector<Vec3>> sections;
  constexpr int kSteps = 150;
  for (int i = 0; i <= kSteps; ++i) {
    sections.push_back(section(kHalfLength * (2.0 * i / kSteps - 1)));
  }
  mesh.add_skin(sections, is_window);
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

Mesh train_wagon() {
  Mesh mesh;
  add_body(mesh);
  add_underframe(mesh);
  for (const double side : {-0.5, 0.5}) add_bogie(mesh, side * kBogieDistance);
  return mesh;
}

}  // namespace clearway::scene
