#include "io/store/convert/convert.hpp"

#include "io/files/hdf5.hpp"
#include "io/store/convert/conversion_identity.hpp"
#include "io/store/store_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/store_order.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// One LAS file and the options of its conversion.
struct Scan {
  explicit Scan(std::vector<Quantum> cloud, std::uint32_t cell_points = 64)
      : points(std::move(cloud)) {
    write_las(folder / "a.las", points);
    options = conversion_of({folder / "a.las"}, folder / "a.h5", cell_points);
  }

  ConversionReport convert() const { return convert_quietly(options); }
  std::string converted_bytes() const {
    convert();
    return bytes_of(options.output);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  ScratchFolder folder;
  std::vector<Quantum> points;
  ConversionOptions options;
};

std::array<std::int64_t, 3> cube_of(const Quantum& q, std::int64_t quanta) {
  std::array<std::int64_t, 3> cube{};
  for (std::size_t k = 0; k < 3; ++k) {
    cube[k] = (std::int64_t{q[k]} + 1'000'000 * quanta) / quanta;  // rounded down
  }
  return cube;
}

/// Checks that a bucket's points, and so a cell's, lie in one cube.
void check_cubes(const StoreReader& store, std::int64_t quanta) {
  for (const TopNode& node : store.top_tree()) {
    if (node.right != 0) continue;
    const auto points = points_of_cells(store, node.first_cell, node.cell_count);
    for (const StoredPoint& p : points) {
      REQUIRE(cube_of(p.q, quanta) == cube_of(points[0].q, quanta));
    }
  }
}

}  // namespace

TEST_CASE("the store is the same whatever threads, memory and repetition") {
  Scan scan(hard_clouds(70000, 5)[6].points, 1000);
  const std::string bytes = scan.converted_bytes();
  CHECK(scan.converted_bytes() == bytes);
  for (const auto& [threads, mebibytes] : {std::pair{1, 224}, {2, 512}, {4, 4096}, {3, 224}}) {
    scan.options.threads = threads;
    scan.options.memory_bytes = std::uint64_t(mebibytes) << 20;
    CHECK(scan.converted_bytes() == bytes);
  }
  check_equal(scan.files(), {"a.h5", "a.las"});
}

TEST_CASE("a store says what it holds") {
  const Scan scan(cube_cloud(777, -5000, 5000, 1), 100);
  const ConversionReport report = scan.convert();
  check_equal(report.cells, 8);
  check_equal(report.largest_change, 0);
  check_equal(report.non_finite_points, 0);
  check_equal(report.temporary_bytes, 777 * sizeof(DistributedPoint));
  CHECK(report.output_bytes == std::filesystem::file_size(scan.options.output));
  CHECK(report.warnings.empty());
  const StoreReader store(scan.options.output);
  const StoreMetadata& metadata = store.metadata();
  check_equal(metadata.point_count, 777);
  check_equal(metadata.input_points, 777);
  check_equal(metadata.cell_points, 100);
  CHECK(metadata.quantisation == kMillimetres);
  check_equal(metadata.layout, "adaptive");
  REQUIRE(metadata.sources.size() == 1);
  check_equal(metadata.sources[0].name, "a.las");
  CHECK(metadata.sources[0].bytes == std::filesystem::file_size(scan.folder / "a.las"));
  CHECK(points_by_source(store) == scan.points);
}

TEST_CASE("no points make an empty store") {
  const Scan scan({});
  scan.convert();
  const StoreReader store(scan.options.output);
  check_equal(store.point_count(), 0);
  CHECK(store.cells().empty());
  CHECK(store.tree().empty());
  CHECK(faults_of(store).empty());
}

TEST_CASE("regular layouts keep to their cubes on both sides of the origin") {
  Scan scan(cube_cloud(20000, -3000, 3000, 8));
  const std::string adaptive_hash = [&] {
    scan.convert();
    return std::to_string(StoreReader(scan.options.output).metadata().points_hash);
  }();
  for (const std::int64_t quanta : {16, 17, 1000, 1024, 3001, 10000}) {
    CAPTURE(quanta);
    scan.options.regular_size = static_cast<double>(quanta) * 0.001;
    scan.convert();
    const StoreReader store(scan.options.output);
    check_cubes(store, quanta);
    CHECK(points_by_source(store) == scan.points);
    CHECK(structure_faults(store).empty());
    CHECK(faults_of(store).empty());
    CHECK(std::to_string(store.metadata().points_hash) == adaptive_hash);
    CHECK_THAT(store.metadata().layout, StartsWith("regular:"));
  }
}

