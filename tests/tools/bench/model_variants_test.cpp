// Models that are thinned, and trajectories that are thinned, moved or disturbed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/geometry/rigid.hpp"
#include "io/scans/ply/ply_writer.hpp"
#include "scene/random.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway::bench;

namespace {

namespace fs = std::filesystem;

void write_ply(const fs::path& path, const std::vector<Vec3>& points) {
  const File file = File::create(path);
  PlyWriter writer(file, {.points = points.size()});
  writer.write(points);
  writer.finish();
}

std::vector<Vec3> thinned(const ScratchFolder& folder, const std::vector<Vec3>& points,
                          double voxel) {
  write_ply(folder / "model.ply", points);
  write_thinned_model(folder / "model.ply", folder / "thin.ply", voxel);
  return read_model_points(folder / "thin.ply");
}

/// Writes a trajectory of turns about slanted axes, far from the origin, and returns its poses.
std::vector<Pose> put_trajectory(const fs::path& path, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const double numbers[] = {std::cos(t), -std::sin(t), 0, 5e5 + t, std::sin(t), std::cos(t),
                              0,           4e6 - 3 * t,  0, 0,       1,           t * t};
    for (const double number : numbers) {
      char digits[40];
      std::snprintf(digits, sizeof digits, "%.17g ", number);
      text += digits;
    }
    text.back() = '\n';
  }
  put_bytes(path, text);
  return read_trajectory(path, {});
}

double norm(const double (&a)[3], const double (&b)[3]) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

TEST_CASE("a thinned model has the point nearest to each voxel's centre") {
  const ScratchFolder folder;
  const std::vector<Vec3> points{{0.1, 0.1, 0.1},    {0.4, 0.5, 0.5},    {0.6, 0.5, 0.5},
                                 {-0.1, 0.5, 0.5},   {-0.75, 0.5, 0.5},  {1.0, 0.5, 0.5},
                                 {-0.0, 0.999, 0.5}, {1.5, -0.5, -3.25}, {1.5, -0.5, -3.75}};
  CHECK(thinned(folder, points, 1) ==
        std::vector<Vec3>{points[1], points[4], points[5], points[7]});
}

TEST_CASE("a thinned model is a subset that covers the model") {
  const ScratchFolder folder;
  std::vector<Vec3> points;
  scene::Dice dice(3, 0);
  for (int i = 0; i < 5000; ++i) {
    Vec3 point{};
    for (int k = 0; k < 3; ++k) point[k] = dice.between(-1, 1);
    points.push_back(point);
  }
  const double voxel = GENERATE(0.05, 0.3, 10.0);
  const std::vector<Vec3> kept = thinned(folder, points, voxel);
  auto next = points.begin();
  for (const Vec3& point : kept) {
    next = std::find(next, points.end(), point);
    REQUIRE(next++ != points.end());
  }
  const auto voxel_of = [voxel](const Vec3& p) {
    return std::array{std::floor(p.x / voxel), std::floor(p.y / voxel), std::floor(p.z / voxel)};
  };
  std::set<std::array<double, 3>> of_model, of_kept;
  for (const Vec3& point : points) of_model.insert(voxel_of(point));
  for (const Vec3& point : kept) of_kept.insert(voxel_of(point));
  CHECK(of_kept == of_model);
  CHECK(of_kept.size() == kept.size());
}

TEST_CASE("a body fills the box of its model and is closed") {
  const ScratchFolder folder;
  write_ply(folder / "model.ply", {{-1, -2, 0}, {3, 2, 1.5}});
  write_body(folder / "model.ply", folder / "body.off", 799);
  const Model body = read_model(folder / "body.off", {.as = ModelAs::kSurface});
  CHECK(body.triangles.size() == 2 * 19 * 19);
  CHECK(body.vertices.size() == 19 * 19 + 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& [a, b, c] : body.triangles) {
    for (const auto& edge : {std::pair{a, b}, {b, c}, {c, a}}) ++edges[edge];
  }
  for (const auto& [edge, count] : edges) {
    REQUIRE(count == 1);
    REQUIRE(edges.contains({edge.second, edge.first}));
  }
  for (const Vec3& corner : body.vertices) {
    const double x = (corner.x - 1) / 2, y = corner.y / 2, z = (corner.z - 0.75) / 0.75;
    REQUIRE(x * x * x * x + y * y * y * y + z * z * z * z == Approx(1));
  }
  CHECK_THROWS_AS(write_body(folder / "model.ply", folder / "body.off", 17), UsageError);
}

TEST_CASE("voxels without a size are refused") {
  const ScratchFolder folder;
  for (const double voxel : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    CHECK_THROWS_AS(thinned(folder, {{0, 0, 0}}, voxel), UsageError);
  }
}

TEST_CASE("every nth pose and the last one are kept, bit for bit") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 11);
  const auto nth = [&](std::uint64_t n) {
    write_every_nth_pose(folder / "in.txt", folder / "out.txt", n);
    return read_trajectory(folder / "out.txt", {});
  };
  CHECK(nth(1) == poses);
  CHECK(nth(4) == std::vector{poses[0], poses[4], poses[8], poses[10]});
  CHECK(nth(5) == std::vector{poses[0], poses[5], poses[10]});
  CHECK(nth(100) == std::vector{poses[0], poses[10]});
  CHECK_THROWS_AS(nth(0), UsageError);
  put_bytes(folder / "in.txt", "");
  CHECK(nth(3).empty());
}

TEST_CASE("the first poses of a path are kept, bit for bit") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 11);
  const auto first = [&](std::uint64_t parts) {
    write_first_poses(folder / "in.txt", folder / "out.txt", parts);
    return read_trajectory(folder / "out.txt", {});
  };
  CHECK(first(1) == poses);
  CHECK(first(4) == std::vector{poses[0], poses[1], poses[2]});
  CHECK(first(100) == std::vector{poses[0]});
  CHECK_THROWS_AS(first(0), UsageError);
}

