#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/line.hpp"
#include "clearway/store.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Height = std::function<double(double x, double y)>;

/// A folder with the store of a surface over 30 m by 6 m, about y = 1000, and a line along it.
struct Site {
  explicit Site(const Height& height, double unit = 1) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> x(-1, 31), y(-3, 3), error(-0.004, 0.004);
    std::vector<Vec3> points;
    for (int i = 0; i < 60'000; ++i) {
      const double at = x(random), aside = y(random), z = height(at, aside) + error(random);
      if (!std::isnan(z)) points.push_back((1 / unit) * Vec3{at, 1000 + aside, z});
    }
    write_ply(folder / "a.ply", points);
    ConversionOptions options = conversion_of({folder / "a.ply"}, folder / "a.h5", 1024);
    options.scale = 0.001;
    if (unit != 1) options.unit = FileUnit::named("ift");
    convert_quietly(options);
  }

  std::vector<Pose> poses(const std::string& line, LineOptions options = {}) {
    remarks.clear();
    labels = {};
    put_bytes(folder / "line.csv", line);
    const Store store(folder / "a.h5");
    options.ground = &store;
    if (!options.track) options.track = 1.8;
    return read_line(folder / "line.csv", options, &remarks, &labels);
  }

  std::string refusal(const std::string& line, const LineOptions& options = {}) {
    try {
      poses(line, options);
      return "read";
    } catch (const Error& error) {
      return error.what();
    }
  }

  std::string codes() const { return codes_of(remarks); }

  ScratchFolder folder;
  std::vector<Message> remarks;
  PoseLabels labels;
};

const std::string kLine = "x,y,station\n0,1000,50\n15,1000,65\n30,1000,80\n";
constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("a path on sloping ground has its height, climb and roll") {
  // 5 % up along the line, and 10 % up to the left of it.
  Site site([](double x, double y) { return 7 + 0.05 * x + 0.1 * y; });
  const auto poses = site.poses(kLine);
  check_equal(site.codes(), "note on-ground");
  check_says(site.remarks[0].text,
             "at 61 of 61 places on the left ... 61 of 61 on the right ... 0.3 m too high");
  REQUIRE(poses.size() == 301);
  check_equal(site.labels.station.front(), 50);
  check_equal(site.labels.station.back(), 80);
  double climb = 0;
  for (const Pose& pose : poses) {
    check_near(pose.translation[2], 7 + 0.05 * pose.translation[0], 0.01);
    check_near(pose.rotation[7], 0.1, 0.01);
    climb += pose.rotation[6] / static_cast<double>(poses.size());
    CHECK(pose.rotation[0] > 0.99);
    CHECK(pose.rotation[8] > 0.99);
  }
  CHECK(climb == Approx(0.05).epsilon(0.02));
  const auto corner =
      site.poses("x,y\n0,999\n20,999\n20,1002\n", {.corner_radius = 2, .track = 0.8});
  check_equal(site.codes(), "note line-rounded, note on-ground");
  for (const Pose& pose : corner) {
    const Vec3 at = pose.position();
    check_near(at.z, 7 + 0.05 * at.x + 0.1 * (at.y - 1000), 0.02);
  }
  const auto back = site.poses(kLine, {.reverse = true});
  CHECK(back.front().translation[2] == poses.back().translation[2]);
  CHECK(back.front().rotation[7] == -poses.back().rotation[7]);
}

TEST_CASE("roll that the ground gives is not judged as cant") {
  // Level ground, and one that falls to the outside of the line's bend.
  for (const double slope : {0.0, 0.1}) {
    CAPTURE(slope);
    Site site([&](double, double y) { return 7 + slope * y; });
    site.poses("x,y\n0,1001\n7.5,999.9\n15,999.5\n22.5,999.9\n30,1001\n");
    check_lacks(site.codes(), "cant-");
  }
}

TEST_CASE("a store in feet has its ground in metres, and its unit counts") {
  const Height ground = [](double x, double y) { return 7 + 0.05 * x + 0.1 * y; };
  Site metres(ground), feet(ground, 0.3048);
  const auto a = metres.poses("x,y\n0,1000\n30,1000\n");
  const auto b = feet.poses("x,y\n0,3280.839895013123\n98.42519685039370,3280.839895013123\n");
  check_equal(feet.codes(), "note trajectory-unit, note on-ground");
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) check_near(a[i].translation[k], b[i].translation[k], 0.003);
  }
  check_equal(feet.poses("x [m],y [m]\n0,1000\n30,1000\n").size(), a.size());
}

