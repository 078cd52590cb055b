#include "core/trajectory/trajectory_doubts.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

#include "core/geometry/angle.hpp"
#include "support/attitudes.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using Catch::EndsWith;

namespace {

Pose pose_at(const Rotation& rotation, double x, double y, double z) {
  Pose pose{{}, {x, y, z}};
  for (std::size_t k = 0; k < 9; ++k) pose.rotation[k] = rotation[k];
  return pose;
}

/// The path of a car on a winding road, at coordinates of a map.
std::vector<Pose> winding_road() {
  std::vector<Pose> poses;
  double x = 5e5;
  double y = 5.3e6;
  for (int i = 0; i < 1000; ++i) {
    const double heading = 1.2 * std::sin(0.01 * i) + 0.3;
    x += 0.1 * std::cos(heading);
    y += 0.1 * std::sin(heading);
    poses.push_back(pose_at(about_z(heading) * about_y(0.01), x, y, 300));
  }
  return poses;
}

std::vector<Pose> changed(std::vector<Pose> poses, const std::function<void(Pose&)>& change) {
  for (Pose& pose : poses) change(pose);
  return poses;
}

void transpose(Pose& pose) {
  std::swap(pose.rotation[1], pose.rotation[3]);
  std::swap(pose.rotation[2], pose.rotation[6]);
  std::swap(pose.rotation[5], pose.rotation[7]);
}

void invert(Pose& pose) {
  transpose(pose);
  const double* p = pose.translation;
  double moved[3];
  for (int row = 0; row < 3; ++row) {
    const double* r = pose.rotation + 3 * row;
    moved[row] = -(r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
  }
  std::copy_n(moved, 3, pose.translation);
}

/// The codes of the doubts, joined.
std::string doubts(const std::vector<Pose>& poses,
                   RotationSource source = RotationSource::kMatrices) {
  std::string codes;
  for (const Message& doubt : doubts_about(poses, source, "path.txt")) {
    CHECK(doubt.severity == Message::Severity::kWarning);
    CHECK(doubt.text.starts_with("path.txt: "));
    codes += (codes.empty() ? "" : " ") + doubt.code;
  }
  return codes;
}

/// The rotation that a reader makes where it takes w x y z of the file for x y z w.
Rotation misread(double half_angle) {
  const double x = std::cos(half_angle);
  const double y = 0;
  const double z = 0;
  const double w = std::sin(half_angle);
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

}  // namespace

TEST_CASE("nothing is doubted where nothing is wrong") {
  for (const auto source :
       {RotationSource::kMatrices, RotationSource::kQuaternions, RotationSource::kAngles}) {
    CHECK(doubts(winding_road(), source).empty());
    CHECK(doubts({}, source).empty());
    CHECK(doubts({winding_road()[0]}, source).empty());
  }
  // Backwards on the same way, a straight line without rotations, and a turn on the spot.
  auto there_and_back = winding_road();
  there_and_back.insert(there_and_back.end(), there_and_back.rbegin(), there_and_back.rend());
  CHECK(doubts(there_and_back).empty());
  std::vector<Pose> straight;
  std::vector<Pose> turning;
  for (int i = 0; i < 100; ++i) {
    straight.push_back(pose_at(about_z(0), std::abs(50.0 - i), 0, 0));
    turning.push_back(pose_at(about_z(0.1 * i), 1, 2, 3));
  }
  CHECK(doubts(straight).empty());
  CHECK(doubts(turning).empty());
}

TEST_CASE("rotations that are missing are doubted where the path turns") {
  const auto still =
      changed(winding_road(), [](Pose& pose) { std::copy_n(about_z(0).data(), 9, pose.rotation); });
  CHECK(doubts(still) == "rotation-missing");
}

TEST_CASE("radians that were read as degrees are doubted") {
  auto poses = winding_road();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double heading = 1.2 * std::sin(0.01 * static_cast<double>(i)) + 0.3;
    std::copy_n(about_z(heading * 0.01745).data(), 9, poses[i].rotation);
  }
  CHECK(doubts(poses, RotationSource::kAngles) == "rotation-too-small");
}

TEST_CASE("inverse poses, and rotations that turn the other way, are doubted") {
  CHECK(doubts(changed(winding_road(), invert)) == "poses-inverse");
  CHECK(doubts(changed(winding_road(), transpose)) == "turns-against-path");
  const auto swapped = changed(
      winding_road(), [](Pose& pose) { std::swap(pose.translation[0], pose.translation[1]); });
  CHECK(doubts(swapped) == "turns-against-path");
}

TEST_CASE("the hint names what the file has: columns, headings, matrices or quaternions") {
  const auto text = [](const std::vector<Pose>& poses, RotationSource source) {
    const auto found = doubts_about(poses, source, "path.txt");
    return found.size() == 1 ? found[0].text : "not one doubt";
  };
  const auto swapped = changed(
      winding_road(), [](Pose& pose) { std::swap(pose.translation[0], pose.translation[1]); });
  CHECK_THAT(text(swapped, RotationSource::kMatrices),
             EndsWith("The columns x and y may be swapped, as northing before easting"));
  CHECK_THAT(text(swapped, RotationSource::kAngles),
             EndsWith("swapped, or headings may be counted clockwise from north"));
  const auto transposed = changed(winding_road(), transpose);
  CHECK_THAT(text(transposed, RotationSource::kMatrices),
             EndsWith("right. Matrices may be column by column"));
  CHECK_THAT(text(transposed, RotationSource::kAngles),
             EndsWith("right. Angles may be counted the other way"));
  CHECK_THAT(text(transposed, RotationSource::kQuaternions),
             EndsWith("right. Quaternions may be of the inverse rotations"));
  const auto turned = changed(winding_road(), [](Pose& pose) {
    for (const int k : {1, 2, 4, 5, 7, 8}) pose.rotation[k] *= -1;
  });
  CHECK_THAT(text(turned, RotationSource::kMatrices), !Contains("quaternion"));
  CHECK_THAT(text(turned, RotationSource::kQuaternions), Contains("order of quaternions"));
}

TEST_CASE("quaternions in another order are doubted") {
  auto poses = winding_road();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double heading = 1.2 * std::sin(0.01 * static_cast<double>(i)) + 0.3;
    std::copy_n(misread(heading / 2).data(), 9, poses[i].rotation);
  }
  CHECK(doubts(poses, RotationSource::kQuaternions) == "quaternion-order");
}

