#include "scene/vehicles/mesh.hpp"

#include <cmath>

#include "clearway/box.hpp"

namespace clearway::scene {

void Mesh::add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  triangles_.push_back({a, b, c});
  triangles_.push_back({a, c, d});
}

void Mesh::add_box(const Vec3& low, const Vec3& high) {
  const Box box{low, high};
  constexpr unsigned kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    add_quad(box.corner(f[0]), box.corner(f[1]), box.corner(f[2]), box.corner(f[3]));
  }
}

void Mesh::add_wheel(const Vec3& centre, double radius, double width) {
  constexpr int kSides = 48;
  const auto rim = [&](int i, double y) {
    const SineCosine angle = sine_cosine(2 * kPi * (i % kSides) / kSides);
    return centre + Vec3{radius * angle.cosine, y, radius * angle.sine};
  };
  for (int i = 0; i < kSides; ++i) {
    const double half = width / 2;
    add_quad(rim(i, -half), rim(i + 1, -half), rim(i + 1, half), rim(i, half));
    for (const double y : {-half, half}) {
      triangles_.push_back({centre + Vec3{0, y, 0}, rim(i, y), rim(i + 1, y)});
    }
  }
}

void Mesh::add_skin(int steps, const std::function<std::vector<Vec3>(int)>& section,
                    const std::function<bool(const Vec3&)>& open) {
  std::vector<Vec3> p = section(0);
  for (int i = 1; i <= steps; ++i) {
    const std::vector<Vec3> q = section(i);
    for (std::size_t k = 0; k + 1 < p.size(); ++k) {
      const Vec3 middle = 0.25 * (p[k] + p[k + 1] + q[k] + q[k + 1]);
      if (!open(middle)) add_quad(p[k], q[k], q[k + 1], p[k + 1]);
    }
    p = q;
  }
}

std::vector<Vec3> sample_mesh(const Mesh& mesh, std::uint64_t count, double noise,
                              const std::function<double(const Vec3&)>& density,
                              const Random& random) {
  const auto& triangles = mesh.triangles();
  std::vector<double> end(triangles.size());  // cumulated weight
  double total = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    total += length(cross(b - a, c - a)) * density((1.0 / 3) * (a + b + c));
    end[i] = total;
  }
  std::vector<Vec3> out;
  out.reserve(count);
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double place =
        (static_cast<double>(i) + random.unit(6 * i)) * (total / static_cast<double>(count));
    while (at + 1 < end.size() && end[at] <= place) ++at;
    const auto& [a, b, c] = triangles[at];
    const double root = std::sqrt(random.unit(6 * i + 1)), f = random.unit(6 * i + 2);
    Vec3 p = (1 - root) * a + (root * (1 - f)) * b + (root * f) * c;
    for (int k = 0; k < 3; ++k) {
      p[k] += noise * Random::to_normal(random.bits(6 * i + 3 + static_cast<std::uint64_t>(k)));
    }
    out.push_back(p);
  }
  return out;
}

}  // namespace clearway::scene
