// Questions whose answer would be a silent 0, because the path is too low or too high, the scan
// lacks what could be met, or the model has gaps.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/asked.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

double bottom_of(const std::vector<Vec3>& model) {
  double bottom = model.front().z;
  for (const Vec3& p : model) bottom = std::min(bottom, p.z);
  return bottom;
}

/// A place of the hall relative to its nearest pose, in metres: the height above the model's lowest
/// point, the distance in plan, the distance to the left, and how far the pose is along the path of
/// 80 m.
struct Relative {
  double height, away, left, along;
};

Relative relative_to_path(const Vec3& p) {
  static const Asked asked;
  static const double bottom = bottom_of(asked.model);
  const Pose* nearest = nullptr;
  double least = 1e300, along = 0;
  for (std::size_t i = 0; i < asked.poses.size(); i += 20) {
    const double* t = asked.poses[i].translation;
    const double squared = (p.x - t[0]) * (p.x - t[0]) + (p.y - t[1]) * (p.y - t[1]);
    if (squared >= least) continue;
    least = squared;
    nearest = &asked.poses[i];
    along = 80.0 * static_cast<double>(i) / static_cast<double>(asked.poses.size() - 1);
  }
  const double *r = nearest->rotation, *t = nearest->translation;
  return {p.z - t[2] - bottom, std::sqrt(least), r[1] * (p.x - t[0]) + r[4] * (p.y - t[1]), along};
}

/// Asks the question where only a part of the hall was scanned.
Outcome ask_part(const std::function<bool(const Relative&)>& keep) {
  const ScratchFolder folder;
  const std::string store =
      Scene::hall().changed_store(folder, [&](const Vec3& p) { return keep(relative_to_path(p)); });
  return Asked().ask(store);
}

std::string codes_of_part(const std::function<bool(const Relative&)>& keep) {
  return codes_of(ask_part(keep));
}

/// Asks the question where a part of the hall was registered too high or too low.
Outcome ask_raised(double by, const std::function<bool(const Relative&)>& is_wrong) {
  const ScratchFolder folder;
  const std::string store = Scene::hall().moved_store(folder, [&](const Vec3& p) {
    return Vec3{p.x, p.y, p.z + (is_wrong(relative_to_path(p)) ? by : 0)};
  });
  return Asked().ask(store);
}

bool is_in_hole(const Relative& p) { return p.along > 30 && p.along < 42; }
bool is_in_second_half(const Relative& p) { return p.along > 40; }

std::string codes_at_height(double above) {
  Asked asked;
  asked.move_path([&](const Vec3& p) { return Vec3{p.x, p.y, p.z + above}; });
  return codes_of(asked.ask());
}

/// Points 5 cm apart on the six sides of a box, or on the four that are not across x.
std::vector<Vec3> shell(const Vec3& lo, const Vec3& hi, bool with_ends) {
  constexpr double kStep = 0.05;
  std::vector<Vec3> points;
  const auto steps = [&](int k) {
    return std::max(1, static_cast<int>(std::ceil((hi[k] - lo[k]) / kStep)));
  };
  for (int i = 0; i <= steps(0); ++i) {
    for (int j = 0; j <= steps(1); ++j) {
      for (int k = 0; k <= steps(2); ++k) {
        const bool end = i == 0 || i == steps(0);
        const bool side = j == 0 || j == steps(1) || k == 0 || k == steps(2);
        if (!side && !(with_ends && end)) continue;
        points.push_back({lo.x + i * (hi.x - lo.x) / steps(0), lo.y + j * (hi.y - lo.y) / steps(1),
                          lo.z + k * (hi.z - lo.z) / steps(2)});
      }
    }
  }
  return points;
}

std::vector<Vec3> car_shell(bool with_ends) {
  const double bottom = bottom_of(Asked().model);
  return shell({-2.2, -0.9, bottom}, {2.2, 0.9, bottom + 1.5}, with_ends);
}

}  // namespace

TEST_CASE("a path below the ground or above the roof is warned of") {
  CHECK(codes_at_height(-3) == "nothing-below");
  CHECK(codes_at_height(7) == "nothing-beside");  // 0.49 m above the roof
  CHECK(codes_at_height(8) == "floats");
  Asked up_and_down;  // the path's height above the roof varies
  double i = 0;
  up_and_down.move_path([&](const Vec3& p) {
    return Vec3{p.x, p.y, p.z + 8.5 + 5 * std::sin(i++ / 600)};
  });
  CHECK(codes_of(up_and_down.ask()) == "nothing-beside");
}

