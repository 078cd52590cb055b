// Stores that conversions make, and what is refused.
#include "io/store/convert/convert.hpp"

#include <functional>

#include "io/store/convert/conversion_identity.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/store_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/store_order.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The conversion of one LAS file.
struct OneScan : Conversion {
  explicit OneScan(std::vector<Quantum> cloud, std::uint32_t cell_points = 64)
      : Conversion(cell_points), points(std::move(cloud)) {
    add_las("a.las", points);
  }

  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }

  std::vector<Quantum> points;
};

/// Checks that a bucket's points, and so a cell's, lie in one cube. quanta: of the cube's sides.
void check_cubes(const StoreReader& store, const std::array<std::int64_t, 3>& quanta) {
  const auto cube_of = [&](const Quantum& q) {
    std::array<std::int64_t, 3> cube{};
    for (std::size_t k = 0; k < 3; ++k) {
      cube[k] = (std::int64_t{q[k]} + 1'000'000 * quanta[k]) / quanta[k];  // rounded down
    }
    return cube;
  };
  for (const TopNode& node : store.top_tree()) {
    if (node.right != 0) continue;
    const auto points = points_of_cells(store, node.first_cell, node.cell_count);
    for (const StoredPoint& p : points) REQUIRE(cube_of(p.q) == cube_of(points[0].q));
  }
}

/// Checks a regular layout with cubes of this size.
void check_regular(OneScan& scan, double size, const std::array<std::int64_t, 3>& quanta) {
  CAPTURE(size);
  scan.options.regular_size = size;
  const StoreReader store = scan.store();
  check_cubes(store, quanta);
  CHECK(points_by_source(store) == scan.points);
  CHECK(structure_faults(store).empty());
  CHECK_THAT(store.metadata().layout, StartsWith("regular:"));
}

}  // namespace

TEST_CASE("the store is the same whatever threads, memory and repetition") {
  OneScan scan(hard_clouds(70000, 5)[6].points, 1000);
  const std::string bytes = scan.converted_bytes();
  for (const auto& [threads, mebibytes] : {std::pair{2, 224}, {1, 224}, {2, 512}, {4, 4096}}) {
    scan.options.threads = threads;
    scan.options.memory_bytes = std::uint64_t(mebibytes) << 20;
    CHECK(scan.converted_bytes() == bytes);
  }
  check_equal(scan.files(), {"a.h5", "a.las"});
}

TEST_CASE("a store says what it holds") {
  const OneScan scan(cube_cloud(777, -5000, 5000, 1), 100);
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
  const StoreReader store = OneScan({}).store();
  check_equal(store.point_count(), 0);
  CHECK(store.cells().empty());
  CHECK(store.tree().empty());
}

TEST_CASE("regular layouts keep to their cubes on both sides of the origin") {
  OneScan scan(cube_cloud(20000, -3000, 3000, 8));
  const std::uint64_t adaptive_hash = scan.store().metadata().points_hash;
  for (const std::int64_t quanta : {16, 17, 1000, 1024, 3001, 10000}) {
    check_regular(scan, static_cast<double>(quanta) * 0.001, {quanta, quanta, quanta});
    CHECK(StoreReader(scan.options.output).metadata().points_hash == adaptive_hash);
  }
  // Axes with very unlike scales.
  scan.add_las("a.las", scan.points, {{0.001, 0.01, 0.1}, {0, 0, 0}});
  check_regular(scan, 1.6, {1600, 160, 16});
}

