#include "bench/measure/misclassified.hpp"

#include <algorithm>
#include <cmath>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway::bench;

namespace {

constexpr double kRadiusOfErrors = 0.1, kClearance = 0.5;

/// The distances of points 0, 1, ...; infinite where a point has none.
using Distances = std::vector<double>;
using Sources = std::vector<std::uint64_t>;

ResultHeader header_of(std::uint64_t points, double clearance) {
  ResultHeader header = sample_header(false);
  header.environment_points = points;
  header.radius = kRadiusOfErrors;
  header.clearance = clearance;
  return header;
}

Collisions rows_of(const Sources& sources) {
  return {.source = sources, .xyz = std::vector<Vec3>(sources.size()), .first_pose = {}};
}

ResultReader truth_of(const ScratchFolder& folder, const Distances& distances,
                      double clearance = kClearance) {
  Sources hits;
  Clearances clearances;
  for (std::uint64_t i = 0; i < distances.size(); ++i) {
    if (distances[i] < kRadiusOfErrors) hits.push_back(i);
    if (distances[i] >= clearance) continue;
    clearances.source.push_back(i);
    clearances.xyz.push_back({});
    clearances.distance.push_back(distances[i]);
    clearances.pose.push_back(0);
  }
  write_result(folder / "truth.h5", header_of(distances.size(), clearance), rows_of(hits), 1000,
               clearances);
  return ResultReader(folder / "truth.h5");
}

/// An answer about the same points in another quantisation, without clearances.
ResultReader answer_of(const ScratchFolder& folder, const Sources& hits, std::uint64_t points) {
  ResultHeader header = header_of(points, 0);
  header.environment_hash = 1;
  header.model_points = 7;
  header.radius = 0.1f;
  header.quantisation = {{1, 1, 1}, {0, 0, 0}};
  write_result(folder / "answer.h5", header, rows_of(hits));
  return ResultReader(folder / "answer.h5");
}

Misclassified compare(const Distances& distances, const Sources& hits) {
  const ScratchFolder folder;
  return misclassified(truth_of(folder, distances), answer_of(folder, hits, distances.size()));
}

}  // namespace

TEST_CASE("equal answers have no wrong points") {
  const Misclassified out = compare({0.05, 0.2, 0.09, 9}, {0, 2});
  Misclassified expected;
  expected.environment_points = 4;
  CHECK(out == expected);
  CHECK(compare({9, 9}, {}).false_hits == 0);
  CHECK(compare({}, {}) == Misclassified{});
}

TEST_CASE("wrong points are counted by their distance, first and last ones too") {
  const double below = std::nextafter(kRadiusOfErrors, 0);
  // Misses: 0, 3, 7. False hits: 1, 4 (exactly at r), 5 (beyond D), 8 (beyond D).
  const Misclassified out =
      compare({0.05, 0.12, 0.01, below, kRadiusOfErrors, 0.5, 0.06, 0.0, 9}, {1, 2, 4, 5, 6, 8});
  CHECK(out.environment_points == 9);
  CHECK(out.misses == 3);
  CHECK(out.false_hits == 4);
  CHECK(out.beyond == 2);
  CHECK(out.largest_distance == kRadiusOfErrors);
  std::array<std::uint64_t, 18> histogram{};
  histogram[0] = 2;   // distances at r and at the next double below it, 1.4e-17 away
  histogram[15] = 2;  // distances 0.05 and 0.02
  histogram[16] = 1;  // distance 0.1
  CHECK(out.histogram == histogram);
}

TEST_CASE("a wrong point counts in its decade") {
  for (const double d : {kRadiusOfErrors + 1e-15, kRadiusOfErrors + 3e-9, kRadiusOfErrors + 0.002,
                         0.35, 1.1, 1.05, 3.0}) {
    const ScratchFolder folder;
    const Misclassified out = misclassified(truth_of(folder, {d}, 4), answer_of(folder, {0}, 1));
    CHECK(out.largest_distance == d - kRadiusOfErrors);
    const int decade = 17 + static_cast<int>(std::floor(std::log10(d - kRadiusOfErrors)));
    CHECK(out.histogram[std::min(decade, 17)] == 1);
  }
}

