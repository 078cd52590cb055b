// Scenes are frozen: their bytes say whether the generator has changed.
#define XXH_INLINE_ALL
#include "scene/scene.hpp"

#include <xxhash.h>

#include <cstring>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"
#include "scene/write.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::scene;
using namespace clearway::test;

namespace {

constexpr Sizes kSmallScene{100003, 5003, 701};

/// The files of a scene, as bytes.
struct Files {
  Files(Kind kind, const Sizes& sizes, std::uint64_t seed, int threads) {
    const auto made = make_scene(kind, sizes, seed);
    environment = written([&](const File& file) {
      NoProgress progress;
      write_environment(*made, seed, file, threads, progress);
    });
    model = written([&](const File& file) { write_model(*made, file); });
    trajectory = written([&](const File& file) { write_trajectory(*made, file); });
    origins = written([&](const File& file) { write_origins(*made, file); });
  }

  template <typename Write>
  static std::string written(Write write) {
    const ScratchFolder folder;
    write(File::create(folder / "file"));
    return bytes_of(folder / "file");
  }

  std::string environment, model, trajectory, origins;
};

template <typename Value>
Value value_at(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Whether all points of a LAS file lie within the bounds of its header.
bool within_bounds(const std::string& las, std::size_t points) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto header = [&](std::size_t at) { return value_at<double>(las, at); };
    for (std::size_t i = 0; i < points; ++i) {
      const double quantum = value_at<std::int32_t>(las, 227 + 20 * i + 4 * k);
      const double value = quantum * header(131 + 8 * k) + header(155 + 8 * k);
      if (value > header(179 + 16 * k) || value < header(187 + 16 * k)) return false;
    }
  }
  return true;
}

struct Frozen {
  Kind kind;
  std::uint64_t environment, model, trajectory, origins;
};

// They change only with a scene's definition, and with them every measurement on the scenes.
constexpr Frozen kFrozen[] = {
    {Kind::kHall, 0x1fc61bcc10917536, 0x9e45b7c30bc4204f, 0x17d995d53450bfdd, 0x5e270276c6084331},
    {Kind::kPlant, 0x40f398c01bf56a75, 0xe94a9fb348c4f1e, 0x98a873e342b5d507, 0x3f4dc35899ed0a48},
    {Kind::kMine, 0xb8cda99bc11d9066, 0x1796e90e4db10c93, 0x4ff9abdb3ab9c52e, 0xa9d31794fb6bf0f4},
    {Kind::kTunnel, 0x1f948fce5fc49023, 0xad9af581b5e94469, 0x180175abefbe0e6, 0x68c1fae960d6fdf6},
    {Kind::kRoad, 0xb9c3e3a6d6d05e33, 0x77948c48400ab8d6, 0x247fead9e19ead3c, 0xbe588ac4f452977d},
};

}  // namespace

TEST_CASE("the bytes of each scene are frozen, whatever the number of threads") {
  const auto hash = [](const std::string& bytes) { return XXH64(bytes.data(), bytes.size(), 0); };
  for (const Frozen& frozen : kFrozen) {
    INFO(name_of(frozen.kind));
    for (const int threads : {1, 5}) {
      const Files files(frozen.kind, kSmallScene, 7, threads);
      CHECK(hash(files.environment) == frozen.environment);
      CHECK(hash(files.model) == frozen.model);
      CHECK(hash(files.trajectory) == frozen.trajectory);
      CHECK(hash(files.origins) == frozen.origins);
    }
  }
}

TEST_CASE("a scene has exactly the numbers asked for, within the header's bounds") {
  const ScratchFolder folder;
  for (const Kind kind : kAllKinds) {
    for (const Sizes& sizes : {Sizes{1, 1, 1}, Sizes{17, 2, 2}, Sizes{65536, 3, 3}}) {
      INFO(name_of(kind) << " " << sizes.points);
      const Files files(kind, sizes, 1, 2);
      REQUIRE(files.environment.size() == 227 + 20 * sizes.points);
      CHECK(value_at<std::uint32_t>(files.environment, 107) == sizes.points);
      CHECK(within_bounds(files.environment, sizes.points));
      put_bytes(folder / "model.ply", files.model);
      put_bytes(folder / "path.txt", files.trajectory);
      CHECK(read_model_points(folder / "model.ply").size() == sizes.model_points);
      CHECK(read_trajectory(folder / "path.txt").size() == sizes.poses);  // all are rigid
    }
  }
}

TEST_CASE("a scene without points, model or poses is wrong usage, a full disk a resource error") {
  for (const Sizes& sizes : {Sizes{0, 1, 1}, Sizes{1, 0, 1}, Sizes{1, 1, 0}}) {
    CHECK_THROWS_AS(make_scene(Kind::kMine, sizes, 1), UsageError);
  }
  const auto made = make_scene(Kind::kHall, {200000, 1, 1}, 1);
  const File full = File::create("/dev/full");
  NoProgress progress;
  CHECK_THROWS_AS(write_environment(*made, 1, full, 2, progress), ResourceError);
}
