// Environments that are shifted, sampled or stretched.
#include "bench/variants/variants.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "clearway/error.hpp"
#include "io/scans/las/las_writer.hpp"
#include "io/scans/point_reader.hpp"
#include "scene/random.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare_json.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway::bench;

namespace {

namespace fs = std::filesystem;

using Quanta = std::vector<std::array<std::int32_t, 3>>;

constexpr Quantisation kQuantisation{{1e-4, 1e-4, 1e-3}, {100, -200.5, 0}};

/// Random points whose stored integers are within `reach`.
Quanta some_points(std::size_t count, std::int32_t reach) {
  Quanta out(count);
  scene::Dice dice(7, 0);
  for (auto& q : out) {
    for (auto& value : q) value = static_cast<std::int32_t>(dice.between(-1.0 * reach, reach));
  }
  return out;
}

void write_las(const fs::path& path, const Quanta& points, const std::string& crs = {}) {
  QuantumBox box{};
  for (const auto& q : points) box = box.united({{q[0], q[1], q[2]}, {q[0], q[1], q[2]}});
  const File file = File::create(path);
  LasWriter writer(
      file,
      {.quantisation = kQuantisation, .points = points.size(), .bounds = box, .crs_wkt = crs});
  writer.write(points);
  writer.finish();
}

struct Cloud {
  CloudInfo info;
  Quanta quanta;
};

Cloud read_las(const fs::path& path) {
  const auto reader = open_point_file(path);
  Cloud out{.info = reader->info(), .quanta = {}};
  for (PointBatch batch; reader->read(batch);) {
    out.quanta.insert(out.quanta.end(), batch.quanta.begin(), batch.quanta.end());
  }
  return out;
}

template <typename Value>
Value value_at(const std::string& bytes, std::size_t at) {
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("a shifted environment keeps every byte of its points") {
  const ScratchFolder folder;
  const std::string crs = GENERATE(std::string(), std::string("LOCAL_CS[\"hall\"]"));
  write_las(folder / "in.las", some_points(30'000, 400'000), crs);
  shift_environment(folder / "in.las", folder / "out.las", {500'000, -4'000'000, 0});
  const std::string in = bytes_of(folder / "in.las"), out = bytes_of(folder / "out.las");
  CHECK(in.substr(0, 155) == out.substr(0, 155));
  CHECK(in.substr(227) == out.substr(227));
  CHECK(value_at<double>(out, 155) == 500'100);
  CHECK(value_at<double>(out, 163) == -4'000'200.5);
  CHECK(value_at<double>(out, 171) == 0);
  for (const auto& [at, shift] : {std::pair{179, 5e5}, {187, 5e5}, {195, -4e6}, {203, -4e6}}) {
    CHECK(value_at<double>(out, at) == value_at<double>(in, at) + shift);
  }
  CHECK(in.substr(211, 16) == out.substr(211, 16));
  CHECK(read_las(folder / "out.las").quanta == read_las(folder / "in.las").quanta);

  shift_environment(folder / "out.las", folder / "back.las", {-500'000, 4'000'000, 0});
  CHECK(bytes_of(folder / "back.las").substr(0, 179) == in.substr(0, 179));
}

TEST_CASE("a shifted environment keeps records behind its points") {
  const ScratchFolder folder;
  LasBytes las;
  las.minor = 4;
  las.format = 7;
  las.extra_bytes = 3;
  las.padding = 5;
  las.vlrs = {{"somebody", 17, "anything"}};
  las.evlrs = {{"somebody", 18, std::string(300'000, 'e')}};
  put_bytes(folder / "in.las", las.build());
  shift_environment(folder / "in.las", folder / "out.las", {1, 2, 3});
  las.offset = {101, -198, 3};
  const std::string expected = las.build(), out = bytes_of(folder / "out.las");
  CHECK(out.substr(0, 179) == expected.substr(0, 179));
  CHECK(out.substr(227) == expected.substr(227));
}

TEST_CASE("shifts that would round are refused, and an input as output") {
  const ScratchFolder folder;
  write_las(folder / "in.las", some_points(10, 1000));
  const std::string before = bytes_of(folder / "in.las");
  const double nan = std::nan("");
  for (const Vec3& shift :
       {Vec3{0.5, 0, 0}, Vec3{0, nan, 0}, Vec3{0, 0x1p53, 0}, Vec3{0, 0, INFINITY}}) {
    CHECK_THROWS_AS(shift_environment(folder / "in.las", folder / "out.las", shift), UsageError);
  }
  CHECK(!fs::exists(folder / "out.las"));
  CHECK_THROWS_AS(shift_environment(folder / "in.las", folder / "in.las", {1, 0, 0}), UsageError);
  check_same(bytes_of(folder / "in.las"), before);
  put_bytes(folder / "cut.las", before.substr(0, before.size() - 1));
  CHECK_THROWS_AS(shift_environment(folder / "cut.las", folder / "out.las", {1, 0, 0}), InputError);
  CHECK_THROWS_AS(shift_environment(folder / "none.las", folder / "out.las", {1, 0, 0}),
                  ResourceError);
}

TEST_CASE("a sample of an environment has the size asked for, in order") {
  const ScratchFolder folder;
  Quanta points = some_points(30'000, 400'000);
  for (std::size_t i = 0; i < points.size(); ++i) points[i][0] = static_cast<std::int32_t>(i);
  write_las(folder / "in.las", points);
  const std::size_t wanted = GENERATE(0u, 1u, 2u, 13'107u, 15'000u, 29'999u, 30'000u);
  sample_environment(folder / "in.las", folder / "out.las", wanted, 5);
  const Cloud sample = read_las(folder / "out.las");
  REQUIRE(sample.quanta.size() == wanted);
  CHECK(fs::file_size(folder / "out.las") == 227 + 20 * wanted);
  CHECK(*sample.info.quantisation == kQuantisation);
  std::int32_t last = -1;
  for (const auto& q : sample.quanta) {
    REQUIRE(q[0] > last);
    last = q[0];
    REQUIRE(q == points[last]);
  }
  const std::string bytes = bytes_of(folder / "out.las");
  CHECK(value_at<std::uint32_t>(bytes, 111) == wanted);
  if (wanted == points.size()) CHECK(bytes == bytes_of(folder / "in.las"));

  sample_environment(folder / "in.las", folder / "again.las", wanted, 5);
  check_same(bytes_of(folder / "again.las"), bytes);
  sample_environment(folder / "in.las", folder / "other.las", wanted, 6);
  const bool only_one = wanted == 0 || wanted == points.size();
  CHECK((bytes_of(folder / "other.las") == bytes) == only_one);
}

TEST_CASE("a sample is spread evenly") {
  const ScratchFolder folder;
  constexpr std::size_t kPoints = 160'000, kParts = 16;
  Quanta points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) points[i][0] = static_cast<std::int32_t>(i);
  write_las(folder / "in.las", points);
  sample_environment(folder / "in.las", folder / "out.las", kPoints / 4, 9);
  std::array<int, kParts> taken{};
  for (const auto& q : read_las(folder / "out.las").quanta) ++taken[q[0] / (kPoints / kParts)];
  // Each point is expected 2500 times, with a standard deviation of 42.
  CHECK(*std::min_element(taken.begin(), taken.end()) > 2300);
  CHECK(*std::max_element(taken.begin(), taken.end()) < 2700);
}

TEST_CASE("a sample of LAS 1.4 keeps whole records") {
  const ScratchFolder folder;
  write_las(folder / "in.las", some_points(20'000, 1000), "LOCAL_CS[\"hall\"]");
  sample_environment(folder / "in.las", folder / "out.las", 20'000, 1);
  check_same(bytes_of(folder / "out.las"), bytes_of(folder / "in.las"));
  sample_environment(folder / "in.las", folder / "out.las", 12'345, 1);
  const Cloud sample = read_las(folder / "out.las");
  CHECK(sample.quanta.size() == 12'345);
  CHECK(sample.info.crs_wkt == "LOCAL_CS[\"hall\"]");
  const std::string bytes = bytes_of(folder / "out.las");
  CHECK(value_at<std::uint32_t>(bytes, 107) == 0);
  CHECK(value_at<std::uint64_t>(bytes, 247) == 12'345);
  CHECK(value_at<std::uint64_t>(bytes, 255) == 12'345);
}

TEST_CASE("samples that cannot be taken are refused") {
  const ScratchFolder folder;
  write_las(folder / "in.las", some_points(10, 1000));
  CHECK_THROWS_AS(sample_environment(folder / "in.las", folder / "out.las", 11, 1), UsageError);
  LasBytes las;
  las.minor = 4;
  las.evlrs = {{"somebody", 18, "behind"}};
  put_bytes(folder / "tail.las", las.build());
  CHECK_THROWS_WITH(sample_environment(folder / "tail.las", folder / "out.las", 1, 1),
                    Contains("behind its points"));
  CHECK(!fs::exists(folder / "out.las"));
}

TEST_CASE("a stretched environment keeps its points, and its box is as long as asked for") {
  const ScratchFolder folder;
  const double factor = GENERATE(1.0, 2.5, 1000.0);
  Quanta points = some_points(20'000, 1'000'000);
  points.push_back({1'000'001, 1'000'001, 1'000'001});  // makes the centre no integer
  points.push_back({-1'000'000, -1'000'000, -1'000'000});
  write_las(folder / "in.las", points);
  CHECK(stretch_environment(folder / "in.las", folder / "out.las", factor) == 1);
  const Cloud out = read_las(folder / "out.las");
  REQUIRE(out.quanta.size() == points.size() + kStrayPoints);
  CHECK(*out.info.quantisation == kQuantisation);
  CHECK(std::equal(points.begin(), points.end(), out.quanta.begin()));
  const std::set corners(out.quanta.end() - kStrayPoints, out.quanta.end());
  CHECK(corners.size() == kStrayPoints);
  for (const auto& corner : corners) {
    for (const std::int32_t value : corner) {
      CHECK(std::abs(std::abs(value - 0.5) - factor * 1'000'000.5) <= 0.5);
    }
  }
}

TEST_CASE("a box too large for 32 bits is stretched on one coarser scale") {
  const ScratchFolder folder;
  Quanta points = some_points(1000, 2'000'000'000);
  points.push_back({2'000'000'000, 15, -15});
  points.push_back({-2'000'000'000, 25, -25});
  write_las(folder / "in.las", points);
  for (const double factor : {1.0, 17.0, 1000.0}) {
    CHECK(stretch_environment(folder / "in.las", folder / "out.las", factor) == 1000);
    const Cloud out = read_las(folder / "out.las");
    const Quantisation& coarse = *out.info.quantisation;
    REQUIRE(out.quanta.size() == points.size() + kStrayPoints);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const double moved =
            coordinate(coarse, k, out.quanta[i][k]) - coordinate(kQuantisation, k, points[i][k]);
        REQUIRE(std::abs(moved) <= 500.01 * kQuantisation.scale[k]);
      }
    }
    for (int k = 0; k < 3; ++k) {
      CHECK(coarse.scale[k] == 1000 * kQuantisation.scale[k]);
      CHECK(coarse.offset[k] == kQuantisation.offset[k]);
    }
    CHECK(out.quanta.back()[0] == std::lround(factor * 2'000'000));
  }
}

TEST_CASE("stretches that make no sense are refused") {
  const ScratchFolder folder;
  write_las(folder / "in.las", some_points(10, 1000));
  for (const double factor : {0.5, 1001.0, std::nan("")}) {
    CHECK_THROWS_AS(stretch_environment(folder / "in.las", folder / "out.las", factor), UsageError);
  }
  write_las(folder / "empty.las", {});
  CHECK_THROWS_AS(stretch_environment(folder / "empty.las", folder / "out.las", 2), InputError);
}
