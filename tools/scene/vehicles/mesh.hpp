#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "clearway/vec3.hpp"
#include "scene/random.hpp"
#include "scene/vector.hpp"

namespace clearway::scene {

/// Triangles in a model's own frame: x forward, y left, z up, metres.
class Mesh {
 public:
  using Triangle = std::array<Vec3, 3>;

  void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  /// Adds the six faces of the box between two corners.
  void add_box(const Vec3& low, const Vec3& high);
  /// Adds a closed cylinder along y, for wheels and axles.
  void add_wheel(const Vec3& centre, double radius, double width);
  /// Adds a skin through the sections 0 to `steps`, which have equally many points. A quad is left
  /// out where `open` says so of its middle, as for windows and wheel arches.
  void add_skin(int steps, const std::function<std::vector<Vec3>(int)>& section,
                const std::function<bool(const Vec3&)>& open);

  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  std::vector<Triangle> triangles_;
};

/// Samples exactly `count` points on the mesh, in the order of its triangles. They are equally
/// dense everywhere except for the factor `density` (of a triangle's middle), and each is moved by
/// `noise` (standard deviation) per axis.
std::vector<Vec3> sample_mesh(const Mesh& mesh, std::uint64_t count, double noise,
                              const std::function<double(const Vec3&)>& density,
                              const Random& random);

}  // namespace clearway::scene
