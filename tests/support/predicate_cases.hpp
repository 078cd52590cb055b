#pragma once

#include <bit>
#include <cmath>
#include <vector>

#include "gpu/predicate_check.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

/// The predicate spelt out without the helpers of its header, for cases where rounding decides.
namespace clearway::test {

inline Vec3 spelt_out_transform(const Pose& pose, const Vec3& model) {
  Vec3 m{};
  for (int k = 0; k < 3; ++k) {
    volatile double a = pose.rotation[3 * k] * model.x;
    volatile double b = pose.rotation[3 * k + 1] * model.y;
    volatile double sum = a + b;
    a = pose.rotation[3 * k + 2] * model.z;
    sum = sum + a;
    sum = sum + pose.translation[k];
    m[k] = sum;
  }
  return m;
}

inline double spelt_out_dot(const Vec3& a, const Vec3& b) {
  volatile double xx = a.x * b.x, yy = a.y * b.y, zz = a.z * b.z;
  volatile double sum = xx + yy;
  sum = sum + zz;
  return sum;
}

/// inside_squared: set to the squared distance from the segment's line.
inline PredicateAnswer spelt_out(const PredicateCase& c, double& inside_squared) {
  const Vec3 a = spelt_out_transform(c.pose, c.model), b = spelt_out_transform(c.next, c.model);
  Vec3 ab{}, ae{}, w{};
  for (int k = 0; k < 3; ++k) {
    ab[k] = b[k] - a[k];
    ae[k] = c.environment[k] - a[k];
  }
  const double n = spelt_out_dot(ae, ab), length = spelt_out_dot(ab, ab);
  volatile double g = n / length, rr = c.radius * c.radius;
  for (int k = 0; k < 3; ++k) {
    volatile double along = g * ab[k];
    w[k] = ae[k] - along;
  }
  inside_squared = spelt_out_dot(w, w);
  const double squared = spelt_out_dot(ae, ae);
  return {squared, squared < rr, 0 < n && n < length && inside_squared < rr};
}

/// Pairs whose distance straddles the radius by a few ulps, near and far from the origin.
inline std::vector<PredicateCase> cases_at_the_radius(std::size_t count) {
  Random random(1);
  const Box unit{{-1, -1, -1}, {1, 1, 1}};
  std::vector<PredicateCase> cases(count);
  for (std::size_t i = 0; i < count; ++i) {
    PredicateCase& c = cases[i];
    const double far = i % 2 == 0 ? 10 : 5e6;
    for (double& r : c.pose.rotation) r = uniform(random, -1, 1);
    for (double& p : c.pose.translation) p = far * uniform(random, -1, 1);
    c.model = random_point(random, {{-5, -5, -5}, {5, 5, 5}});
    c.next = c.pose;
    const Vec3 moved = transform(c.pose, c.model), away = random_point(random, unit);
    for (int k = 0; k < 3; ++k) c.environment[k] = moved[k] + 0.1 * away[k];
    double inside = 0;
    if (i % 5 == 0) {
      for (double& p : c.next.translation) p += uniform(random, -1, 1);
      const Vec3 b = transform(c.next, c.model);
      for (int k = 0; k < 3; ++k) c.environment[k] += 0.5 * (b[k] - moved[k]);
      spelt_out(c, inside);
    }
    c.radius = std::sqrt(i % 5 == 0 ? inside : spelt_out(c, inside).squared_distance);
    if (i % 3 == 0) c.radius = std::nextafter(c.radius, 1.0);
  }
  return cases;
}

/// Checks that the answers are those of the predicate spelt out, bit for bit.
inline void check_decided(const std::vector<PredicateCase>& cases,
                          const std::vector<PredicateAnswer>& answers) {
  std::size_t differing = 0, hits = 0, inside = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    double unused = 0;
    const PredicateAnswer expected = spelt_out(cases[i], unused);
    differing += std::bit_cast<std::uint64_t>(expected.squared_distance) !=
                     std::bit_cast<std::uint64_t>(answers[i].squared_distance) ||
                 expected.hit != answers[i].hit || expected.inside != answers[i].inside;
    hits += expected.hit;
    inside += expected.inside;
  }
  CHECK(differing == 0);
  CHECK(hits > cases.size() / 20);
  CHECK(inside > cases.size() / 100);
}

}  // namespace clearway::test
