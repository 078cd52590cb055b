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
    } catch (const Error& error) {
      return error.what();
    }
    return "read";
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

TEST_CASE("gaps of up to 5 m are bridged, and longer ones refused with their place") {
  const auto with_hole = [](double length) {
    return [length](double x, double y) {
      return y > 0 && x > 10 && x < 10 + length ? kHole : 5 + 0.04 * x;
    };
  };
  Site narrow(with_hole(4));
  const auto poses = narrow.poses(kLine);
  check_equal(narrow.codes(), "note on-ground");
  check_says(narrow.remarks[0].text, "at 54 of 61 places on the left ... that was bridged is 4 m");
  for (const Pose& pose : poses) {
    check_near(pose.translation[2], 5 + 0.04 * pose.translation[0], 0.02);
    check_near(pose.rotation[7], 0, 0.02);
  }
  Site wide(with_hole(6));
  check_says(
      wide.refusal(kLine),
      "under the left wheels for 6 m, from 10 m along ... (at 10 1000) to 16 m ... at most 5 m");
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
  Site far([](double x, double) { return x < 6.1 ? kHole : 5; });
  check_says(far.refusal(kLine), "for 6 m, from 0 m");
  check_says(far.refusal("x,y\n0,2000\n30,2000\n"), "for 30 m, from 0 m");
}

TEST_CASE("a parked car rises too steeply, which is said where it is too long") {
  const auto car = [](double length) {
    return [length](double x, double y) { return y < 0 && x > 10 && x < 10 + length ? 5.9 : 5.0; };
  };
  Site site(car(4.5));
  for (const Pose& pose : site.poses(kLine)) {
    check_near(pose.translation[2], 5, 0.01);
    check_near(pose.rotation[7], 0, 0.01);
  }
  // Its sill of 0.3 m is low enough to be taken for the ground, so the path leans.
  Site sill([](double x, double y) { return y < 0 && x > 10 && x < 14.5 ? 5.3 : 5.0; });
  double worst = 0;
  for (const Pose& pose : sill.poses(kLine)) worst = std::max(worst, pose.translation[2] - 5);
  CHECK(worst > 0.14);
  CHECK(worst < 0.17);
  check_equal(sill.codes(), "ground-leans, note on-ground");
  check_says(sill.remarks[0].text, "leans by up to 9. ... its right wheels is 0.3 ... parked car");
  Site truck(car(9));
  check_says(truck.refusal(kLine), "under the right wheels ... rises too steeply to be ground");
}

TEST_CASE("the line's heights choose the floor, or a height at its begin") {
  Site site([](double x, double y) { return std::fmod(100 * (x + 5), 2) < 1 ? 2 : 5 + 0 * y; });
  const auto height = [&](const std::string& line, const LineOptions& options) {
    return site.poses(line, options).at(100).translation[2];
  };
  const std::string flat = "x,y\n0,1000\n30,1000\n";
  CHECK(height(flat, {}) == Approx(2).margin(0.01));
  CHECK(height(flat, {.height = 4.6}) == Approx(5).margin(0.01));
  CHECK(height("x,y,z\n0,1000,4.6\n30,1000,5.4\n", {}) == Approx(5).margin(0.01));
  check_says(site.refusal("x,y,z\n0,1000,3.5\n30,1000,3.5\n"), "more than 1 m off");
  check_says(site.refusal("x,y,z\n0,1000,5\n30,1000,5\n", {.height = 5}), "have heights");
}

TEST_CASE("the ground needs a track, and takes no cant beside it") {
  Site site([](double, double) { return 5; });
  put_bytes(site.folder / "line.csv", kLine);
  const Store store(site.folder / "a.h5");
  check_refused([&] { return read_line(site.folder / "line.csv", {.ground = &store}); }, "track");
  check_refused([&] { return read_line(site.folder / "line.csv", {.height = 1, .track = 2}); },
                "both or neither");
  check_says(site.refusal(kLine, {.track = -1}), "track: -1");
  const std::string canted = "x,y,cant [mm]\n0,1000,0\n30,1000,50\n";
  check_says(site.refusal(canted), "the ground gives the roll too");
  check_equal(site.poses(canted, {.cant = CantLine::kNone}).size(), 301);
  Site cliff([](double, double y) { return y > 0 ? 6.0 : 5.0; });
  check_says(cliff.refusal(kLine, {.height = 5.4}), "less than half of the track");
}

TEST_CASE("corners are rounded on the ground too") {
  Site site([](double x, double y) { return 7 + 0.05 * x + 0.1 * y; });
  const auto poses =
      site.poses("x,y\n0,999\n20,999\n20,1002\n", {.corner_radius = 2, .track = 0.8});
  check_equal(site.codes(), "note line-rounded, note on-ground");
  for (const Pose& pose : poses) {
    const double x = pose.translation[0], y = pose.translation[1] - 1000;
    check_near(pose.translation[2], 7 + 0.05 * x + 0.1 * y, 0.02);
  }
}
