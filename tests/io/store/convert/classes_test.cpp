// Classes on their way from scans into a store.
#include <catch2/catch.hpp>
#include <limits>

#include "io/store/convert/distribute.hpp"
#include "support/classed_scans.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void check_sound(const StoreReader& store, const std::vector<std::uint8_t>& classes) {
  REQUIRE(store.has_classes());
  CHECK(classes_by_source(store) == classes);
  std::array<std::uint64_t, 256> counts{};
  for (const std::uint8_t value : classes) ++counts[value];
  CHECK(store.metadata().classes->points == counts);
  CHECK(faults_of(store).empty());
}

}  // namespace

TEST_CASE("a store has the class of every point, whatever layout, threads and width") {
  const ScratchFolder folder;
  const auto points = cube_cloud(5000, -4000, 4000, 3);
  const unsigned most = GENERATE(1U, 7U, 31U, 255U);
  const auto classes = random_classes(points.size(), most);
  write_classed(folder / "a.las", points, classes);
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5", 200);
  SECTION("adaptive") {}
  SECTION("regular") { options.regular_size = 4; }
  SECTION("another scale") { options.scale = 0.01; }
  convert_quietly(options);
  check_sound(StoreReader(options.output), classes);
  const std::string bytes = bytes_of(options.output);
  options.threads = 4;
  convert_quietly(options);
  CHECK(bytes_of(options.output) == bytes);
}

TEST_CASE("a store of points without classes, or all of class 0, says nothing of classes") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  SECTION("class 0") { write_classed(folder / "a.las", points, random_classes(300, 0)); }
  SECTION("class 0 with flags") {
    write_classed(folder / "a.las", points, std::vector<std::uint8_t>(300, 0x60), 3);
  }
  std::filesystem::path input = folder / "a.las";
  SECTION("another format") {
    input = folder / "a.xyz";
    put_bytes(input, "1 2 3\n4 5 6\n");
  }
  convert_quietly(conversion_of({input}, folder / "a.h5"));
  const StoreReader store(folder / "a.h5");
  CHECK_FALSE(store.has_classes());
  CHECK(faults_of(store).empty());
  CHECK(bytes_of(folder / "a.h5").find("classes") == std::string::npos);
}

TEST_CASE("of several scans those without classes have class 0, and dropped points none") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  auto classes = random_classes(points.size(), 9);
  write_classed(folder / "a.las", points, classes);
  write_classed(folder / "c.las", points, classes);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  write_ply(folder / "b.ply", std::vector<Vec3>{{1, 2, 3}, {kNone, 0, 0}, {4, 5, 6}});
  const auto once = classes;
  classes.insert(classes.end(), 3, 0);
  classes.insert(classes.end(), once.begin(), once.end());
  ConversionOptions options =
      conversion_of({folder / "a.las", folder / "b.ply", folder / "c.las"}, folder / "a.h5");
  convert_quietly(options);
  const StoreReader store(options.output);
  CHECK(store.point_count() + 1 == classes.size());
  CHECK(classes_by_source(store) == classes);
  CHECK(faults_of(store).empty());
}

TEST_CASE("classes change the fingerprint of a store, not the hash of its points") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  std::vector<std::uint64_t> prints, hashes, class_hashes;
  for (const unsigned most : {0U, 5U, 6U}) {
    write_classed(folder / "a.las", points, random_classes(points.size(), most));
    convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
    const StoreReader store(folder / "a.h5");
    prints.push_back(store.fingerprint());
    hashes.push_back(store.metadata().points_hash);
    if (store.has_classes()) class_hashes.push_back(store.metadata().classes->hash);
  }
  CHECK(prints[0] != prints[1]);
  CHECK(prints[1] != prints[2]);
  CHECK(hashes == std::vector<std::uint64_t>(3, hashes[0]));
  REQUIRE(class_hashes.size() == 2);
  CHECK(class_hashes[0] != class_hashes[1]);
}

TEST_CASE("a point on its way keeps class and source apart") {
  constexpr std::uint64_t kMost = (std::uint64_t{1} << 56) - 1;
  for (const std::uint64_t source : {std::uint64_t{0}, std::uint64_t{1} << 32, kMost}) {
    for (const std::uint8_t value : {std::uint8_t{0}, std::uint8_t{7}, std::uint8_t{255}}) {
      const auto point = DistributedPoint::of({1, 2, 3}, source, value);
      CHECK(point.source_index() == source);
      CHECK(point.point_class() == value);
    }
  }
}