TEST_CASE("cubes of axes with very unlike scales") {
  Scan scan(cube_cloud(5000, -3000, 3000, 8));
  write_las(scan.folder / "a.las", scan.points, {{0.001, 0.01, 0.1}, {0, 0, 0}});
  scan.options.regular_size = 1.6;
  scan.convert();
  const StoreReader store(scan.options.output);
  CHECK(points_by_source(store) == scan.points);
  CHECK(structure_faults(store).empty());
  for (const Cell& cell : store.cells()) {
    const double quanta[] = {1600, 160, 16};
    for (int k = 0; k < 3; ++k) {
      CHECK(std::floor(cell.box.lo[k] / quanta[k]) == std::floor(cell.box.hi[k] / quanta[k]));
    }
  }
}

TEST_CASE("cubes too small for their cells are remarked on") {
  Scan scan(cube_cloud(2000, -3000, 3000, 8), 1000);
  scan.options.regular_size = 1.0;
  const ConversionReport report = scan.convert();
  REQUIRE(report.warnings.size() == 1);
  check_says(report.warnings[0].text, "fewer points a cell");
}

TEST_CASE("a regular layout over the whole range of the integers") {
  Scan scan(cube_cloud(5000, -2147483648LL, 2147483647LL, 8));
  scan.points.push_back({2147483647, 2147483647, 2147483647});
  scan.points.push_back({-2147483647 - 1, -2147483647 - 1, -2147483647 - 1});
  write_las(scan.folder / "a.las", scan.points);
  for (const double size : {200000.0, 2147483.648, 2147483.649, 4294967.296}) {
    CAPTURE(size);
    scan.options.regular_size = size;
    scan.convert();
    const StoreReader store(scan.options.output);
    check_cubes(store, static_cast<std::int64_t>(std::nearbyint(size * 1000)));
    CHECK(points_by_source(store) == scan.points);
  }
}

