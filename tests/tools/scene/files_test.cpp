#define XXH_INLINE_ALL
#include <xxhash.h>

#include "clearway/error.hpp"
#include "core/geometry/rigid.hpp"
#include "support/catch.hpp"
#include "tools/scene/made_scene.hpp"

using namespace clearway;
using namespace clearway::scene;
using test::Bytes;

namespace {

constexpr Sizes kSmallScene{100003, 5003, 701};

std::uint64_t hash_of(const Bytes& bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

struct Frozen {
  Kind kind;
  std::uint64_t environment, model, trajectory;
};

// Hashes of the scenes' files. The generator is frozen: they change only with a scene's definition,
// and with them every measurement on the scenes.
constexpr Frozen kFrozen[] = {
    {Kind::kHall, 0x1fc61bcc10917536, 0x9e45b7c30bc4204f, 0x17d995d53450bfdd},
    {Kind::kPlant, 0x40f398c01bf56a75, 0xe94a9fb348c4f1e, 0x98a873e342b5d507},
    {Kind::kMine, 0xb8cda99bc11d9066, 0x1796e90e4db10c93, 0x4ff9abdb3ab9c52e},
    {Kind::kTunnel, 0x1f948fce5fc49023, 0xad9af581b5e94469, 0x180175abefbe0e6},
    {Kind::kRoad, 0xb9c3e3a6d6d05e33, 0x77948c48400ab8d6, 0x247fead9e19ead3c},
};

}  // namespace

TEST_CASE("the bytes of each scene are frozen") {
  for (const Frozen& frozen : kFrozen) {
    INFO(name_of(frozen.kind));
    const auto made = make_scene(frozen.kind, kSmallScene, 7);
    CHECK(hash_of(test::environment_bytes(*made, 7, 2)) == frozen.environment);
    CHECK(hash_of(test::model_bytes(*made)) == frozen.model);
    CHECK(hash_of(test::trajectory_bytes(*made)) == frozen.trajectory);
  }
}

TEST_CASE("a scene's bytes depend on the seed, not on threads or on the run") {
  for (const Kind kind : kAllKinds) {
    INFO(name_of(kind));
    const auto made = make_scene(kind, kSmallScene, 3), again = make_scene(kind, kSmallScene, 3);
    const Bytes one = test::environment_bytes(*made, 3, 1);
    CHECK(one == test::environment_bytes(*again, 3, 5));
    CHECK(test::model_bytes(*made) == test::model_bytes(*again));
    CHECK(test::trajectory_bytes(*made) == test::trajectory_bytes(*again));
    const auto other = make_scene(kind, kSmallScene, 4);
    CHECK(one != test::environment_bytes(*other, 4, 2));
    CHECK(test::model_bytes(*made) != test::model_bytes(*other));
  }
}

TEST_CASE("a scene has exactly the numbers asked for, within the header's bounds") {
  for (const Kind kind : kAllKinds) {
    for (const Sizes& sizes : {kSmallScene, Sizes{1, 1, 1}, Sizes{17, 2, 2}, Sizes{65536, 3, 3}}) {
      INFO(name_of(kind) << " " << sizes.points);
      const auto made = make_scene(kind, sizes, 1);
      const Bytes las = test::environment_bytes(*made, 1, 2);
      REQUIRE(las.size() == 227 + 20 * sizes.points);
      CHECK(test::value_at<std::uint32_t>(las, 107) == sizes.points);
      bool inside = true;
      for (const Vec3& p : test::las_positions(las)) {
        for (std::size_t k = 0; k < 3; ++k) {
          const double value = p[static_cast<int>(k)];
          inside = inside && value <= test::value_at<double>(las, 179 + 16 * k) &&
                   value >= test::value_at<double>(las, 187 + 16 * k);
        }
      }
      CHECK(inside);
      CHECK(test::ply_positions(test::model_bytes(*made)).size() == sizes.model_points);
      CHECK(test::text_poses(test::trajectory_bytes(*made)).size() == sizes.poses);
    }
  }
}

TEST_CASE("every pose is rigid as written") {
  for (const Kind kind : kAllKinds) {
    const auto made = make_scene(kind, kSmallScene, 1);
    bool rigid = true;
    for (const Pose& pose : test::text_poses(test::trajectory_bytes(*made))) {
      const Stretch stretch = stretch_of(pose);
      rigid = rigid && is_rigid(stretch) && stretch.least > 1 - 1e-7 && stretch.greatest < 1 + 1e-7;
    }
    CHECK(rigid);
  }
}

TEST_CASE("coordinates are spread over the quanta, not degenerate") {
  const auto made = test::made_scene(Kind::kHall, kSmallScene);
  int floor_points = 0, exact = 0;
  for (const Vec3& p : made.environment) {
    if (std::abs(p.z) < 0.02) ++floor_points;
    if (p.z == 0) ++exact;
  }
  REQUIRE(floor_points > 5000);
  CHECK(exact < floor_points / 10);
}

TEST_CASE("a scene without points, model or poses is wrong usage") {
  CHECK_THROWS_AS(make_scene(Kind::kHall, {0, 1, 1}, 1), UsageError);
  CHECK_THROWS_AS(make_scene(Kind::kMine, {1, 0, 1}, 1), UsageError);
  CHECK_THROWS_AS(make_scene(Kind::kTunnel, {1, 1, 0}, 1), UsageError);
}

TEST_CASE("an environment that cannot be written is a resource error") {
  const auto made = make_scene(Kind::kHall, {200000, 1, 1}, 1);
  const File full = File::create("/dev/full");
  NoProgress progress;
  CHECK_THROWS_AS(write_environment(*made, 1, full, 2, progress), ResourceError);
}