TEST_CASE("an empty answer misses everything, an empty truth makes every hit wrong") {
  const Misclassified missed = compare({0.05, 0.02}, {});
  CHECK(missed.misses == 2);
  CHECK(missed.false_hits == 0);
  CHECK(missed.largest_distance == 0.08);
  const Misclassified invented = compare({0.75, 9}, {0, 1});
  CHECK(invented.false_hits == 2);
  CHECK(invented.beyond == 2);
  CHECK(invented.misses == 0);
  CHECK(invented.largest_distance == 0);
}

TEST_CASE("wrong points across batches of rows are found") {
  constexpr std::size_t kPoints = 300'000;
  Distances distances(kPoints);
  Sources hits;
  std::uint64_t misses = 0, false_hits = 0, beyond = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    distances[i] = static_cast<double>(i * 2654435761u % 1000) / 1000;
    const bool hit = distances[i] < kRadiusOfErrors;
    const bool wrong = i % 97 == 0;
    if (hit != wrong) hits.push_back(i);
    misses += wrong && hit;
    false_hits += wrong && !hit;
    beyond += wrong && distances[i] >= kClearance;
  }
  const Misclassified out = compare(distances, hits);
  CHECK(out.misses == misses);
  CHECK(out.false_hits == false_hits);
  CHECK(out.beyond == beyond);
}

TEST_CASE("points behind the truth's do not count") {
  const ScratchFolder folder;
  const ResultReader truth = truth_of(folder, {0.05, 0.2});
  const Misclassified out = misclassified(truth, answer_of(folder, {0, 2, 9}, 10));
  CHECK(out.false_hits == 0);
  CHECK(out.environment_points == 2);
}

TEST_CASE("results that say nothing of each other are refused") {
  const ScratchFolder folder, other;
  const ResultReader truth = truth_of(folder, {0.05, 0.2});
  CHECK_THROWS_WITH(misclassified(truth, answer_of(folder, {0}, 1)), Contains("at least the 2"));
  const ResultReader answer = answer_of(folder, {0}, 2);
  CHECK_THROWS_WITH(misclassified(answer, truth), Contains("--clearance"));
  const ResultReader near_only = truth_of(other, {0.05, 0.2}, kRadiusOfErrors);
  CHECK_THROWS_WITH(misclassified(near_only, answer), Contains("--clearance"));
  CHECK_THROWS_WITH(points_near_boundary(near_only, kRadiusOfErrors), Contains("--clearance"));
}

TEST_CASE("a truth without a colliding point's clearance is refused") {
  const ScratchFolder folder;
  write_result(folder / "truth.h5", header_of(3, kClearance), rows_of({1}));
  CHECK_THROWS_WITH(misclassified(ResultReader(folder / "truth.h5"), answer_of(folder, {}, 3)),
                    Contains("point 1"));
}

TEST_CASE("points near the boundary are counted in ulps of the radius") {
  const double ulp = std::nextafter(kRadiusOfErrors, 1) - kRadiusOfErrors;
  const auto at = [ulp](double ulps) { return kRadiusOfErrors + ulps * ulp; };
  const ScratchFolder folder;
  // 0.1 lies in the middle of its binade, so that its neighbours are all one ulp apart.
  const Distances distances{0.0,   kRadiusOfErrors, at(1), at(-1), at(2),          at(3),
                            at(4), at(-5),          0.4,   9,      at(0x1p40 + 1), at(-0x1p40)};
  const NearBoundary near = points_near_boundary(truth_of(folder, distances), kRadiusOfErrors);
  CHECK(near[0] == 3);
  CHECK(near[1] == 4);
  CHECK(near[2] == 6);
  for (std::size_t i = 3; i < 40; ++i) CHECK(near[i] == 7);
  CHECK(near[40] == 8);
  CHECK(points_near_boundary(truth_of(folder, {}), kRadiusOfErrors) == NearBoundary{});
}
