// The plane that parts points, against a sort.
#include "io/store/convert/select_split.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "support/clouds.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<BucketPoint> bucket_of(const std::vector<Quantum>& points) {
  std::vector<BucketPoint> bucket;
  bucket.reserve(points.size());
  for (const Quantum& q : points) {
    bucket.push_back({{q[0], q[1], q[2]}, static_cast<std::uint32_t>(bucket.size())});
  }
  return bucket;
}

/// Checks that the points below a split's value, and as many at it as the split says, are the least
/// ones.
void check_split(const std::vector<BucketPoint>& points, std::size_t left, int axis) {
  CAPTURE(points.size(), left, axis);
  std::vector<std::int32_t> sorted;
  sorted.reserve(points.size());
  for (const BucketPoint& p : points) sorted.push_back(p.q[axis]);
  std::sort(sorted.begin(), sorted.end());
  std::vector<BucketPoint> scratch(points.size());
  const KdSplit split =
      select_split(points, left, axis, {sorted.front(), sorted.back()}, scratch.data());
  const auto at = std::equal_range(sorted.begin(), sorted.end(), split.value);
  const auto below = static_cast<std::size_t>(at.first - sorted.begin());
  CHECK(below + split.equal == left);
  CHECK(split.equal <= static_cast<std::size_t>(at.second - at.first));
}

void check_splits(const std::vector<Quantum>& points) {
  const std::size_t n = points.size();
  const std::vector<BucketPoint> bucket = bucket_of(points);
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::size_t left : {std::size_t{1}, n / 3, n / 2, n - 1}) {
      check_split(bucket, left, axis);
    }
  }
}

}  // namespace

TEST_CASE("a split leaves the least coordinates on its left") {
  for (const std::size_t count : {2u, 65u, 128u, 4096u, 4097u, 5000u, 70001u}) {
    for (const auto& [name, points] : hard_clouds(count, count)) {
      CAPTURE(name);
      check_splits(points);
    }
  }
}

TEST_CASE("a split is right where the sample tells nothing") {
  constexpr std::size_t kCount = 1 << 15;
  constexpr std::size_t kPeriod = 32;  // a power of two, like the sample's steps
  for (const std::int32_t sampled : {-2147483647 - 1, -5, 1000, 2147483647}) {
    CAPTURE(sampled);
    std::vector<Quantum> points = cube_cloud(kCount, 0, 100, 3);
    for (std::size_t i = 0; i < kCount; i += kPeriod) points[i] = {sampled, sampled, sampled};
    check_splits(points);
  }
}

TEST_CASE("a split between two values parts them") {
  for (const std::size_t count : {100u, 10000u}) {
    std::vector<Quantum> points(count, Quantum{-2147483647 - 1, 8, 2147483646});
    for (std::size_t i = 0; i < count / 2; ++i) points[2 * i] = {2147483647, 9, 2147483647};
    check_splits(points);
    check_split(bucket_of(points), count / 2 + 1, 0);
    check_split(bucket_of(points), count / 2 - 1, 2);
  }
}
