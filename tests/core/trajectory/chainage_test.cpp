#include "core/trajectory/chainage.hpp"

#include <catch2/catch.hpp>

using namespace clearway;

namespace {

Pose at(double x, double y, double z) { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, y, z}}; }

}  // namespace

TEST_CASE("chainage is the length of the path so far") {
  const std::vector<Pose> poses{at(5e5, 4e6, 100), at(5e5 + 3, 4e6 + 4, 100),
                                at(5e5 + 3, 4e6 + 4, 100), at(5e5 + 3, 4e6, 97), at(5e5, 4e6, 97)};
  CHECK(chainage_of(poses) == std::vector<double>{0, 5, 5, 10, 13});
}

TEST_CASE("chainage of no pose and of one") {
  CHECK(chainage_of({}).empty());
  const std::vector<Pose> one{at(1, 2, 3)};
  CHECK(chainage_of(one) == std::vector<double>{0});
}
