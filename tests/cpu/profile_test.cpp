// Profiles against brute force, where they are hard: ties, distances of any size, roundings.
#include <cmath>
#include <optional>
#include <string>

#include "core/geometry/predicate.hpp"
#include "random_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"

using namespace clearway;
using namespace clearway::test;
using clearway::test::kPart;
using clearway::test::kRoom;

namespace {

struct ProfileScene : clearway::test::Scene {
  ProfileScene() {
    points.resize(1500);
    radius = 0.1;
  }

  std::uint64_t check_profile(double distance) const {
    std::uint64_t found = 0;
    for (const double clearance : {0.0, 0.05, 0.7}) {
      Query query{model, poses, {radius, clearance == 0.05}};
      query.clearance = clearance;
      query.profile = distance;
      found = clearway::check_profile(points, quantisation, query);
    }
    return found;
  }

  /// The least d2 at a pose, by brute force.
  double least(std::size_t pose) const {
    Query query{model, {poses[pose]}, {radius}};
    query.profile = 1e100;
    return brute_force_profile(positions_of(points, quantisation), query)[0].squared;
  }
};

}  // namespace

TEST_CASE("profiles of every distance") {
  ProfileScene scene;
  const std::size_t all = scene.poses.size();
  SECTION("smaller than every distance") { check_equal(scene.check_profile(1e-7), 0); }
  SECTION("smaller than the radius") { CHECK(scene.check_profile(0.05) > 0); }
  SECTION("the radius") { CHECK(scene.check_profile(0.1) > 0); }
  SECTION("larger") { CHECK(scene.check_profile(0.5) > 0); }
  SECTION("larger than the scene") { CHECK(scene.check_profile(1000) == all); }
  SECTION("beyond any scene") { CHECK(scene.check_profile(1e150) == all); }
  SECTION("whose square is infinite") { CHECK(scene.check_profile(1e200) == all); }
  SECTION("whose square is zero") { check_equal(scene.check_profile(1e-200), 0); }
  SECTION("with a radius far below the model's spacing") {
    scene.radius = 1e-4;
    CHECK(scene.check_profile(1.5) > 0);
  }
  SECTION("with a radius larger than the scene") {
    scene.radius = 30;
    CHECK(scene.check_profile(0.5) > 0);
  }
}

TEST_CASE("a profile at the exact distance of a pose") {
  ProfileScene scene;
  for (std::size_t pose : {0, 13, 39}) {
    double distance = std::sqrt(scene.least(pose));
    while (rounded_product(distance, distance) > scene.least(pose)) {
      distance = std::nextafter(distance, 0);
    }
    const auto found = [&](double limit) {
      ProfileScene one = scene;
      one.poses = {scene.poses[pose]};
      return one.check_profile(limit);
    };
    check_equal(found(distance), 0);  // the profile's distance itself is not below it
    while (rounded_product(distance, distance) <= scene.least(pose)) {
      distance = std::nextafter(distance, 1e9);
    }
    check_equal(found(distance), 1);
  }
}

TEST_CASE("profiles of few model points, poses and points") {
  ProfileScene scene;
  SECTION("one model point") { scene.model.resize(1); }
  SECTION("one pose") { scene.poses.resize(1); }
  SECTION("one point") { scene.points.resize(1); }
  SECTION("one of each") {
    scene.model.resize(1);
    scene.poses.resize(1);
    scene.points.resize(1);
  }
  CHECK(scene.check_profile(20) == scene.poses.size());
}

TEST_CASE("profiles where no point is in reach") {
  ProfileScene scene;
  scene.move_far_away({0, 0, 0});
  for (Pose& pose : scene.poses) pose.translation[0] += 100;
  check_equal(scene.check_profile(2), 0);
}

TEST_CASE("profiles of stops, jumps and ways back") {
  ProfileScene scene;
  SECTION("repeated poses") { repeat_each(scene.poses, 5); }
  SECTION("one pose all the time") { scene.poses.assign(300, scene.poses[7]); }
  SECTION("a long stop on the way") { stop_at(scene.poses, 20, 200); }
  SECTION("there and back") { drive_back(scene.poses); }
  SECTION("steps that double: a tree deeper than its levels") {
    scene.poses.clear();
    for (int i = -40; i < 3; ++i) scene.poses.push_back(translation({std::ldexp(1, i), 0, 0}));
  }
  SECTION("jumps") {
    for (std::size_t i = 0; i < scene.poses.size(); i += 3) {
      scene.poses[i] = random_rotation(scene.random, random_point(scene.random, kRoom));
    }
  }
  CHECK(scene.check_profile(3) == scene.poses.size());
}

