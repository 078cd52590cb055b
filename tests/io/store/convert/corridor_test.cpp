// Stores of the points near a path: what they keep, and what they say of it.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <tuple>

#include "support/bytes/laz/laz_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::string text_of(const std::vector<Vec3>& path) {
  std::string text;
  char line[200];
  for (const Vec3& p : path) {
    std::snprintf(line, sizeof line, "1 0 0 %.17g 0 1 0 %.17g 0 0 1 %.17g 0 0 0 1\n", p.x, p.y,
                  p.z);
    text += line;
  }
  return text;
}

ConversionOptions near_of(const ScratchFolder& folder, const std::vector<Vec3>& path, double within,
                          std::vector<std::filesystem::path> inputs) {
  ConversionOptions options = conversion_of(std::move(inputs), folder / "near.h5");
  options.near = folder.write("path.txt", text_of(path));
  options.within = within;
  options.overwrite = true;
  return options;
}

/// The points of a store within a distance of a path, by the corridor's definition.
std::vector<StoredPoint> kept_of(const StoreReader& all, const Corridor& corridor) {
  std::vector<StoredPoint> kept;
  for (const StoredPoint& point : stored_points(all)) {
    const auto& q = point.q;
    if (corridor.holds(position(all.quantisation(), q[0], q[1], q[2]))) kept.push_back(point);
  }
  std::ranges::sort(kept, {}, &StoredPoint::source);
  return kept;
}

std::vector<StoredPoint> by_source(const StoreReader& store) {
  std::vector<StoredPoint> points = stored_points(store);
  std::ranges::sort(points, {}, &StoredPoint::source);
  return points;
}

}  // namespace

TEST_CASE("a store of points near a path keeps those of the whole store, with their numbers") {
  Random random(20261128);
  const ScratchFolder folder;
  for (int scene = 0; scene < 12; ++scene) {
    std::vector<Quantum> points;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      points.push_back({static_cast<std::int32_t>(500 * below(random, 40)),
                        static_cast<std::int32_t>(500 * below(random, 20)),
                        static_cast<std::int32_t>(500 * below(random, 5))});
    }
    write_las(folder / "a.las", points);
    std::vector<Vec3> path{{102, -198, 0.5}};
    for (std::uint64_t i = below(random, 30); i > 0; --i) {
      const Vec3 step{uniform(random, 0, 1), uniform(random, -0.5, 0.7), 0};
      path.push_back(path.back() + step);
    }
    ConversionOptions all = conversion_of({folder / "a.las"}, folder / "all.h5");
    all.overwrite = true;
    convert_quietly(all);
    const ConversionOptions options = near_of(folder, path, 1.5, {folder / "a.las"});
    const ConversionReport report = convert_quietly(options);
    const StoreReader whole(all.output), near(options.output);
    const std::vector<StoredPoint> expected = kept_of(whole, Corridor(path, 1.5));
    INFO("scene " << scene);
    CHECK((by_source(near) == expected));
    check_equal(report.points, std::uint64_t{expected.size()});
    check_equal(report.far_points, 3000 - std::uint64_t{expected.size()});
    CHECK(near.quantisation() == whole.quantisation());
    CHECK((near.bounds() == whole.bounds()));
    REQUIRE(near.metadata().near);
    CHECK((near.metadata().near->path == path));
    check_equal(near.metadata().input_points, std::uint64_t{3000});
    check_equal(near.metadata().points_without_place(), std::uint64_t{0});
  }
}

TEST_CASE("coordinates without steps get those of the whole scan") {
  const ScratchFolder folder;
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i) points.push_back({i * 0.37, i * 11.3, 3000.0 * (i == 499)});
  write_ply(folder / "a.ply", points);
  ConversionOptions all = conversion_of({folder / "a.ply"}, folder / "all.h5");
  convert_quietly(all);
  const ConversionOptions options = near_of(folder, {{0, 0, 0}, {3, 90, 0}}, 5, {folder / "a.ply"});
  convert_quietly(options);
  const StoreReader whole(all.output), near(options.output);
  CHECK(near.quantisation() == whole.quantisation());
  CHECK((by_source(near) == kept_of(whole, Corridor({{0, 0, 0}, {3, 90, 0}}, 5))));
}

TEST_CASE("a corridor without any point, a distance alone and a path alone are refused") {
  const ScratchFolder folder;
  write_las(folder / "a.las", std::vector<Quantum>{{0, 0, 0}, {1, 1, 1}});
  ConversionOptions options = near_of(folder, {{0, 0, 0}}, 2, {folder / "a.las"});
  check_says(conversion_refusal<InputError>(options),
             "none of the 2 points ... within 2 of its path");
  options.within = 0;
  check_says(conversion_refusal<UsageError>(options), "expected the distance");
  options.near.clear();
  options.within = 2;
  check_says(conversion_refusal<UsageError>(options), "expected the path");
}

