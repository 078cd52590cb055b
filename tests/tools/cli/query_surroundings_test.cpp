// Questions whose answer would be a silent 0: the path is too low or too high, the scan lacks what
// could be met, or the model lets things through.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/store_fixture.hpp"
#include "tools/cli/support/asked.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

double bottom_of(const std::vector<Vec3>& model) {
  double bottom = model.front().z;
  for (const Vec3& p : model) bottom = std::min(bottom, p.z);
  return bottom;
}

/// A place of the hall from its nearest pose: how high above the model's lowest point, how far in
/// plan, and how far to its left.
struct Relative {
  double height, away, left;
};

Relative relative_to_path(const Vec3& p) {
  static const Asked asked;
  static const double bottom = bottom_of(asked.model);
  const Pose* nearest = nullptr;
  double least = 1e300;
  for (std::size_t i = 0; i < asked.poses.size(); i += 20) {
    const double* t = asked.poses[i].translation;
    const double squared = (p.x - t[0]) * (p.x - t[0]) + (p.y - t[1]) * (p.y - t[1]);
    if (squared >= least) continue;
    least = squared;
    nearest = &asked.poses[i];
  }
  const double *r = nearest->rotation, *t = nearest->translation;
  return {p.z - t[2] - bottom, std::sqrt(least), r[1] * (p.x - t[0]) + r[4] * (p.y - t[1])};
}

/// The codes where only a part of the hall was scanned.
std::string codes_of_part(const std::function<bool(const Relative&)>& keep) {
  const ScratchFolder folder;
  const std::string store =
      Scene::hall().changed_store(folder, [&](const Vec3& p) { return keep(relative_to_path(p)); });
  return codes_of(Asked().ask(store));
}

std::string codes_at_height(double above) {
  Asked asked;
  asked.move_path([&](const Vec3& p) { return Vec3{p.x, p.y, p.z + above}; });
  return codes_of(asked.ask());
}

/// A box with points 5 cm apart on its six sides, or without those across x.
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
  Asked up_and_down;  // at no steady height above the roof
  double i = 0;
  up_and_down.move_path([&](const Vec3& p) {
    return Vec3{p.x, p.y, p.z + 8.5 + 5 * std::sin(i++ / 600)};
  });
  CHECK(codes_of(up_and_down.ask()) == "nothing-beside");
}

TEST_CASE("a scan that lacks what the model could meet is warned of") {
  CHECK(codes_of_part([](const Relative& p) { return p.away > 3; }) == "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return p.height > 4; }) == "nothing-below");
  CHECK(codes_of_part([](const Relative& p) { return p.height < -0.01; }) == "nothing-beside");
  CHECK(codes_of_part([](const Relative& p) { return p.left > 0.5; }) == "one-side");
}

TEST_CASE("a scan from which only part was taken away on purpose is not warned of") {
  // What the model touches, and the roof.
  CHECK(codes_of_part([](const Relative& p) { return p.away > 1.3; }).empty());
  CHECK(codes_of_part([](const Relative& p) { return p.height < 1; }).empty());
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
  REQUIRE(
      run_program(folder, "convert " + quoted(folder / "flat.las") + " -o " + store).exit_code ==
      0);
  CHECK_THAT(codes_of(Asked().ask(store)), Contains("flat-scan"));
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
  REQUIRE(run_program(folder, "convert " + quoted(Scene::hall().folder / "environment.las") + " " +
                                  quoted(folder / "things.ply") + " -o " + store)
              .exit_code == 0);
  const Outcome outcome = asked.ask(store);
  CHECK(codes_of(outcome) == "inside-model");
  CHECK_THAT(outcome.err, Contains("about 1,000 scanned points lie inside the model"));
}

TEST_CASE("a model that is far too small, or that the poses scale, is warned of") {
  Asked inches;
  inches.move_model([](const Vec3& p) { return Vec3{p.x * 0.0254, p.y * 0.0254, p.z * 0.0254}; });
  CHECK_THAT(codes_of(inches.ask()), Contains("model-size"));
  Asked point;
  point.model = {{0, 0, 1}};
  CHECK_THAT(codes_of(point.ask()), Contains("model-size"));
  Asked feet;
  feet.options = "--allow-non-rigid";
  feet.turn([](double* r) {
    for (int k = 0; k < 9; ++k) r[k] *= 0.3048;
  });
  const Outcome outcome = feet.ask();
  CHECK_THAT(codes_of(outcome), Contains("scaled-poses") && !Contains("tilted"));
  CHECK_THAT(outcome.err, Contains("scale the model by 0.305"));
}

TEST_CASE("poses that mirror the model are warned of, and poses turned round are told") {
  Asked mirrored;
  mirrored.options = "--allow-non-rigid";
  mirrored.turn([](double* r) {
    for (int k = 0; k < 3; ++k) r[3 * k + 1] = -r[3 * k + 1];
  });
  CHECK_THAT(codes_of(mirrored.ask()), Contains("mirrored-poses") && !Contains("scaled-poses"));
  CHECK_THAT(Asked().ask().err, !Contains("moves backwards"));
  Asked round;
  round.turn([](double* r) {
    for (int k = 0; k < 3; ++k) {
      r[3 * k] = -r[3 * k];
      r[3 * k + 1] = -r[3 * k + 1];
    }
  });
  CHECK_THAT(round.ask().err, Contains("the model moves backwards, against its x axis"));
}
