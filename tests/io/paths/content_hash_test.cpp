#include "io/paths/content_hash.hpp"

#include <vector>

#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a hash is xxh64 of the little-endian numbers in order") {
  const std::vector<Vec3> points{{1, 2, 3}, {-0.5, 1e300, 0}};
  check_equal(hash_of_model(points), 0x765001e3919e13b3);
  Pose pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {10, 20, 30}};
  check_equal(hash_of_trajectory({&pose, 1}), 0x48c7e179df40a3a0);
  check_equal(hash_of_model({}), 0xef46db3751d8e999);
  check_equal(hash_of_trajectory({}), 0xef46db3751d8e999);
}