TEST_CASE("a model that reaches below the ground is warned of, also with a floor") {
  const double ground = bottom_of(Asked().model) - 0.5;
  const auto y_up = [](const Vec3& p) { return Vec3{p.x, p.z, p.y}; };
  const auto lowered_by = [](double depth) {
    return [depth](const Vec3& p) { return Vec3{p.x, p.y, p.z - depth}; };
  };
  struct Row {
    std::function<Vec3(const Vec3&)> change;  ///< of a car that stands on z = 0
    bool has_floor;                           ///< 0.15 m above the ground
    bool warned;
  };
  for (const Row& row : {Row{lowered_by(0.75), true, true}, Row{lowered_by(0.75), false, true},
                         Row{lowered_by(0.4), true, true}, Row{y_up, true, true},
                         Row{lowered_by(0.2), true, false}, Row{lowered_by(0), true, false},
                         Row{lowered_by(-0.3), true, false}, Row{lowered_by(-0.3), false, false}}) {
    CAPTURE(row.has_floor, row.warned);
    Asked asked;
    asked.model = shell({-2.2, -0.9, 0}, {2.2, 0.9, 1.5}, true);
    asked.move_model([&](const Vec3& p) {
      const Vec3 changed = row.change(p);
      return Vec3{changed.x, changed.y, changed.z + ground};
    });
    if (row.has_floor) asked.options = "--floor " + std::to_string(ground + 0.15);
    const Outcome outcome = asked.ask();
    // What is inside the model causes a warning of its own.
    const std::string codes = codes_of(outcome);
    CAPTURE(codes);
    CHECK((codes.find("below-ground") != std::string::npos) == row.warned);
  }
}

TEST_CASE("a path in the ground is warned of once, by how deep the model is") {
  CHECK(codes_at_height(-1.1) == "below-ground");
  CHECK(codes_at_height(-0.6).empty());
}

TEST_CASE("a scan that lacks what the model could meet is warned of") {
  CHECK(codes_of_part([](const Relative& p) { return p.away > 3; }) == "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return p.height > 4; }) == "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return p.height < -0.01; }) == "nothing-beside");
  CHECK(codes_of_part([](const Relative& p) { return p.left > 0.5; }) == "one-side");
}

TEST_CASE("a scan from which only part was taken away on purpose is not warned of") {
  // The scan lacks what is beside the wheels, or everything above 1 m.
  CHECK(codes_of_part([](const Relative& p) { return p.away < 0.7 || p.away > 1.3; }).empty());
  CHECK(codes_of_part([](const Relative& p) { return p.height < 1; }).empty());
}

TEST_CASE("a scan without the corridor that the model takes is warned of") {
  for (const double corridor : {1.3, 2.5}) {
    CHECK(codes_of_part([&](const Relative& p) { return p.away > corridor; }) == "nothing-below");
  }
}