TEST_CASE("files are passed over by their bounds where these are to be trusted") {
  const ScratchFolder folder;
  const auto las_at = [](std::int32_t x, std::int32_t count) {
    LasBytes las;
    las.scale = {0.01, 0.01, 0.01};
    las.points.clear();
    for (std::int32_t i = 0; i < count; ++i) las.points.push_back({x + i, 0, 0});
    std::string bytes = las.build();
    const double lo = 100 + 0.01 * x;
    const double bounds[6]{lo + 0.01 * count, lo, -200, -200, 0, 0};
    for (unsigned k = 0; k < 6; ++k) LasBytes::put(bytes, 179 + 8 * k, bounds[k]);
    return bytes;
  };
  folder.write("a.las", las_at(10'000, 70));
  folder.write("b.las", las_at(0, 50));
  ConversionOptions options =
      near_of(folder, {{100, -200, 0}}, 1, {folder / "a.las", folder / "b.las"});
  const ConversionReport read = convert_quietly(options);
  check_equal(read.passed_over_files, std::uint64_t{0});
  const auto points = by_source(StoreReader(options.output));
  options.trust_bounds = true;
  const ConversionReport trusted = convert_quietly(options);
  check_equal(trusted.passed_over_files, std::uint64_t{1});
  check_equal(trusted.unread_points, std::uint64_t{70});
  const StoreReader store(options.output);
  CHECK((by_source(store) == points));
  check_equal(points.front().source, std::uint64_t{70});
  CHECK(store.metadata().near->unread_bytes > 0);

  // Bounds that no writer filled in say nothing.
  const auto unread = [&](double lo, double hi, unsigned axes) {
    std::string bytes = las_at(10'000, 70);
    for (unsigned k = 0; k < axes; ++k) {
      LasBytes::put(bytes, 179 + 16 * k, hi);
      LasBytes::put(bytes, 187 + 16 * k, lo);
    }
    folder.write("a.las", bytes);
    ConversionOptions near = near_of(folder, {{200, -200, 0}}, 1, {folder / "a.las"});
    near.trust_bounds = true;
    return convert_quietly(near).unread_points;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [lo, hi, axes] : std::vector<std::tuple<double, double, unsigned>>{
           {1e300, -1e300, 3}, {2, 1, 1}, {kNaN, kNaN, 2}, {0, 0, 3}, {0, 0, 1}}) {
    CAPTURE(lo, hi, axes);
    check_equal(unread(lo, hi, axes), std::uint64_t{0});
  }
}

namespace {

/// A COPC file of three nodes with a chunk each: the root's points are all over the cube, the two
/// others fill one of its corners each. last_key: place along x of the last one, of eight.
std::string copc_bytes(bool sound = true, std::int32_t last_key = 7) {
  LazBytes laz = laz_bytes(6, 30);
  laz.las.minor = 4;
  laz.las.scale = {0.01, 0.01, 0.01};
  laz.las.offset = {0, 0, 0};
  laz.variable = true;
  laz.chunks = {10, 10, 10};
  for (std::size_t i = 0; i < laz.points.size(); ++i) {
    const auto at = static_cast<std::int32_t>(i % 10);
    const std::int32_t corner = i < 10 ? at * 100 : i < 20 ? at * 10 : 900 + at * 10;
    laz.points[i].position = {corner, corner, corner};
  }
  std::string info(160, '\0');
  for (unsigned k = 0; k < 4; ++k) LasBytes::put(info, 8 * k, 5.0);  // a cube from 0 to 10
  laz.las.vlrs.insert(laz.las.vlrs.begin(), {"copc", 1, info});
  const std::vector<std::uint64_t> chunk_begins = laz.chunk_begins();
  std::string page;
  const std::int32_t keys[3][4] = {{0, 0, 0, 0}, {3, 0, 0, 0}, {3, last_key, 7, 7}};
  for (std::size_t i = 0; i < 3; ++i) {
    std::string entry(32, '\0');
    for (unsigned k = 0; k < 4; ++k) LasBytes::put(entry, 4 * k, keys[i][k]);
    LasBytes::put(entry, 16, chunk_begins[i] + (sound ? 0 : 1));
    LasBytes::put<std::int32_t>(entry, 24, 1);
    LasBytes::put<std::int32_t>(entry, 28, 10);
    page += entry;
  }
  laz.las.evlrs = {{"copc", 1000, page}};
  std::string bytes = laz.build();
  const std::uint64_t payload = bytes.size() - page.size();
  const std::size_t info_at = 375 + 54;
  LasBytes::put(bytes, info_at + 40, payload);
  LasBytes::put(bytes, info_at + 48, std::uint64_t{page.size()});
  return bytes;
}

}  // namespace

TEST_CASE("nodes of COPC far from the path are not read") {
  const ScratchFolder folder;
  folder.write("a.copc.laz", copc_bytes());
  const std::vector<std::filesystem::path> inputs{folder / "a.copc.laz"};
  ConversionOptions all = conversion_of(inputs, folder / "all.h5");
  convert_quietly(all);
  const ConversionOptions options = near_of(folder, {{0.2, 0.2, 0.2}}, 1.5, inputs);
  const ConversionReport report = convert_quietly(options);
  check_equal(report.unread_points, std::uint64_t{10});
  const StoreReader near(options.output);
  CHECK((by_source(near) == kept_of(StoreReader(all.output), Corridor({{0.2, 0.2, 0.2}}, 1.5))));
  CHECK(near.metadata().near->unread_bytes > 0);
  CHECK(near.bounds().hi.x >= 9.9);
}

TEST_CASE("a damaged COPC hierarchy is not used, and said to be so") {
  const ScratchFolder folder;
  folder.write("a.copc.laz", copc_bytes(false));
  const ConversionOptions options =
      near_of(folder, {{0.2, 0.2, 0.2}}, 1.5, {folder / "a.copc.laz"});
  std::string said;
  ConversionOptions heard = options;
  heard.message = [&](const Message& message) { said += message.text + "\n"; };
  const ConversionReport report = convert_quietly(heard);
  check_equal(report.unread_points, std::uint64_t{0});
  check_says(said, "COPC hierarchy is damaged ... read without the hierarchy");
}

TEST_CASE("a node of COPC outside of the cube of its file is damage") {
  const ScratchFolder folder;
  folder.write("a.copc.laz", copc_bytes(true, 8));
  const ConversionOptions options =
      near_of(folder, {{0.2, 0.2, 0.2}}, 1.5, {folder / "a.copc.laz"});
  check_equal(convert_quietly(options).unread_points, std::uint64_t{0});
}
