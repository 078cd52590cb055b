#include <cmath>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "support/attitudes.hpp"
#include "support/catch.hpp"
#include "support/made_path.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

Pose pose_of_table(const std::string& text, const TrajectoryOptions& options = {}) {
  return read_path(text, options).poses.at(0);
}

void check_turn(const Pose& pose, const Rotation& expected) {
  CHECK(greatest_difference(expected, pose.rotation) < 1e-15);
}

const std::string kHead = "x,y,z,roll_deg,pitch_deg,heading_deg\n";
const TrajectoryOptions kInUtm32{.crs = "EPSG:32632"};

}  // namespace

TEST_CASE("a table with roll, pitch and heading, its unit in the header") {
  const auto check = [](const std::string& text, const TrajectoryOptions& options = {}) {
    const RowName name(text);
    const Pose pose = pose_of_table(text, options);
    check_turn(pose, navigation_rotation(3 * kDegree, -4 * kDegree, 100 * kDegree));
    CHECK(pose.position() == Vec3{1, 2, 3});
  };
  for (const auto& row : text_rows(R"(
    x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,3,-4,100\n
    x,y,z,Roll[deg],Pitch [Deg],Heading (degrees)\n1,2,3,3,-4,100\n
    x y z roll [deg] pitch [deg] heading [deg]\n1 2 3 3 -4 100\n
    # time;height;northing;easting;azimuth_deg;pitch_deg;roll_deg\n7;3;2;1;100;-4;3\n
    // x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,3,-4,100\n
    x,y,z,roll_rad,pitch_rad,heading_rad\n1,2,3,0.052359877559829886,-0.069813170079773182,1.7453292519943295\n
  )")) {
    check(row[0]);
  }
  check("Easting,Northing,Height,Roll,Pitch,Heading\n1,2,3,3,-4,100\n",
        {.angle_unit = AngleUnit::kDegrees});
}

TEST_CASE("each angle turns the way that its convention says") {
  // Angles are positive for right wing down, nose up, and clockwise from north.
  CHECK(pose_of_table(kHead + "0,0,0,10,0,0\n").rotation[7] > 0.1);  // y, which is left, goes up
  CHECK(pose_of_table(kHead + "0,0,0,0,10,0\n").rotation[6] > 0.1);  // x goes up
  CHECK(pose_of_table(kHead + "0,0,0,0,0,0\n").rotation[3] == Approx(1));
  CHECK(pose_of_table(kHead + "0,0,0,0,0,90\n").rotation[0] == Approx(1));
  const std::string robot = "x,y,z,roll_deg,pitch_deg,yaw_deg\n1,2,3,5,6,70\n";
  check_turn(pose_of_table(robot, {.angle_frame = AngleFrame::kEnu}),
             about_z(70 * kDegree) * about_y(6 * kDegree) * about_x(5 * kDegree));
  check_turn(pose_of_table(robot, {.angle_frame = AngleFrame::kNed}),
             navigation_rotation(5 * kDegree, 6 * kDegree, 70 * kDegree));
}