TEST_CASE("a hole in the scan is warned of, with its place") {
  const Outcome ground =
      ask_part([](const Relative& p) { return !is_in_hole(p) || p.height > 0.5; });
  CHECK(codes_of(ground) == "nothing-below");
  check_says(ground.err, "m along the path) nothing was scanned below the model, though");
  const auto corridor = [](const Relative& p) { return !is_in_hole(p) || p.away > 2.5; };
  CHECK(codes_of_part(corridor) == "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return !is_in_hole(p) || p.away > 8; }) ==
        "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return !is_in_hole(p); }) == "nothing-below");
  // The shadow of a scanner is no hole.
  CHECK(codes_of_part([](const Relative& p) {
          return p.height > 0.5 || p.along < 30 || p.along > 33;
        }).empty());
}

TEST_CASE("several holes are told once, the longest with its place") {
  const Outcome holes = ask_part([](const Relative& p) {
    const bool in_hole = is_in_hole(p) || (p.along > 60 && p.along < 68);
    return !in_hole || p.height > 0.5;
  });
  CHECK(codes_of(holes) == "nothing-below");
  check_says(holes.err, "The same holds for 1 other stretch,  ... m long in all");
}

TEST_CASE("a part of the scan at another height is warned of") {
  for (const double by : {2.0, 3.0, 4.0}) {
    CAPTURE(by);
    CHECK(codes_of(ask_raised(by, is_in_second_half)) == "nothing-below");
    CHECK(codes_of(ask_raised(by, is_in_hole)) == "nothing-below");
  }
  const Outcome low = ask_raised(-1, is_in_second_half);
  CHECK(codes_of(low) == "floats");
  check_says(low.err, "the model is 1.0 ... m above the highest point below");
  CHECK(codes_of(ask_raised(-1, is_in_hole)) == "floats");
}

TEST_CASE("walls that are missing along a part of the path are warned of") {
  const Outcome both =
      ask_part([](const Relative& p) { return !is_in_second_half(p) || p.height < 0.1; });
  CHECK(codes_of(both) == "nothing-beside");
  check_says(both.err, "though there is something on the rest of the path");
  const Outcome left =
      ask_part([](const Relative& p) { return !is_in_second_half(p) || p.left < 0.5; });
  CHECK(codes_of(left) == "one-side");
  check_says(left.err, "nothing was scanned on the left of the model");
}

TEST_CASE("a path that leaves the ground on a part of its way is warned of") {
  Asked asked;
  double pose = 0;
  asked.move_path([&](const Vec3& p) {
    const double ramp = std::min(std::abs(pose - 600), std::abs(pose - 1000)) / 100;
    const bool up = pose > 600 && pose < 1000;
    ++pose;
    return Vec3{p.x, p.y, p.z + (up ? 0.8 * std::min(ramp, 1.0) : 0)};
  });
  const Outcome outcome = asked.ask();
  CHECK(codes_of(outcome) == "floats");
  check_says(outcome.err, "between pose 6 ... the path leaves it");
}

TEST_CASE("stretches of which a warning tells are numbers in the JSON") {
  const ScratchFolder folder;
  const std::string store = Scene::hall().changed_store(folder, [](const Vec3& p) {
    const Relative place = relative_to_path(p);
    return !is_in_hole(place) || place.height > 0.5;
  });
  const Scene& hall = Scene::hall();
  const Outcome outcome = run_program(
      folder, "run --json --env " + store + " --model " + quoted(hall.folder / "model.ply") +
                  " --trajectory " + quoted(hall.folder / "trajectory.txt") + " --radius 0.1 -o " +
                  quoted(folder / "out.h5"));
  const auto warnings = json_of(outcome)["warnings"];
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0]["code"] == "nothing-below");
  const auto& numbers = warnings[0]["numbers"];
  check_near(numbers, "/chainage_from", 31.5, 1.5);
  check_near(numbers, "/chainage_to", 40.5, 1.5);
  check_near(numbers, "/first_pose", numbers["chainage_from"].get<double>() * 25, 2);
  check_json(numbers, R"({"stretches": 1})");
  check_near(numbers, "/share", 9.0 / 80, 0.03);
}

TEST_CASE("short, long and wide vehicles in a sound scan are not warned of") {
  const double bottom = bottom_of(Asked().model);
  for (const Vec3& size : {Vec3{0.5, 0.4, 0.5}, Vec3{1, 0.8, 0.8}, Vec3{12, 1.8, 1.5}}) {
    CAPTURE(size.x);
    Asked asked;
    asked.model =
        shell({-size.x / 2, -size.y / 2, bottom}, {size.x / 2, size.y / 2, bottom + size.z}, true);
    CHECK(codes_of(asked.ask()).empty());
  }
}