TEST_CASE("gaps and cars are passed over, and refused with their place where they are too long") {
  const auto on = [](double from, double to, double side, double height) {
    return [=](double x, double y) { return side * y > 0 && x > from && x < to ? height : 5.0; };
  };
  struct Row {
    const char* what;
    Height ground;
    const char* codes;
    const char* words;
    double highest = 5.01;
  };
  for (const Row& row :
       {Row{"a short gap", on(10, 14, 1, kHole), "note on-ground",
            "at 54 of 61 places on the left ... that was bridged is 4 m"},
        Row{"a bonnet", on(10, 14.5, -1, 5.9), "note on-ground", "on the right"},
        // Its sill of 0.3 m is low enough to be taken for the ground, so the path leans.
        Row{"a sill", on(10, 14.5, -1, 5.3), "ground-leans, note on-ground",
            "leans by up to 9. ... its right wheels is 0.3 ... parked car", 5.155}}) {
    const RowName name(row.what);
    Site site(row.ground);
    double highest = 0, roll = 0;
    for (const Pose& pose : site.poses(kLine)) {
      highest = std::max(highest, pose.translation[2]);
      roll = std::max(roll, std::abs(pose.rotation[7]));
    }
    check_equal(site.codes(), row.codes);
    check_says(site.remarks[0].text, row.words);
    check_near(highest, row.highest, 0.015);
    CHECK((roll < 0.02) == (row.highest < 5.1));
  }
  const std::pair<Height, const char*> refused[] = {
      {on(10, 16, 1, kHole),
       "under the left wheels for 6 m, from 10 m along ... (at 10 1000) to 16 m ... at most 5 m"},
      {on(10, 19, -1, 5.9), "under the right wheels ... rises too steeply to be ground"},
      {[](double x, double) { return x < 6.1 ? kHole : 5; }, "for 6 m, from 0 m"}};
  for (const auto& [ground, words] : refused) check_says(Site(ground).refusal(kLine), words);
}

TEST_CASE("poses begin and end where the ground does") {
  Site site([](double x, double) { return x < 2.02 || x > 28.6 ? kHole : 5; });
  const auto poses = site.poses(kLine);
  check_equal(site.codes(), "note on-ground, ground-ends");
  check_says(site.remarks[1].text, "begin 2 m later and end 1.5 m earlier");
  CHECK(poses.front().translation[0] == Approx(2));
  CHECK(poses.back().translation[0] == Approx(28.5));
  check_equal(site.labels.station.front(), 52);
  check_equal(site.labels.station.back(), 78.5);
  check_says(site.refusal("x,y\n0,2000\n30,2000\n"), "for 30 m, from 0 m");
}

TEST_CASE("the line's heights choose the floor, or a height at its begin") {
  // The upper floor rises from 5 m to 6.5 m.
  Site site([](double x, double) { return std::fmod(100 * (x + 5), 2) < 1 ? 2 : 5 + 0.05 * x; });
  const auto height = [&](const std::string& line, const LineOptions& options) {
    return site.poses(line, options).back().translation[2];
  };
  const std::string flat = "x,y\n0,1000\n30,1000\n";
  CHECK(height(flat, {}) == Approx(2).margin(0.01));
  CHECK(height(flat, {.height = 4.6}) == Approx(6.5).margin(0.015));
  CHECK(height("x,y,z\n0,1000,4.6\n30,1000,6.1\n", {}) == Approx(6.5).margin(0.015));
  check_says(site.refusal("x,y,z\n0,1000,3.5\n30,1000,3.5\n"), "more than 1 m off");
  check_says(site.refusal("x,y,z\n0,1000,5\n30,1000,5\n", {.height = 5}), "have heights");
}

TEST_CASE("the ground needs a track, and takes no cant beside it") {
  Site site([](double, double) { return 5; });
  check_says(site.refusal(kLine, {.track = -1}), "track: -1");
  const std::string canted = "x,y,cant [mm]\n0,1000,0\n30,1000,50\n";
  check_says(site.refusal(canted), "the ground gives the roll too");
  check_equal(site.poses(canted, {.cant = CantLine::kNone}).size(), 301);
  Site cliff([](double, double y) { return y > 0 ? 6.0 : 5.0; });
  check_says(cliff.refusal(kLine, {.height = 5.4}), "less than half of the track");
}
