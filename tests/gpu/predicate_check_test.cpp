#include "predicate_check.hpp"

#include <bit>
#include <cmath>
#include <iostream>
#include <random>

#include "clearway/error.hpp"
#include "gpu/devices.hpp"
#include "support/catch.hpp"

using namespace clearway;

namespace {

void spell_out_transform(const Pose& pose, const Vec3& model, double* m) {
  for (int k = 0; k < 3; ++k) {
    volatile double a = pose.rotation[3 * k] * model.x;
    volatile double b = pose.rotation[3 * k + 1] * model.y;
    volatile double sum = a + b;
    a = pose.rotation[3 * k + 2] * model.z;
    sum = sum + a;
    sum = sum + pose.translation[k];
    m[k] = sum;
  }
}

double spell_out_dot(const double* a, const double* b) {
  volatile double xx = a[0] * b[0], yy = a[1] * b[1], zz = a[2] * b[2];
  volatile double sum = xx + yy;
  sum = sum + zz;
  return sum;
}

/// The segment to the next pose seen from the environment point: whether the perpendicular's foot
/// lies inside it, and the squared distance w.w.
struct Segment {
  bool beside;
  double squared;
};

Segment segment_of(const PredicateCase& c) {
  double a[3], b[3], ab[3], ae[3], w[3];
  spell_out_transform(c.pose, c.model, a);
  spell_out_transform(c.next, c.model, b);
  for (int k = 0; k < 3; ++k) {
    ab[k] = b[k] - a[k];
    ae[k] = c.environment[k] - a[k];
  }
  const double n = spell_out_dot(ae, ab), length = spell_out_dot(ab, ab);
  volatile double g = n / length;
  for (int k = 0; k < 3; ++k) {
    volatile double along = g * ab[k];
    w[k] = ae[k] - along;
  }
  return {0 < n && n < length, spell_out_dot(w, w)};
}

/// Pairs whose distance straddles the radius by a few ulps, near and far from the origin.
std::vector<PredicateCase> cases_at_the_radius(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<PredicateCase> cases(count);
  for (std::size_t i = 0; i < count; ++i) {
    PredicateCase& c = cases[i];
    const double far = i % 2 == 0 ? 10 : 5e6;
    for (double& r : c.pose.rotation) r = unit(random);
    for (double& p : c.pose.translation) p = far * unit(random);
    c.model = {5 * unit(random), 5 * unit(random), 5 * unit(random)};
    const Vec3 moved = transform(c.pose, c.model);
    const Vec3 away{unit(random), unit(random), unit(random)};
    c.environment = {moved.x + 0.1 * away.x, moved.y + 0.1 * away.y, moved.z + 0.1 * away.z};
    c.radius = std::sqrt(squared_distance(c.environment, moved));
    c.next = c.pose;
    if (i % 5 == 0) {
      for (double& p : c.next.translation) p += unit(random);
      const Vec3 b = transform(c.next, c.model);
      const Vec3 beside{c.environment.x + 0.5 * (b.x - moved.x),
                        c.environment.y + 0.5 * (b.y - moved.y),
                        c.environment.z + 0.5 * (b.z - moved.z)};
      c.environment = beside;
      c.radius = std::sqrt(segment_of(c).squared);
    }
    if (i % 3 == 0) c.radius = std::nextafter(c.radius, 1.0);
  }
  return cases;
}

/// The predicate's answer, spelt out without the header's helpers.
PredicateAnswer spelt_out(const PredicateCase& c) {
  double m[3], d[3];
  spell_out_transform(c.pose, c.model, m);
  for (int k = 0; k < 3; ++k) d[k] = c.environment[k] - m[k];
  const double squared = spell_out_dot(d, d);
  volatile double rr = c.radius * c.radius;
  const Segment segment = segment_of(c);
  return {squared, squared < rr, segment.beside && segment.squared < rr};
}

void check_equal(const std::vector<PredicateCase>& cases,
                 const std::vector<PredicateAnswer>& answers) {
  std::size_t differing = 0, inside = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const PredicateAnswer expected = spelt_out(cases[i]);
    differing += std::bit_cast<std::uint64_t>(expected.squared_distance) !=
                     std::bit_cast<std::uint64_t>(answers[i].squared_distance) ||
                 expected.hit != answers[i].hit || expected.inside != answers[i].inside;
    inside += expected.inside;
  }
  CHECK(differing == 0);
  CHECK(inside > cases.size() / 100);
}

}  // namespace

TEST_CASE("the kernel's body decides as the predicate spelt out, on the host") {
  const auto cases = cases_at_the_radius(200'000);
  std::vector<PredicateAnswer> answers;
  for (const PredicateCase& c : cases) answers.push_back(decide(c));
  check_equal(cases, answers);
}

TEST_CASE("the predicate on the device is the host's bit for bit") {
  const auto cases = cases_at_the_radius(1'000'000);
  if (cuda_device_count() == 0) {
    std::cout << "no CUDA device here: the device's refusal is tested instead\n";
    CHECK_THROWS_AS(decide_on_device(cases), ResourceError);
    return;
  }
  check_equal(cases, decide_on_device(cases));
}