TEST_CASE("sizes of cubes that cannot be are refused") {
  Scan scan(cube_cloud(200'000, -2147483648LL, 2147483647LL, 1));
  for (const double size : {0.0, -1.0, 0.015, 1e300, std::nan("")}) {
    scan.options.regular_size = size;
    CAPTURE(size);
    check_says(conversion_refusal<UsageError>(scan.options), "a regular layout: expected cubes");
  }
  scan.options.regular_size = 1.0;
  check_says(conversion_refusal<UsageError>(scan.options), "expected larger cubes");
  check_equal(scan.files(), {"a.las"});
}

TEST_CASE("sizes of cells out of range are refused") {
  Scan scan(cube_cloud(100, -50, 50, 1));
  for (const std::uint32_t cell_points : {0u, 63u, (1u << 20) + 1}) {
    scan.options.cell_points = cell_points;
    check_says(conversion_refusal<UsageError>(scan.options), "64 to 1048576");
  }
}

TEST_CASE("too little memory is refused with the least that will do") {
  Scan scan(cube_cloud(100, -50, 50, 1));
  scan.options.memory_bytes = kLeastConversionMemory - 1;
  check_says(conversion_refusal<ResourceError>(scan.options), "at least 224.0 MiB");
  scan.options.memory_bytes = kLeastConversionMemory;
  CHECK(conversion_refusal(scan.options).empty());
}

TEST_CASE("too little memory for the index of many cells is refused before they are made") {
  std::vector<Quantum> points;  // each in a cube, and so a cell, of its own
  for (int i = 0; i < 120'000; ++i) points.push_back({i % 400 * 2000, i / 400 * 2000, 0});
  Scan scan(points);
  scan.options.regular_size = 1;
  scan.options.cell_points = 64;
  scan.options.memory_bytes = kLeastConversionMemory;
  check_says(conversion_refusal<ResourceError>(scan.options), "120000 cells need at least 227 MiB");
  check_equal(scan.files(), {"a.las"});
}

TEST_CASE("an existing output stays as it is unless it may be overwritten") {
  Scan scan(cube_cloud(100, -50, 50, 1));
  put_bytes(scan.options.output, "mine");
  scan.options.overwrite = false;
  check_says(conversion_refusal<UsageError>(scan.options), "exists already");
  check_equal(bytes_of(scan.options.output), "mine");
  scan.options.overwrite = true;
  scan.convert();
  CHECK(points_by_source(StoreReader(scan.options.output)) == scan.points);
}

TEST_CASE("an input is never overwritten by the output") {
  Scan scan(cube_cloud(100, -50, 50, 1));
  const std::string before = bytes_of(scan.folder / "a.las");
  for (const auto& input : {scan.folder / "a.las", scan.folder / ""}) {
    scan.options.inputs = {input};
    scan.options.output = scan.folder / "a.las";
    check_says(conversion_refusal<UsageError>(scan.options), "is an input too");
    CHECK(bytes_of(scan.folder / "a.las") == before);
  }
}

TEST_CASE("a failing conversion leaves nothing behind") {
  Scan scan(cube_cloud(1000, -50, 50, 1));
  const std::string las = bytes_of(scan.folder / "a.las");
  put_bytes(scan.folder / "a.las", las.substr(0, las.size() - 10));
  check_says(conversion_refusal<InputError>(scan.options), "a.las");
  check_equal(scan.files(), {"a.las"});
  put_bytes(scan.options.output, "mine");
  CHECK_FALSE(conversion_refusal<InputError>(scan.options).empty());
  check_equal(bytes_of(scan.options.output), "mine");
}

TEST_CASE("a store with points left out is converted until its inputs change, and warns of them") {
  const ScratchFolder folder;
  NoProgress progress;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  write_ply(folder / "a.ply", std::vector<Vec3>{{1, 2, 3}, {nan, 0, 0}});
  ConversionOptions options = conversion_of({folder / "a.ply"}, folder / "a.h5");
  convert_quietly(options);
  CHECK(is_converted(options, progress));
  // A strict call also takes the conversion for done, and then refuses what the store warns of.
  options.strict = true;
  CHECK(is_converted(options, progress));
  {
    const StoreReader store(options.output);
    REQUIRE(store.metadata().warnings.size() == 1);
    check_equal(store.metadata().warnings[0].code, "non-finite-points");
  }
  write_ply(folder / "a.ply", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK_FALSE(is_converted(options, progress));
  convert_quietly(options);
  CHECK(is_converted(options, progress));
}

TEST_CASE("a store in degrees is what a conversion makes that ignores the reference system") {
  const ScratchFolder folder;
  NoProgress progress;
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.global_encoding = 16;
  las.vlrs = {{"LASF_Projection", 2112,
               R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
               R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])"}};
  put_bytes(folder / "a.las", las.build());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.ignore_crs = true;
  convert_quietly(options);
  CHECK(is_converted(options, progress));
  options.ignore_crs = false;
  CHECK_FALSE(is_converted(options, progress));
}

namespace {

/// Gives a value of an option another one than the default.
void give_other(bool& value) { value = !value; }
void give_other(double& value) { value += 1; }
void give_other(int& value) { value += 1; }
void give_other(std::uint32_t& value) { value += 1; }
void give_other(std::uint64_t& value) { value += 1; }
void give_other(std::string& value) { value += "x"; }
void give_other(std::optional<double>& value) { value = 0.5; }
void give_other(FileUnit& value) { value = FileUnit::named("ft"); }
void give_other(Vec3& value) { value.y += 1; }
void give_other(std::vector<std::string>& value) { value.emplace_back("4"); }
template <typename Choice>
requires std::is_enum_v<Choice>
void give_other(Choice& value) { value = static_cast<Choice>(static_cast<int>(value) + 1); }

}  // namespace

TEST_CASE("a store has every option that shapes it, so that other options make it anew") {
  const ScratchFolder folder;
  put_bytes(folder / "some", "1 2 3\n");
  const ConversionOptions plain;
  const std::string of_plain = store_options(plain);
  std::size_t free_options = 0;
  const auto check_other = [&](const ConversionOptions& other, const std::string& key) {
    CAPTURE(key);
    const std::string differs = difference_of_options(of_plain, store_options(other));
    free_options += differs.empty() ? 1 : 0;
    CHECK(differs.empty() == shapes_no_store(key));
    CHECK((differs.empty() || differs.starts_with(key + " is ")));
  };
  for_each_field(kConvertFields, [&](const auto& field) {
    ConversionOptions other;
    if constexpr (std::is_same_v<std::decay_t<decltype(field.of(other))>, std::filesystem::path>) {
      field.of(other) = folder / "some";
    } else {
      give_other(field.of(other));
    }
    check_other(other, field.key);
  });
  for_each_field(kReadingFields, [&](const auto& field) {
    ConversionOptions other;
    give_other(field.of(other.path_options));
    check_other(other, std::string("path_") + field.key);
  });
  check_equal(free_options, 5);  // memory, threads, strict, overwrite, resume
  ConversionOptions given;
  given.near = folder / "some";
  const std::string before = store_options(given);
  put_bytes(folder / "some", "1 2 4\n");
  CHECK(store_options(given) != before);
}