TEST_CASE("a vehicle that stops for long is judged by its way") {
  Asked asked;
  std::vector<Pose> poses(asked.poses.begin(), asked.poses.begin() + 1000);
  poses.insert(poses.end(), 20'000, poses.back());
  poses.insert(poses.end(), asked.poses.begin() + 1000, asked.poses.end());
  asked.poses = poses;
  CHECK(codes_of(asked.ask()).empty());
  const ScratchFolder folder;
  const std::string store = Scene::hall().changed_store(folder, [](const Vec3& p) {
    const Relative place = relative_to_path(p);
    return place.along < 50 || place.along > 62 || place.height > 0.5;
  });
  CHECK(codes_of(asked.ask(store)) == "nothing-below");
}

TEST_CASE("where poses are far apart a note says what can stay unnoticed") {
  Asked asked;
  asked.options = "--between-poses";
  check_lacks(asked.ask().err, "is inspected every");
  std::vector<Pose> few;
  for (std::size_t i = 0; i < asked.poses.size(); i += 150) few.push_back(asked.poses[i]);
  asked.poses = few;
  check_says(asked.ask().err, "is inspected every 5.99 m ... shorter than 12 m");
}

TEST_CASE("a scan that was thinned is warned of, also for a wide model") {
  const ScratchFolder folder;
  std::set<std::array<long, 3>> filled;
  const std::string store = Scene::hall().changed_store(folder, [&](const Vec3& p) {
    return filled.insert({std::lround(p.x / 0.7), std::lround(p.y / 0.7), std::lround(p.z / 0.7)})
        .second;
  });
  Asked asked;
  asked.radius = "0.05";
  CHECK(codes_of(asked.ask(store)) == "coarse-scan");
  const double bottom = bottom_of(asked.model);
  asked.model = shell({-2.2, -1.3, bottom}, {2.2, 1.3, bottom + 1.5}, true);
  check_says(codes_of(asked.ask(store)), "coarse-scan");
  asked.radius = "1";
  check_lacks(codes_of(asked.ask(store)), "coarse-scan");
}

TEST_CASE("a scan without heights is warned of") {
  const ScratchFolder folder;
  write_las(folder / "flat.las",
            [] {
              std::vector<Quantum> flat;
              for (std::int32_t i = 0; i < 90'000; ++i)
                flat.push_back({i / 300 * 300, i % 300 * 150, 0});
              return flat;
            }(),
            {{0.001, 0.001, 0.001}, {0, 0, 0}});
  const std::string store = quoted(folder / "flat.h5");
  require_success(run_program(folder, "convert " + quoted(folder / "flat.las") + " -o " + store));
  check_says(codes_of(Asked().ask(store)), "flat-scan");
}

TEST_CASE("a model that lets things through is warned of, a closed one is not") {
  Asked asked;
  asked.model = car_shell(true);
  CHECK(codes_of(asked.ask()).empty());
  asked.model = car_shell(false);
  CHECK(codes_of(asked.ask()) == "open-model");
  const double bottom = bottom_of(Asked().model);
  asked.model = shell({0, -0.9, bottom}, {0, 0.9, bottom + 1.5}, true);
  CHECK(codes_of(asked.ask()) == "flat-model");
}

TEST_CASE("a model that stands on something at the first pose is warned of") {
  Asked asked;
  asked.model = car_shell(true);
  asked.poses.resize(1);
  CHECK(codes_of(asked.ask()).empty());
  const ScratchFolder folder;
  const Vec3 middle{asked.poses[0].translation[0], asked.poses[0].translation[1],
                    asked.poses[0].translation[2] + bottom_of(asked.model) + 0.75};
  std::vector<Vec3> things;  // a cube of points, far from all sides of the model
  for (int i = 0; i < 1000; ++i) {
    things.push_back({middle.x + 0.02 * (i / 100 - 5), middle.y + 0.02 * (i / 10 % 10 - 5),
                      middle.z + 0.02 * (i % 10 - 5)});
  }
  write_ply(folder / "things.ply", things);
  const std::string store = quoted(folder / "both.h5");
  require_success(run_program(folder, "convert " +
                                          quoted(Scene::hall().folder / "environment.las") + " " +
                                          quoted(folder / "things.ply") + " -o " + store));
  const Outcome outcome = asked.ask(store);
  CHECK(codes_of(outcome) == "inside-model");
  check_says(outcome.err, "about 1,000 scanned points lie inside the model");
}

TEST_CASE("a model that is far too small, or that the poses scale, is warned of") {
  Asked inches;
  inches.move_model([](const Vec3& p) { return Vec3{p.x * 0.0254, p.y * 0.0254, p.z * 0.0254}; });
  check_says(codes_of(inches.ask()), "model-size");
  Asked point;
  point.model = {{0, 0, 1}};
  check_says(codes_of(point.ask()), "model-size");
  Asked feet;
  feet.options = "--allow-non-rigid";
  feet.turn([](double* r) {
    for (int k = 0; k < 9; ++k) r[k] *= 0.3048;
  });
  const Outcome outcome = feet.ask();
  check_says(codes_of(outcome), "scaled-poses");
  check_lacks(codes_of(outcome), "tilted");
  check_says(outcome.err, "scale the model by 0.305");
}

TEST_CASE("poses that mirror the model are warned of, and poses turned round are told") {
  Asked mirrored;
  mirrored.options = "--allow-non-rigid";
  mirrored.turn([](double* r) {
    for (int k = 0; k < 3; ++k) r[3 * k + 1] = -r[3 * k + 1];
  });
  check_says(codes_of(mirrored.ask()), "mirrored-poses");
  check_lacks(codes_of(mirrored.ask()), "scaled-poses");
  check_lacks(Asked().ask().err, "moves backwards");
  Asked round;
  round.turn([](double* r) {
    for (int k = 0; k < 3; ++k) {
      r[3 * k] = -r[3 * k];
      r[3 * k + 1] = -r[3 * k + 1];
    }
  });
  check_says(round.ask().err, "the model moves backwards, against its x axis");
}