TEST_CASE("a regular layout over the whole range of the integers") {
  OneScan scan(cube_cloud(5000, -2147483648LL, 2147483647LL, 8));
  scan.points.push_back({2147483647, 2147483647, 2147483647});
  scan.points.push_back({-2147483647 - 1, -2147483647 - 1, -2147483647 - 1});
  scan.add_las("a.las", scan.points);
  for (const std::int64_t q : {200'000'000LL, 2'147'483'648LL, 2'147'483'649LL, 4'294'967'296LL}) {
    check_regular(scan, static_cast<double>(q) * 0.001, {q, q, q});
  }
}

TEST_CASE("cubes too small for their cells are remarked on") {
  OneScan scan(cube_cloud(2000, -3000, 3000, 8), 1000);
  scan.options.regular_size = 1.0;
  const ConversionReport report = scan.convert();
  REQUIRE(report.warnings.size() == 1);
  check_says(report.warnings[0].text, "fewer points a cell");
}

TEST_CASE("sizes of cubes and cells, memory and outputs that cannot be are refused") {
  OneScan scan(cube_cloud(200'000, -2147483648LL, 2147483647LL, 1));
  const std::string las = bytes_of(scan.folder / "a.las");
  const ConversionOptions sound = scan.options;
  const auto check = [&](const char* words, const std::function<void(ConversionOptions&)>& change) {
    scan.options = sound;
    change(scan.options);
    check_says(scan.refusal<UsageError>(), words);
    CHECK(bytes_of(scan.folder / "a.las") == las);
    CHECK(scan.files().front() == "a.las");
  };
  for (const double size : {0.0, -1.0, 0.015, 1e300, std::nan("")}) {
    check("a regular layout: expected cubes", [&](auto& options) { options.regular_size = size; });
  }
  check("expected larger cubes", [](auto& options) { options.regular_size = 1; });
  for (const std::uint32_t cell_points : {0u, 63u, (1u << 20) + 1}) {
    check("64 to 1048576", [&](auto& options) { options.cell_points = cell_points; });
  }
  for (const auto& input : {scan.folder / "a.las", scan.folder / ""}) {
    check("is an input too", [&](auto& options) {
      options.inputs = {input};
      options.output = scan.folder / "a.las";
    });
  }
}

TEST_CASE("too little memory is refused with the least that will do") {
  std::vector<Quantum> points;  // each in a cube, and so a cell, of its own
  for (int i = 0; i < 120'000; ++i) points.push_back({i % 400 * 2000, i / 400 * 2000, 0});
  OneScan scan(points);
  scan.options.memory_bytes = kLeastConversionMemory - 1;
  check_says(scan.refusal<ResourceError>(), "at least 224.0 MiB");
  scan.options.memory_bytes = kLeastConversionMemory;
  scan.options.regular_size = 1;
  check_says(scan.refusal<ResourceError>(), "120000 cells need at least 229 MiB");
  check_equal(scan.files(), {"a.las"});
  scan.options.regular_size.reset();
  check_equal(scan.refusal<Error>(), "");
}

TEST_CASE("an existing output stays as it is unless it may be overwritten, by a whole store") {
  OneScan scan(cube_cloud(1000, -50, 50, 1));
  put_bytes(scan.options.output, "mine");
  scan.options.overwrite = false;
  check_says(scan.refusal<UsageError>(), "exists already");
  scan.options.overwrite = true;
  const std::string las = bytes_of(scan.folder / "a.las");
  scan.add("a.las", las.substr(0, las.size() - 10));
  check_says(scan.refusal(), "a.las");
  check_equal(bytes_of(scan.options.output), "mine");
  check_equal(scan.files(), {"a.h5", "a.las"});
  scan.add("a.las", las);
  CHECK(points_by_source(scan.store()) == scan.points);
}

TEST_CASE("a store is that of its inputs and options until these change") {
  Conversion conversion;
  ConversionOptions& options = conversion.options;
  conversion.add_ply("a.ply", std::vector<Vec3>{{1, 2, 3}, {std::nan(""), 0, 0}});
  CHECK_FALSE(is_converted_by(options));
  check_equal(codes_of(conversion.store().metadata().warnings), "non-finite-points");
  CHECK(is_converted_by(options));
  // A strict call also takes the conversion for done, and then refuses what the store warns of.
  options.strict = true;
  CHECK(is_converted_by(options));
  options.strict = false;
  options.keep_withheld = true;
  CHECK_FALSE(is_converted_by(options));
  options.keep_withheld = false;
  conversion.add_ply("a.ply", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK_FALSE(is_converted_by(options));
  conversion.convert();
  CHECK(is_converted_by(options));
  // The poses beside scans of 3DTK are inputs too, and files that cannot be read are none.
  conversion.add("scan000.3d", "0 0 100\n");
  put_bytes(conversion.folder / "scan000.pose", "0 0 0\n0 0 0\n");
  conversion.add("b.xyz", "no point\n");
  options.skip_unreadable = true;
  conversion.convert();
  CHECK(is_converted_by(options));
  put_bytes(conversion.folder / "scan000.pose", "0 0 1\n0 0 0\n");
  CHECK_FALSE(is_converted_by(options));
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
