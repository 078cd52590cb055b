// Stores of the points near a path: what they keep, and what they say of it.
#include "core/trajectory/corridor.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "support/bytes/laz/laz_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A conversion of the points near a path, and beside it that of all points.
struct NearConversion : Conversion {
  NearConversion(const std::vector<Vec3>& near_path, double within) : path(near_path) {
    std::string text;
    char line[200];
    for (const Vec3& p : path) {
      std::snprintf(line, sizeof line, "1 0 0 %.17g 0 1 0 %.17g 0 0 1 %.17g 0 0 0 1\n", p.x, p.y,
                    p.z);
      text += line;
    }
    options.near = folder.write("path.txt", text);
    options.within = within;
  }

  /// Checks that the store has exactly the points of the whole store within a distance of the path,
  /// by the corridor's definition.
  ConversionReport check() const {
    ConversionOptions of_all = conversion_of(options.inputs, folder / "all.h5");
    convert_quietly(of_all);
    const ConversionReport report = convert();
    const StoreReader whole(of_all.output), near(options.output);
    const Corridor corridor(path, options.within);
    std::vector<StoredPoint> expected = by_source(whole);
    std::erase_if(expected, [&](const StoredPoint& p) {
      return !corridor.holds(position(whole.quantisation(), p.q[0], p.q[1], p.q[2]));
    });
    CHECK((by_source(near) == expected));
    CHECK(report.points == expected.size());
    CHECK(report.far_points == whole.point_count() - expected.size());
    CHECK(near.quantisation() == whole.quantisation());
    CHECK((near.bounds() == whole.bounds() || report.unread_points > 0));
    CHECK(near.bounds().hi.x >= whole.bounds().hi.x - 0.1);
    CHECK(near.metadata().near.value().path == path);
    CHECK(near.metadata().input_points == whole.point_count());
    check_equal(near.metadata().points_without_place(), 0);
    CHECK((near.metadata().near->unread_bytes > 0) == (report.unread_points > 0));
    return report;
  }

  static std::vector<StoredPoint> by_source(const StoreReader& store) {
    std::vector<StoredPoint> points = stored_points(store);
    std::ranges::sort(points, {}, &StoredPoint::source);
    return points;
  }

  std::vector<Vec3> path;
};

}  // namespace

TEST_CASE("a store of points near a path keeps those of the whole store, with their numbers") {
  Random random(20261128);
  for (int scene = 0; scene < 12; ++scene) {
    INFO("scene " << scene);
    std::vector<Quantum> points;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      points.push_back({static_cast<std::int32_t>(500 * below(random, 40)),
                        static_cast<std::int32_t>(500 * below(random, 20)),
                        static_cast<std::int32_t>(500 * below(random, 5))});
    }
    std::vector<Vec3> path{{102, -198, 0.5}};
    for (std::uint64_t i = below(random, 30); i > 0; --i) {
      const Vec3 step{uniform(random, 0, 1), uniform(random, -0.5, 0.7), 0};
      path.push_back(path.back() + step);
    }
    NearConversion conversion(path, 1.5);
    conversion.add_las("a.las", points);
    conversion.check();
  }
}

TEST_CASE("coordinates without steps get those of the whole scan") {
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i) points.push_back({i * 0.37, i * 11.3, 3000.0 * (i == 499)});
  NearConversion conversion({{0, 0, 0}, {3, 90, 0}}, 5);
  conversion.add_ply("a.ply", points);
  conversion.check();
}

TEST_CASE("a corridor without any point, a distance alone and a path alone are refused") {
  NearConversion conversion({{0, 0, 0}}, 2);
  conversion.add_las("a.las", std::vector<Quantum>{{0, 0, 0}, {1, 1, 1}});
  check_says(conversion.refusal(), "none of the 2 points ... within 2 of its path");
  conversion.options.within = 0;
  check_says(conversion.refusal<UsageError>(), "expected the distance");
  conversion.options.near.clear();
  conversion.options.within = 2;
  check_says(conversion.refusal<UsageError>(), "expected the path");
}

TEST_CASE("files are passed over by their bounds where these are to be trusted") {
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
  NearConversion conversion({{100, -200, 0}}, 1);
  conversion.add("a.las", las_at(10'000, 70));
  conversion.add("b.las", las_at(0, 50));
  const ConversionReport read = conversion.check();
  check_equal(read.passed_over_files, 0);
  check_equal(read.points, 50);
  conversion.options.trust_bounds = true;
  const ConversionReport trusted = conversion.check();
  check_equal(trusted.passed_over_files, 1);
  check_equal(trusted.unread_points, 70);

  // Bounds that no writer filled in say nothing.
  const auto check_read = [&](double lo, double hi, unsigned axes) {
    CAPTURE(lo, hi, axes);
    std::string bytes = las_at(10'000, 70);
    for (unsigned k = 0; k < axes; ++k) {
      LasBytes::put(bytes, 179 + 16 * k, hi);
      LasBytes::put(bytes, 187 + 16 * k, lo);
    }
    NearConversion near({{200, -200, 0}}, 1);
    near.add("a.las", bytes);
    near.options.trust_bounds = true;
    check_equal(near.convert().unread_points, 0);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  check_read(1e300, -1e300, 3);
  check_read(2, 1, 1);
  check_read(kNaN, kNaN, 2);
  check_read(0, 0, 3);
  check_read(0, 0, 1);
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

TEST_CASE("nodes of COPC far from the path are not read, unless the hierarchy is damaged") {
  NearConversion conversion({{0.2, 0.2, 0.2}}, 1.5);
  std::string said;
  conversion.options.message = [&](const Message& message) { said += message.text + "\n"; };
  const auto check = [&](const std::string& bytes, std::uint64_t unread, const std::string& words) {
    said.clear();
    conversion.add("a.copc.laz", bytes);
    check_equal(conversion.check().unread_points, unread);
    check_says(said, words);
    if (unread > 0) check_lacks(said, "COPC");
  };
  check(copc_bytes(), 10, "no unit");
  check(copc_bytes(false), 0, "COPC hierarchy is damaged ... read without the hierarchy");
  // A node outside of the cube of its file is damage too.
  check(copc_bytes(true, 8), 0, "COPC hierarchy is damaged");
}