TEST_CASE("shifted poses keep their rotations") {
  const ScratchFolder folder;
  auto poses = put_trajectory(folder / "in.txt", 11);
  const Vec3 shift{0.1, -5e5, 1e7};
  write_shifted_poses(folder / "in.txt", folder / "out.txt", shift);
  for (Pose& pose : poses) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += shift[k];
  }
  CHECK(read_trajectory(folder / "out.txt", {}) == poses);
  CHECK_THROWS_AS(write_shifted_poses(folder / "in.txt", folder / "out.txt", {0, NAN, 0}),
                  UsageError);
}

TEST_CASE("noise of poses is rigid, of the size asked for and the seed's own") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 1000);
  const auto noisy = [&](double sigma_m, double sigma_rad, std::uint64_t seed) {
    write_noisy_poses(folder / "in.txt", folder / "out.txt", sigma_m, sigma_rad, seed);
    return read_trajectory(folder / "out.txt", {});
  };
  CHECK(noisy(0, 0, 1) == poses);
  const auto out = noisy(0.02, 0.001, 1);
  CHECK(noisy(0.02, 0.001, 1) == out);
  CHECK(noisy(0.02, 0.001, 2) != out);
  REQUIRE(out.size() == poses.size());
  double squared_metres = 0, squared_radians = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Stretch stretch = stretch_of(out[i]);
    REQUIRE(stretch.least > 1 - 1e-11);
    REQUIRE(stretch.greatest < 1 + 1e-11);
    squared_metres += std::pow(norm(out[i].translation, poses[i].translation), 2);
    // |R' - R|^2 = 8 sin^2(angle / 2), in the Frobenius norm.
    double squared = 0;
    for (int k = 0; k < 9; ++k) squared += std::pow(out[i].rotation[k] - poses[i].rotation[k], 2);
    squared_radians += squared / 2;
  }
  CHECK(std::sqrt(squared_metres / 3000) == Approx(0.02).epsilon(0.05));
  CHECK(std::sqrt(squared_radians / 3000) == Approx(0.001).epsilon(0.05));
  CHECK_THROWS_AS(noisy(-0.1, 0, 1), UsageError);
  CHECK_THROWS_AS(noisy(0, NAN, 1), UsageError);
}

TEST_CASE("non-rigid poses stretch the model along its x axis") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 20);
  write_non_rigid_poses(folder / "in.txt", folder / "out.txt", 0.25);
  CHECK_THROWS_AS(read_trajectory(folder / "out.txt", {}), InputError);
  const auto out = read_trajectory(folder / "out.txt", {.allow_non_rigid = true});
  REQUIRE(out.size() == poses.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Stretch stretch = stretch_of(out[i]);
    CHECK(stretch.greatest == Approx(1.25).epsilon(1e-11));
    CHECK(stretch.least == Approx(1).epsilon(1e-11));
    const Vec3 moved = transform(out[i], {2, 3, 4}), expected = transform(poses[i], {2.5, 3, 4});
    for (int k = 0; k < 3; ++k) CHECK(std::abs(moved[k] - expected[k]) < 1e-9);
  }
  CHECK_THROWS_AS(write_non_rigid_poses(folder / "in.txt", folder / "out.txt", -1), UsageError);
}

TEST_CASE("a pose turns on the spot, once around") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 21);
  write_turning_poses(folder / "in.txt", folder / "out.txt", 5);
  const auto out = read_trajectory(folder / "out.txt", {});
  REQUIRE(out.size() == 5);
  const Vec3 axes[] = {{1, 2, 3}, {-2, 1, 3}, {-1, -2, 3}, {2, -1, 3}, {1, 2, 3}};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 moved = transform(out[i], {1, 2, 3}), expected = transform(poses[10], axes[i]);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(moved[k] - expected[k]) < 1e-9);
  }
  CHECK_THROWS_AS(write_turning_poses(folder / "in.txt", folder / "out.txt", 1), UsageError);
}

TEST_CASE("every second pass is backwards, and each is moved as a whole") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 7);
  write_to_and_fro(folder / "in.txt", folder / "out.txt", 4, 0.01, 1);
  const auto out = read_trajectory(folder / "out.txt", {.allow_non_rigid = true});
  REQUIRE(out.size() == 28);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pass = i / 7, at = pass % 2 == 0 ? i % 7 : 6 - i % 7;
    for (int k = 0; k < 9; ++k) CHECK(out[i].rotation[k] == poses[at].rotation[k]);
    const std::size_t first = pass % 2 == 0 ? 0 : 6;
    for (int k = 0; k < 3; ++k) {
      const double shift = out[i].translation[k] - poses[at].translation[k];
      const double of_pass = out[7 * pass].translation[k] - poses[first].translation[k];
      CHECK(std::abs(shift) <= 0.035);
      CHECK(shift != 0);
      CHECK(std::abs(shift - of_pass) < 1e-9);
    }
  }
}

TEST_CASE("poses are moved along their own y axis") {
  const ScratchFolder folder;
  const auto poses = put_trajectory(folder / "in.txt", 5);
  write_poses_aside(folder / "in.txt", folder / "out.txt", 0.5);
  const auto out = read_trajectory(folder / "out.txt", {});
  REQUIRE(out.size() == poses.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 moved = transform(out[i], {1, 2, 3}), expected = transform(poses[i], {1, 2.5, 3});
    for (int k = 0; k < 3; ++k) CHECK(std::abs(moved[k] - expected[k]) < 1e-9);
  }
}