TEST_CASE("angles whose unit or frame is not sure are refused") {
  check_paths_refused(R"(
    x,y,z,roll,pitch,heading\n1,2,3,0,0,1.5\n             | degrees or radians
    x,y,z,roll,pitch,heading\n1,2,3,0,0,60\n              | up to 60
    x,y,z,roll_deg,pitch_deg,yaw_deg\n1,2,3,0,0,0\n       | ned ... enu
  )",
                      {}, Remedy::kDeclareAngles);
  check_paths_refused(R"(
    x,y,z,roll_rad,pitch_rad,heading_rad\n1,2,3,20,0,0\n  | look like degrees
    x,y,z,roll_deg,pitch_rad,heading_deg\n1,2,3,0,0,0\n   | angles in "deg" and in "rad"
    x,y,z,roll_deg,pitch,heading\n1,2,3,0,0,0\n           | all or none
    x,y,z,roll[gon],pitch[gon],heading[gon]\n1,2,3,0,0,0\n | gon
    x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,nan,0\n | line 2 ... finite
    x,y,z,omega,phi,kappa\n1,2,3,0,0,0\n                  | omega
    x,y,z,roll,pitch,yaw,heading\n                        | both heading and yaw
    lat,lon,easting,northing,height,roll,pitch,heading\n  | both
    lat,lon,height\n                                      | without angles
    x,y,z,roll,pitch\n                                    | no rotation
    lat,lon,height,qx,qy,qz,qw\n                          | roll, pitch and heading
  )",
                      {}, Remedy::kNone);
  check_paths_refused(R"(
    x,y,z,roll,pitch,heading\n1,2,3,0,0,359\n             | look like degrees
    x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,0,0\n   | declared to be radians
  )",
                      {.angle_unit = AngleUnit::kRadians}, Remedy::kNone);
  check_paths_refused(R"(x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,0,0\n | column called yaw)",
                      {.angle_frame = AngleFrame::kEnu}, Remedy::kNone);
  CHECK_THROWS_AS(read_path("1 0 0 0 0 1 0 0 0 0 1 0\n", {.angle_unit = AngleUnit::kDegrees}),
                  UsageError);
  const MadePath degrees = read_path("x,y,z,roll,pitch,heading\n1,2,3,0,0,359\n");
  CHECK(degrees.poses.at(0).rotation[3] > 0.99);
  check_says(degrees.codes(), "angles-in-degrees");
  // A roll of 7 is no radians.
  CHECK(pose_of_table("x,y,z,roll,pitch,heading\n1,2,3,7,0,3\n").rotation[7] > 0.1);
}

TEST_CASE("latitude and longitude in a table") {
  // On the central meridian the map's north is true north; values from Krueger's series.
  for (const auto& row : text_rows(R"(
    lat,lon,height,roll_deg,pitch_deg,heading_deg\n48,9,12.5,0,0,90\n
    lon_rad,lat_rad,alt_m,roll_deg,pitch_deg,heading_deg\n0.15707963267948966,0.83775804095727813,12.5,0,0,90\n
  )")) {
    const Pose pose = pose_of_table(row[0], kInUtm32);
    check_near(pose.translation[0], 500000, 1e-6);
    check_near(pose.translation[1], 5316300.2245, 1e-3);
    check_equal(pose.translation[2], 12.5);
    CHECK(pose.rotation[0] == Approx(1));
  }
  // A yaw from true east turns with the map as a heading from true north does.
  TrajectoryOptions yaw = kInUtm32;
  yaw.angle_frame = AngleFrame::kEnu;
  const Pose a = pose_of_table("lat,lon,z,roll_deg,pitch_deg,yaw_deg\n48,11,0,2,-3,20\n", yaw);
  const Pose b =
      pose_of_table("lat,lon,height,roll_deg,pitch_deg,heading_deg\n48,11,0,2,3,70\n", kInUtm32);
  for (int k = 0; k < 9; ++k) check_near(a.rotation[k], b.rotation[k], 1e-12);
  const std::string_view unnamed =
      R"(lat,lon,z,roll_deg,pitch_deg,heading_deg\n48,9,12.5,0,0,90\n | coordinate reference system)";
  check_paths_refused(unnamed, {}, Remedy::kNameCrs);
  check_paths_refused(R"(lat,lon,z,roll_deg,pitch_deg,heading_deg\n1,0.5,9,0,0,90\n | lat_deg)",
                      kInUtm32, Remedy::kDeclareAngles);
  check_paths_refused(R"(
    lat,lon,z,roll_deg,pitch_deg,heading_deg\n98,9,12.5,0,0,90\n         | within 90 degrees
    lat_rad,lon_rad,z,roll_deg,pitch_deg,heading_deg\n48,9,12.5,0,0,90\n | look like degrees
  )",
                      kInUtm32, Remedy::kNone);
  CHECK_THROWS_AS(read_path(kHead + "1,2,3,0,0,0\n", kInUtm32), UsageError);
}
