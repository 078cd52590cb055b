#include "gpu/predicate_check.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <random>

#include "core/error.hpp"

using namespace clearway;

namespace {

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
    if (i % 3 == 0) c.radius = std::nextafter(c.radius, 1.0);
  }
  return cases;
}

/// The predicate spelt out, without the header's helpers.
PredicateAnswer spelt_out(const PredicateCase& c) {
  volatile double m[3], d[3];
  for (int k = 0; k < 3; ++k) {
    volatile double a = c.pose.rotation[3 * k] * c.model.x;
    volatile double b = c.pose.rotation[3 * k + 1] * c.model.y;
    volatile double sum = a + b;
    a = c.pose.rotation[3 * k + 2] * c.model.z;
    sum = sum + a;
    m[k] = sum + c.pose.translation[k];
    d[k] = c.environment[k] - m[k];
  }
  volatile double xx = d[0] * d[0], yy = d[1] * d[1], zz = d[2] * d[2], rr = c.radius * c.radius;
  volatile double squared = xx + yy;
  squared = squared + zz;
  return {squared, squared < rr};
}

void check_equal(const std::vector<PredicateCase>& cases,
                 const std::vector<PredicateAnswer>& answers) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const PredicateAnswer expected = spelt_out(cases[i]);
    differing += std::bit_cast<std::uint64_t>(expected.squared_distance) !=
                     std::bit_cast<std::uint64_t>(answers[i].squared_distance) ||
                 expected.hit != answers[i].hit;
  }
  CHECK(differing == 0);
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
  if (!has_cuda_device()) {
    std::cout << "no CUDA device here: the device's refusal is tested instead\n";
    CHECK_THROWS_AS(decide_on_device(cases), ResourceError);
    return;
  }
  check_equal(cases, decide_on_device(cases));
}