namespace {

/// A pose that rolls the model about its x axis and then turns it about the z axis.
Pose tilted(double turn, double roll, const Vec3& at) {
  Pose pose = rotation({0, 0, 1}, turn, at);
  const Pose rolled = rotation({1, 0, 0}, roll, {0, 0, 0});
  Pose out = pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += pose.rotation[3 * i + k] * rolled.rotation[3 * k + j];
      out.rotation[3 * i + j] = sum;
    }
  }
  return out;
}

/// Paths of small steps, on which what was proven at one pose holds at many more.
struct SlowPath {
  const char* name;
  Pose (*at)(int);
};

constexpr int kSlowPoses = 240;

const SlowPath kSlowPaths[] = {
    {"straight on",
     [](int i) {
       return tilted(0, 0, {-3 + 0.025 * i, 0.2, 0.4});
     }},
    {"steps of all sizes",
     [](int i) {
       return tilted(0, 0, {-3 + 0.015 * (i - i % 20) + 4e-7 * i * i, 0.2, 0.4});
     }},
    {"a bend",
     [](int i) {
       return tilted(0.01 * i, 0, {2 * std::cos(0.01 * i), 1, 0.3});
     }},
    {"turning on the spot",
     [](int i) {
       return tilted(0.02 * i, 0, {0.5, 0.4, 0.3});
     }},
    {"turning about a far point of the model",
     [](int i) {
       return tilted(0.01 * i, 0, {0.7 * std::cos(0.01 * i), 0.7 * std::sin(0.01 * i), 0.3});
     }},
    {"to and fro",
     [](int i) {
       return tilted(0, 0, {1.5 * std::sin(0.1 * i), 0.2, 0.4});
     }},
    {"trembling",
     [](int i) {
       return tilted(0, 0.001 * (i % 3), {0.004 * (i % 7), 0, 0.3});
     }},
    {"standing still between steps",
     [](int i) {
       return tilted(0.001 * (i - i % 50), 0, {0.006 * (i - i % 50) - 1, 0.2, 0.4});
     }},
    {"jumps, there and back",
     [](int i) {
       return tilted(0, 0, {-2 + 0.01 * i + (i % 74 < 37 ? 0 : 1.5), 0.2, 0.4});
     }},
    {"jumps of a kilometre",
     [](int i) {
       return tilted(0, 0, {-2 + 0.01 * i + (i % 180 < 90 ? 0 : 1000), 0.2, 0.4});
     }},
    {"up and down",
     [](int i) {
       return tilted(0, 0, {0.2, 0.4, 0.9 * std::sin(0.05 * i)});
     }},
    {"rolling",
     [](int i) {
       return tilted(0.004 * i, 0.5 * std::sin(0.03 * i), {-2 + 0.01 * i, 0.2, 0.4});
     }},
    {"climbing, turning, rolling",
     [](int i) {
       return tilted(0.01 * i, 0.2 * std::sin(0.2 * i), {0.3, 0.2, -0.9 + 0.01 * i});
     }},
};

/// A room with two levels of even ground, along which many points are nearly the nearest at every
/// pose.
struct SlowScene : ProfileScene {
  explicit SlowScene(const SlowPath& path) {
    points.resize(300);
    for (const double height : {-0.35, 0.02}) {
      for (const Vec3& e : random_points(random, {{-4, -1, height}, {4, 1, height + 0.01}}, 350)) {
        points.push_back(quantise(std::vector<Vec3>{e}, quantisation)[0]);
      }
    }
    model.resize(25);
    poses.clear();
    for (int i = 0; i < kSlowPoses; ++i) poses.push_back(path.at(i));
  }

  std::uint64_t check_slow(double distance, std::optional<double> floor) const {
    Query query{model, poses, {radius}};
    query.profile = distance;
    query.floor = floor;
    return clearway::check_profile(points, quantisation, query);
  }
};

}  // namespace

TEST_CASE("profiles of slow paths, on which bounds last") {
  for (const SlowPath& path : kSlowPaths) {
    CAPTURE(path.name);
    SlowScene scene(path);
    SECTION(std::string(path.name) + ", near") { scene.check_slow(0.05, std::nullopt); }
    SECTION(std::string(path.name) + ", far") { CHECK(scene.check_slow(2, std::nullopt) > 0); }
    SECTION(std::string(path.name) + ", above a floor") {
      for (const double floor : {-0.3, 0.25}) CHECK(scene.check_slow(2, floor) > 0);
    }
    SECTION(std::string(path.name) + ", far from the origin, above a floor") {
      scene.move_far_away({5e6, 2e6, 1e3});
      CHECK(scene.check_slow(1, -0.3) > 0);
    }
    SECTION(std::string(path.name) + ", stretched") {
      stretch(scene.poses, {2.5, 0.3, 1.7});
      CHECK(scene.check_slow(1, std::nullopt) > 0);
      CHECK(scene.check_slow(1, -0.3) > 0);
    }
  }
}

