#include <cmath>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "support/attitudes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::vector<Pose> poses_of_table(const std::string& text, const TrajectoryOptions& options = {},
                                 std::vector<Message>* remarks = nullptr) {
  const ScratchFolder scratch;
  return read_trajectory(scratch.write("path.csv", text), options, remarks);
}

std::string refusal_of_table(const std::string& text, const TrajectoryOptions& options = {},
                             Remedy remedy = Remedy::kNone) {
  try {
    poses_of_table(text, options);
  } catch (const InputError& error) {
    CHECK(error.remedy() == remedy);
    return error.what();
  }
  FAIL("read");
  return {};
}

void check_navigation(const std::vector<Pose>& poses) {
  REQUIRE(poses.size() == 1);
  const Rotation expected = navigation_rotation(3 * kDegree, -4 * kDegree, 100 * kDegree);
  CHECK(greatest_difference(expected, poses[0].rotation) < 1e-15);
  check_equal(poses[0].translation[0], 1);
  check_equal(poses[0].translation[1], 2);
  check_equal(poses[0].translation[2], 3);
}

}  // namespace

TEST_CASE("a table with roll, pitch and heading, its unit in the header") {
  check_navigation(poses_of_table("x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,3,-4,100\n"));
  check_navigation(
      poses_of_table("x,y,z,Roll[deg],Pitch [Deg],Heading (degrees)\n1,2,3,3,-4,100\n"));
  check_navigation(poses_of_table("x y z roll [deg] pitch [deg] heading [deg]\n1 2 3 3 -4 100\n"));
  check_navigation(
      poses_of_table("# time;height;northing;easting;azimuth_deg;pitch_deg;roll_deg\n"
                     "7;3;2;1;100;-4;3\n"));
  check_navigation(poses_of_table("// x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,3,-4,100\n"));
  check_navigation(poses_of_table("Easting,Northing,Height,Roll,Pitch,Heading\n1,2,3,3,-4,100\n",
                                  {.angle_unit = AngleUnit::kDegrees}));
  check_navigation(
      poses_of_table("x,y,z,roll_rad,pitch_rad,heading_rad\n"
                     "1,2,3,0.052359877559829886,-0.069813170079773182,"
                     "1.7453292519943295\n"));
}

TEST_CASE("each angle turns the way that its convention says") {
  // Angles are positive for right wing down, nose up, and clockwise from north.
  const std::string head = "x,y,z,roll_deg,pitch_deg,heading_deg\n";
  const Pose rolled = poses_of_table(head + "0,0,0,10,0,0\n").at(0);
  CHECK(rolled.rotation[7] > 0.1);  // y, which is left, goes up
  CHECK(poses_of_table(head + "0,0,0,0,10,0\n").at(0).rotation[6] > 0.1);  // x goes up
  const Pose north = poses_of_table(head + "0,0,0,0,0,0\n").at(0);
  CHECK(north.rotation[3] == Approx(1));
  const Pose east = poses_of_table(head + "0,0,0,0,0,90\n").at(0);
  CHECK(east.rotation[0] == Approx(1));

  const std::string robot = "x,y,z,roll_deg,pitch_deg,yaw_deg\n1,2,3,5,6,70\n";
  const Pose enu = poses_of_table(robot, {.angle_frame = AngleFrame::kEnu}).at(0);
  const Rotation expected = about_z(70 * kDegree) * about_y(6 * kDegree) * about_x(5 * kDegree);
  CHECK(greatest_difference(expected, enu.rotation) < 1e-15);
  CHECK(enu.rotation[6] < 0);  // nose down
  const Pose ned = poses_of_table(robot, {.angle_frame = AngleFrame::kNed}).at(0);
  CHECK(greatest_difference(navigation_rotation(5 * kDegree, 6 * kDegree, 70 * kDegree),
                            ned.rotation) < 1e-15);
}