TEST_CASE("free motion is not doubted, near the origin or on a map") {
  for (const double far : {0.0, 5e6}) {
    std::vector<Pose> drone;
    for (int i = 0; i < 1000; ++i) {
      const double a = 0.01 * i;
      drone.push_back(pose_at(about_z(std::sin(7 * a)) * about_x(std::sin(5 * a)),
                              far + std::sin(3 * a), far + std::cos(2 * a), std::sin(a)));
    }
    CHECK(doubts(drone).empty());
    CHECK(doubts(drone, RotationSource::kQuaternions).empty());
  }
}

TEST_CASE("a model that stands on its head is doubted") {
  const auto turned = changed(winding_road(), [](Pose& pose) {
    for (const int k : {1, 2, 4, 5, 7, 8}) pose.rotation[k] *= -1;
  });
  CHECK(doubts(turned) == "upside-down");
}

TEST_CASE("roll to the outside of curves is doubted where the path is level elsewhere") {
  struct Row {
    double inwards, slope;  // degrees: in curves, and everywhere to the left
    std::string codes;
  };
  // A straight of 100 m, a curve of 80 m to the left, a straight, and a curve to the right.
  const auto path = [](const Row& row) {
    std::vector<Pose> poses;
    double x = 5e5, y = 5.3e6, heading = 0.4;
    for (int i = 0; i < 3600; ++i) {
      const int part = i / 900;
      const bool curves = i % 900 >= 450;
      const double turn = curves ? (part % 2 == 0 ? 1 : -1) / 100.0 : 0;
      heading += 0.1 * turn;
      x += 0.1 * std::cos(heading);
      y += 0.1 * std::sin(heading);
      const double to_right = (turn > 0 ? -1 : turn < 0 ? 1 : 0) * row.inwards - row.slope;
      poses.push_back(pose_at(about_z(heading) * about_x(to_right * kDegree), x, y, 300));
    }
    return poses;
  };
  for (const Row& row : {Row{-5, 0, "cant-side"}, Row{-2.2, 0, "cant-side"}, Row{5, 0, ""},
                         Row{-1.5, 0, ""}, Row{0, 4, ""}, Row{-5, 4, ""}}) {
    CAPTURE(row.inwards, row.slope);
    CHECK(doubts(path(row)) == row.codes);
  }
}