TEST_CASE("profiles for which many points tie") {
  // All numbers are exact, so that whole planes of points are equally far.
  ProfileScene scene;
  scene.quantisation = {{0x1p-10, 0x1p-10, 0x1p-10}, {0, 0, 0}};
  scene.points.clear();
  for (std::int32_t i = 0; i < 2500; ++i) scene.points.push_back({i % 50 * 64, i / 50 * 64, 0});
  std::shuffle(scene.points.begin(), scene.points.end(), scene.random);
  scene.model.clear();
  for (int i = 0; i < 64; ++i) scene.model.push_back({i % 8 * 0x1p-4, i / 8 * 0x1p-4, 0.25});
  scene.poses.clear();
  for (int i = 0; i < 40; ++i) scene.poses.push_back(translation({i * 0x1p-6, 0.5, 0}));
  CHECK(scene.check_profile(4) == scene.poses.size());
  check_equal(scene.check_profile(0.25), 0);
  CHECK(scene.check_profile(std::nextafter(0.25, 1)) > 0);
}

TEST_CASE("profiles of duplicates") {
  ProfileScene scene;
  scene.points.resize(700);
  for (int i = 0; i < 700; ++i) scene.points.push_back(scene.points[i]);
  for (int i = 0; i < 700; ++i) scene.points.insert(scene.points.begin(), scene.points[i]);
  for (int i = 0; i < 60; ++i) scene.model.push_back(scene.model[i]);
  CHECK(scene.check_profile(1) > 0);
  scene.points.assign(500, scene.points[3]);
  CHECK(scene.check_profile(30) == scene.poses.size());
}

TEST_CASE("profiles far from the origin and of matrices that are not rigid") {
  ProfileScene scene;
  SECTION("UTM") { scene.move_far_away({5e6, 2e6, 1e3}); }
  SECTION("six digits") { print_with_six_digits(scene.poses); }
  SECTION("slightly stretched") { stretch(scene.poses, {1.00009, 0.99992, 1.00005}); }
  SECTION("strongly stretched") { stretch(scene.poses, {2.5, 0.3, 1.7}); }
  SECTION("strongly stretched, far away") {
    stretch(scene.poses, {0.2, 1.4, 0.7});
    scene.move_far_away({5e6, 2e6, 1e3});
  }
  SECTION("singular") { stretch(scene.poses, {3, 0, 1}); }
  CHECK(scene.check_profile(1.5) > 0);
}

TEST_CASE("profiles where roundings decide the point and the model point") {
  // All points are equally far from a model of points around one place, but for a few roundings:
  // the least computed d2 is not that of the nearest point.
  Random random(29);
  for (int trial = 0; trial < 20; ++trial) {
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e3 : 5e6;
    const Vec3 place{far, -far / 3, 0.1};
    ProfileScene scene;
    scene.quantisation = Quantisation{{1e-9, 1e-9, 1e-9}, {place.x, place.y, place.z}};
    scene.points.clear();
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = transform(random_rotation(random, {0, 0, 0}), Vec3{0.5, 0, 0});
      scene.points.push_back(quantise(
          std::vector<Vec3>{{place.x + x.x, place.y + x.y, place.z + x.z}}, scene.quantisation)[0]);
    }
    scene.model.clear();
    for (int i = 0; i < 20; ++i) {
      scene.model.push_back(random_point(random, {{-1e-9, -1e-9, -1e-9}, {1e-9, 1e-9, 1e-9}}));
    }
    scene.poses.clear();
    for (int i = 0; i < 30; ++i) scene.poses.push_back(random_rotation(random, place));
    CAPTURE(trial);
    CHECK(scene.check_profile(1) == scene.poses.size());
  }
}

TEST_CASE("a profile of a cell with more blocks than a warp searches at once") {
  ProfileScene scene;
  scene.points = quantise(random_points(scene.random, kRoom, 200'000), scene.quantisation);
  scene.model.resize(5);
  scene.poses.resize(4);
  Query query{scene.model, scene.poses, {scene.radius}};
  query.profile = 0.5;
  CHECK(check_profile(scene.points, scene.quantisation, query) == scene.poses.size());
}