TEST_CASE("angles whose unit or frame is not sure are refused") {
  const std::string head = "x,y,z,roll,pitch,heading\n";
  check_says(refusal_of_table(head + "1,2,3,0,0,1.5\n", {}, Remedy::kDeclareAngles),
             "degrees or radians");
  check_says(refusal_of_table(head + "1,2,3,0,0,60\n", {}, Remedy::kDeclareAngles), "up to 60");
  std::vector<Message> remarks;
  CHECK(poses_of_table(head + "1,2,3,0,0,359\n", {}, &remarks).at(0).rotation[3] > 0.99);
  CHECK(
      std::ranges::any_of(remarks, [](const Message& m) { return m.code == "angles-in-degrees"; }));
  CHECK(poses_of_table(head + "1,2,3,7,0,3\n").at(0).rotation[7] >
        0.1);  // a roll of 7 is no radians
  check_says(refusal_of_table(head + "1,2,3,0,0,359\n", {.angle_unit = AngleUnit::kRadians}),
             "look like degrees");
  check_says(refusal_of_table("x,y,z,roll_rad,pitch_rad,heading_rad\n1,2,3,20,0,0\n"),
             "look like degrees");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,0,0\n",
                              {.angle_unit = AngleUnit::kRadians}),
             "declared to be radians");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch_rad,heading_deg\n1,2,3,0,0,0\n"),
             "degrees and in radians");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch,heading\n1,2,3,0,0,0\n"), "all or none");
  check_says(refusal_of_table("x,y,z,roll[gon],pitch[gon],heading[gon]\n1,2,3,0,0,0\n"), "gon");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch_deg,yaw_deg\n1,2,3,0,0,0\n", {},
                              Remedy::kDeclareAngles),
             "ned ... enu");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,0,0\n",
                              {.angle_frame = AngleFrame::kEnu}),
             "column called yaw");
  check_says(refusal_of_table("x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,nan,0\n"),
             "line 2 ... finite");
  CHECK_THROWS_AS(poses_of_table("1 0 0 0 0 1 0 0 0 0 1 0\n", {.angle_unit = AngleUnit::kDegrees}),
                  UsageError);
}

TEST_CASE("headers that make no pose say why") {
  check_says(refusal_of_table("x,y,z,omega,phi,kappa\n1,2,3,0,0,0\n"), "omega");
  check_says(refusal_of_table("x,y,z,roll,pitch,yaw,heading\n"), "both heading and yaw");
  check_says(refusal_of_table("lat,lon,easting,northing,height,roll,pitch,heading\n"), "both");
  check_says(refusal_of_table("lat,lon,height\n"), "without angles");
  check_says(refusal_of_table("x,y,z,roll,pitch\n"), "no rotation");
  check_says(refusal_of_table("lat,lon,height,qx,qy,qz,qw\n"), "roll, pitch and heading");
}

TEST_CASE("latitude and longitude in a table") {
  const TrajectoryOptions utm32{.crs = "EPSG:32632"};
  const std::string head = "lat,lon,height,roll_deg,pitch_deg,heading_deg\n";
  // On the central meridian the map's north is true north; values from Krueger's series.
  const auto check = [](const std::vector<Pose>& poses) {
    REQUIRE(poses.size() == 1);
    check_near(poses[0].translation[0], 500000, 1e-6);
    CHECK(poses[0].translation[1] == Approx(5316300.2245).margin(1e-3));
    check_equal(poses[0].translation[2], 12.5);
    CHECK(poses[0].rotation[0] == Approx(1));
  };
  check(poses_of_table(head + "48,9,12.5,0,0,90\n", utm32));
  check(
      poses_of_table("lon_rad,lat_rad,alt_m,roll_deg,pitch_deg,heading_deg\n"
                     "0.15707963267948966,0.83775804095727813,12.5,0,0,90\n",
                     utm32));
  // A yaw from true east turns with the map as a heading from true north does.
  TrajectoryOptions yaw = utm32;
  yaw.angle_frame = AngleFrame::kEnu;
  const Pose a =
      poses_of_table("lat,lon,z,roll_deg,pitch_deg,yaw_deg\n48,11,0,2,-3,20\n", yaw).at(0);
  const Pose b = poses_of_table(head + "48,11,0,2,3,70\n", utm32).at(0);
  for (int k = 0; k < 9; ++k) CHECK(a.rotation[k] == Approx(b.rotation[k]).margin(1e-12));

  check_says(refusal_of_table(head + "48,9,12.5,0,0,90\n", {}, Remedy::kNameCrs),
             "coordinate reference system");
  check_says(refusal_of_table(head + "1,0.5,12.5,0,0,90\n", utm32, Remedy::kDeclareAngles),
             "lat_deg");
  check_says(refusal_of_table(head + "98,9,12.5,0,0,90\n", utm32), "within 90 degrees");
  check_says(refusal_of_table(
                 "lat_rad,lon_rad,z,roll_deg,pitch_deg,heading_deg\n48,9,12.5,0,0,90\n", utm32),
             "look like degrees");
  CHECK_THROWS_AS(poses_of_table("x,y,z,roll_deg,pitch_deg,heading_deg\n1,2,3,0,0,0\n", utm32),
                  UsageError);
}
