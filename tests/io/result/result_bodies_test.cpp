// Results of vehicles: names of bodies, and the columns that name one.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "core/util/format.hpp"
#include "io/files/hdf5.hpp"
#include "io/result/answer.hpp"
#include "io/result/check_results.hpp"
#include "io/result/floor_facts.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Vehicle {
  Vehicle() {
    header.bodies = {"front bogie", "body", "back"};
    header.clearance = 0.3;
    rows = sample_rows(header, 100'000);
    near = sample_clearances(header, 70'001);
    for (std::uint32_t i = 0; i < rows.size(); ++i) rows.body.push_back(i * 7 % 3);
    for (std::uint32_t i = 0; i < near.size(); ++i) near.body.push_back(i * 5 % 3);
  }

  void write(const std::string& name, const ResultFindings& findings = {}) const {
    ResultWriter writer(folder / name, header, rows.size(), near.size());
    writer.append(rows);
    writer.append(near);
    writer.finish(findings);
  }
  std::optional<std::string> fault(const std::string& name) const {
    NoProgress progress;
    return verify_result(ResultReader(folder / name), progress);
  }

  ScratchFolder folder;
  ResultHeader header = sample_header(true);
  Collisions rows;
  Clearances near;
};

void overwrite(const std::filesystem::path& path, const char* dataset, std::uint32_t value) {
  const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
  const hdf5::Id set(H5Dopen2(file.get(), dataset, H5P_DEFAULT), H5Dclose, "open");
  std::vector<std::uint32_t> values(
      static_cast<std::size_t>(H5Dget_storage_size(set.get()) / sizeof value));
  REQUIRE(H5Dread(set.get(), H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
  values[1] = value;
  REQUIRE(H5Dwrite(set.get(), H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >=
          0);
}

}  // namespace

TEST_CASE("a vehicle's result is read as it was written") {
  const Vehicle vehicle;
  vehicle.write("out.h5");
  const ResultReader result(vehicle.folder / "out.h5");
  CHECK(same_answer(result.header(), vehicle.header));
  std::vector<std::uint32_t> bodies, nearest;
  RowStream<Collisions> stream(result);
  for (Collisions rows; stream.read(rows);) {
    bodies.insert(bodies.end(), rows.body.begin(), rows.body.end());
  }
  RowStream<Clearances> clearances(result);
  for (Clearances rows; clearances.read(rows);) {
    nearest.insert(nearest.end(), rows.body.begin(), rows.body.end());
  }
  CHECK(bodies == vehicle.rows.body);
  CHECK(nearest == vehicle.near.body);
  CHECK_FALSE(vehicle.fault("out.h5"));
}

TEST_CASE("a vehicle's result may ignore points too") {
  Vehicle vehicle;
  vehicle.header.ignore_classes = {2, 7};
  vehicle.header.ignored = {.points = 9, .of_classes = {4, 5}, .in_boxes = {}};
  vehicle.header.classes_hash = 77;
  vehicle.rows.point_class.assign(vehicle.rows.size(), 7);
  vehicle.near.point_class.assign(vehicle.near.size(), 6);
  vehicle.write("out.h5");
  const ResultReader result(vehicle.folder / "out.h5");
  CHECK(same_answer(result.header(), vehicle.header));
  CHECK_FALSE(vehicle.fault("out.h5"));
}

TEST_CASE("a vehicle's result keeps the floor of each body") {
  Vehicle vehicle;
  vehicle.header.body_floors = {0.25, std::nullopt, -0.5};
  ResultFindings findings;
  findings.floor_colliding = 12;
  vehicle.write("out.h5", findings);
  const ResultReader result(vehicle.folder / "out.h5");
  CHECK(same_answer(result.header(), vehicle.header));
  Answer answer = counted_answer(result);
  CHECK(answer.body_floors == vehicle.header.body_floors);
  const auto words = [&] { return floor_words(floor_json(answer), "m"); };
  CHECK(words() ==
        "the floors of the vehicle's bodies (front bogie 0.25 m, body none, back -0.5 m)");
  answer.body_floors = {0.25, 0.25, 0.25};
  CHECK(words() == "0.25 m of the vehicle");
  answer.budget = ErrorBudget{.scan = 0.01, .sigmas = 3};
  CHECK(words() == "0.25 m of the vehicle (" + format_brief(0.25 - answer.budget->clear()) +
                       " m with the errors)");
  answer.body_floors.back() = 0.3;
  CHECK(words() ==
        "the floors of the vehicle's bodies (front bogie 0.25 m, body 0.25 m, back 0.3 "
        "m; with the errors " +
            format_brief(answer.budget->clear()) + " m lower)");
  answer.budget.reset();
  for (int i = 0; i < 5; ++i) {
    answer.bodies.push_back("wagon " + std::to_string(i));
    answer.body_floors.push_back(i < 3 ? std::optional(0.1 * (i + 1)) : std::nullopt);
  }
  CHECK(words() == "the floors of the vehicle's bodies (0.1 m to 0.3 m, 2 bodies without)");
}

TEST_CASE("a vehicle's result with a floor but without those of its bodies is refused") {
  Vehicle vehicle;
  vehicle.header.floor = 0.2;
  ResultFindings findings;
  findings.floor_colliding = 3;
  vehicle.write("out.h5", findings);
  CHECK_THROWS_WITH(vehicle.fault("out.h5"),
                    Contains("attribute 'body_floors' is missing; run it again"));
}

TEST_CASE("bodies without first poses are only those of clearances") {
  Vehicle vehicle;
  vehicle.header.first_pose = false;
  vehicle.rows.first_pose.clear();
  vehicle.rows.last_pose.clear();
  vehicle.rows.body.clear();
  vehicle.write("out.h5");
  CHECK_FALSE(vehicle.fault("out.h5"));
  const ResultReader result(vehicle.folder / "out.h5");
  CHECK(result.column(&Collisions::body).empty());
  CHECK(read_rows<Clearances>(result).body == vehicle.near.body);
}

TEST_CASE("the writer takes bodies exactly where the header has them") {
  const Vehicle vehicle;
  Collisions rows = vehicle.rows;
  rows.body.clear();
  ResultWriter writer(vehicle.folder / "a.h5", vehicle.header, rows.size(), 0);
  CHECK_THROWS_AS(writer.append(rows), std::logic_error);
  ResultHeader model = vehicle.header;
  model.bodies.clear();
  ResultWriter of_model(vehicle.folder / "b.h5", model, rows.size(), 0);
  CHECK_THROWS_AS(of_model.append(vehicle.rows), std::logic_error);
}

TEST_CASE("a body that there is not and a changed one are noticed") {
  const Vehicle vehicle;
  vehicle.write("out.h5");
  const char* dataset = GENERATE("/collisions/body", "/clearance/body");
  const bool there_is = GENERATE(false, true);
  overwrite(vehicle.folder / "out.h5", dataset, there_is ? 0 : 3);
  const auto fault = vehicle.fault("out.h5");
  REQUIRE(fault);
  if (there_is) {
    check_says(*fault, "its rows are damaged");
  } else {
    check_says(*fault, "body, row 1: expected one of the bodies");
  }
}

TEST_CASE("names of bodies that are none are refused") {
  const Vehicle vehicle;
  vehicle.write("out.h5");
  const auto path = vehicle.folder / "out.h5";
  const auto change = [&](auto call) {
    const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    call(file);
  };
  const auto replace_names = [&](const std::string& text) {
    change([&](const hdf5::Id& file) {
      REQUIRE(H5Adelete(file.get(), "bodies") >= 0);
      hdf5::write_attribute(file, "bodies", text);
    });
  };
  SECTION("an empty one") {
    replace_names("a\n\nb");
    check_refused([&] { return ResultReader(path); }, "'bodies'");
  }
  SECTION("fewer than the rows name") {
    replace_names("a\nb");
    CHECK(vehicle.fault("out.h5"));
  }
}

TEST_CASE("results of vehicles are compared by body too") {
  Vehicle a, b;
  b.rows.body[5] = (b.rows.body[5] + 1) % 3;
  b.near.body[6] = (b.near.body[6] + 1) % 3;
  a.write("out.h5");
  b.write("out.h5");
  const ResultReader in_a(a.folder / "out.h5"), in_b(b.folder / "out.h5");
  const Comparison comparison = compare_results(in_a, in_b, 9);
  check_equal(comparison.differing_first_poses, 1);
  check_equal(comparison.clearances->differing, 1);
  CHECK(compare_results(in_a, in_a, 9).equal());
  b.header.bodies[2] = "rear";
  const auto differences = query_differences(a.header, b.header);
  REQUIRE(differences.size() == 1);
  check_equal(differences[0].what, "bodies");
  check_equal(differences[0].b, "front bogie, body, rear");
}

namespace {

ResultHeader header_with_clearance() {
  ResultHeader header = sample_header(false);
  header.clearance = 0.75;
  return header;
}

std::optional<std::string> fault_of(const std::filesystem::path& path) {
  NoProgress progress;
  return verify_result(ResultReader(path), progress);
}

}  // namespace

TEST_CASE("clearances are read as they were written") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const std::size_t count = GENERATE(0u, 1u, 65'536u, 150'000u);
  const Collisions rows = sample_rows(header, 70'000);
  const Clearances clearances = sample_clearances(header, count);
  write_result(folder / "a.h5", header, rows, 1000, clearances);
  const ResultReader reader(folder / "a.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.clearances() == count);
  const Clearances read = read_rows<Clearances>(reader);
  CHECK(read.source == clearances.source);
  CHECK(read.xyz == clearances.xyz);
  CHECK(read.distance == clearances.distance);
  CHECK(read.pose == clearances.pose);
  CHECK(same_rows(read_rows(reader), rows));
  CHECK_FALSE(fault_of(folder / "a.h5"));
  write_result(folder / "b.h5", header, rows, 69'999, clearances);
  CHECK(bytes_of(folder / "a.h5") == bytes_of(folder / "b.h5"));
}

TEST_CASE("a result without clearances has none") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(false);
  write_result(folder / "a.h5", header, sample_rows(header, 3));
  const ResultReader reader(folder / "a.h5");
  check_equal(reader.clearances(), 0);
  check_equal(read_rows<Clearances>(reader).size(), 0);
  ResultWriter writer(folder / "b.h5", header, 0);
  CHECK_THROWS_AS(writer.append(Clearances{}), std::logic_error);
}

TEST_CASE("a writer refuses clearances that do not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const Clearances rows = sample_clearances(header, 3);
  const auto append = [&](ResultWriter& writer, std::size_t first, std::size_t count) {
    writer.append(part_of(rows, first, count));
  };
  ResultWriter writer(folder / "a.h5", header, 0, 2);
  CHECK_THROWS_AS(append(writer, 0, 3), std::logic_error);
  append(writer, 1, 1);
  CHECK_THROWS_AS(append(writer, 0, 1), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  ResultWriter early(folder / "b.h5", header, 1, 1);
  CHECK_THROWS_AS(append(early, 0, 1), std::logic_error);  // clearances before the collisions
}

TEST_CASE("clearances that no run can have found are faults") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  Clearances rows = sample_clearances(header, 70'000);
  const auto at = GENERATE(as<std::size_t>(), 0, 65'536, 69'999);
  std::string expected;
  SECTION("too far") { rows.distance[at] = std::nextafter(0.75, 1), expected = "distance"; }
  SECTION("negative") { rows.distance[at] = -1e-9, expected = "distance"; }
  SECTION("not a number") { rows.distance[at] = std::nan(""), expected = "distance"; }
  SECTION("nowhere") { rows.xyz[at].y = std::nan(""), expected = "xyz"; }
  SECTION("a pose past the end") { rows.pose[at] = 4'000'000'000, expected = "pose"; }
  SECTION("a point past the end") {
    rows.source.back() = header.environment_points, expected = "/clearance/source";
  }
  write_result(folder / "a.h5", header, {}, 1000, rows);
  const auto fault = fault_of(folder / "a.h5");
  REQUIRE(fault);
  check_says(*fault, "/clearance/");
  check_says(*fault, expected + " ... row ");
}

TEST_CASE("clearances are compared where both results have them") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const Clearances a = sample_clearances(header, 1000);
  Clearances b = a;
  b.distance[5] = std::nextafter(b.distance[5], 0);
  b.pose[7] ^= 1;
  b.xyz[9].z += 0.01;
  b.source.erase(b.source.begin() + 3);
  b.xyz.erase(b.xyz.begin() + 3);
  b.distance.erase(b.distance.begin() + 3);
  b.pose.erase(b.pose.begin() + 3);
  write_result(folder / "a.h5", header, {}, 1000, a);
  write_result(folder / "b.h5", header, {}, 1000, b);
  ResultHeader without = header;
  without.clearance = 0;
  write_result(folder / "c.h5", without, {});
  const ResultReader ra(folder / "a.h5"), rb(folder / "b.h5"), rc(folder / "c.h5");
  CHECK(compare_results(ra, ra, 9).equal());
  const Comparison differing = compare_results(ra, rb, 9);
  CHECK_FALSE(differing.equal());
  CHECK(differing.clearances == TableComparison{1000, 999, 999, 1, 0, 3});
  const Comparison one_sided = compare_results(ra, rc, 9);
  CHECK(one_sided.equal());
  CHECK_FALSE(one_sided.clearances);
  REQUIRE(one_sided.queries.size() == 1);
  check_equal(one_sided.queries[0].a, "0.75 m");
}

namespace {

ResultHeader header_with_profile(std::uint64_t poses) {
  ResultHeader header = sample_header(true);
  header.poses = poses;
  header.clearance = 0.5;
  header.profile = 0.75;
  return header;
}

/// Whether two lists have the same bits, so that NaN equals NaN.
bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

std::optional<std::string> fault_of_profile(const std::filesystem::path& path) {
  NoProgress progress;
  return verify_result(ResultReader(path), progress);
}

}  // namespace

TEST_CASE("a profile is read as it was written") {
  const ScratchFolder folder;
  const auto poses = GENERATE(as<std::uint64_t>(), 0, 1, 65'536, 150'000);
  const ResultHeader header = header_with_profile(poses);
  const std::size_t others = poses == 0 ? 0 : 70'000;
  const Collisions rows = sample_rows(header, others);
  const Clearances clearances = sample_clearances(header, others);
  const ProfileRows profile = sample_profile(header);
  write_result(folder / "a.h5", header, rows, 1000, clearances, profile);
  const ResultReader reader(folder / "a.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.profile_rows() == poses);
  const ProfileRows read = read_rows<ProfileRows>(reader);
  CHECK(read.distance == profile.distance);
  CHECK(read.source == profile.source);
  CHECK(same_bits(read.xyz, profile.xyz));
  CHECK(read.chainage == profile.chainage);
  CHECK(same_rows(read_rows(reader), rows));
  CHECK_FALSE(fault_of_profile(folder / "a.h5"));
  write_result(folder / "b.h5", header, rows, 69'999, clearances, profile);
  CHECK(bytes_of(folder / "a.h5") == bytes_of(folder / "b.h5"));
}

TEST_CASE("a result without a profile has none") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", sample_header(false), {});
  const ResultReader reader(folder / "a.h5");
  check_equal(reader.profile_rows(), 0);
  check_equal(read_rows<ProfileRows>(reader).size(), 0);
  ResultWriter writer(folder / "b.h5", sample_header(false), 0);
  CHECK_THROWS_AS(writer.append(ProfileRows{}), std::logic_error);
}

TEST_CASE("a writer refuses a profile that does not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(3);
  const ProfileRows rows = sample_profile(header);
  const auto append = [&](ResultWriter& writer, std::size_t count, std::size_t sources) {
    ProfileRows part = part_of(rows, 0, count);
    part.source.resize(sources);
    writer.append(part);
  };
  ResultWriter writer(folder / "a.h5", header, 0);
  CHECK_THROWS_AS(append(writer, 3, 2), std::logic_error);
  append(writer, 2, 2);
  CHECK_THROWS_AS(append(writer, 2, 2), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  ResultWriter early(folder / "b.h5", header, 1);
  CHECK_THROWS_AS(append(early, 3, 3), std::logic_error);  // a profile before the collisions
}

TEST_CASE("a profile that no run can have found is a fault") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(70'000);
  ProfileRows rows = sample_profile(header);
  const auto at = GENERATE(as<std::size_t>(), 0, 65'536, 69'998);
  const double none = std::nan("");
  std::string expected;
  SECTION("too far") { rows.distance[at] = std::nextafter(0.75, 1), expected = "/distance"; }
  SECTION("negative") { rows.distance[at] = -1e-9, expected = "/distance"; }
  SECTION("not a number") { rows.distance[at] = none, expected = "/distance"; }
  SECTION("infinity with a point") {
    rows.distance[at] = std::numeric_limits<double>::infinity(), expected = "/distance";
  }
  SECTION("a distance without a point") {
    rows.source[at] = Profile::kNoPoint, rows.xyz[at] = {none, none, none};
    expected = "/distance";
  }
  SECTION("a point past the end") {
    rows.source[at] = header.environment_points, expected = "/source";
  }
  SECTION("a point nowhere") { rows.xyz[at].z = none, expected = "/xyz"; }
  SECTION("a place without a point") { rows.xyz[at + 4 - at % 5].x = 1, expected = "/xyz"; }
  SECTION("a path that goes back") {
    rows.chainage[at] = at == 0 ? -1 : rows.chainage[at - 1] - 0.5, expected = "/chainage";
  }
  SECTION("a chainage that is not a number") { rows.chainage[at] = none, expected = "/chainage"; }
  if (at + 4 - at % 5 >= rows.size() && expected == "/xyz" && !std::isnan(rows.xyz[at].z)) return;
  write_result(folder / "a.h5", header, {}, 1000, {}, rows);
  const auto fault = fault_of_profile(folder / "a.h5");
  REQUIRE(fault);
  check_says(*fault, std::string("/profile") + expected + " ... row ");
}

TEST_CASE("a path that does not begin at 0 is a fault") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(3);
  ProfileRows rows = sample_profile(header);
  rows.chainage = {1, 1, 2};
  write_result(folder / "a.h5", header, {}, 1000, {}, rows);
  check_says(fault_of_profile(folder / "a.h5").value_or(""), "/profile/chainage, row 0");
}

TEST_CASE("profiles are compared where both results have one of the same path") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(100);
  const ProfileRows a = sample_profile(header);
  ProfileRows b = a;
  b.distance[51] = std::nextafter(b.distance[51], 0);
  b.source[60] ^= 1;
  b.xyz[70].x += 1;
  ResultHeader elsewhere = header, without = header;
  elsewhere.trajectory_hash ^= 1;
  without.profile = 0;
  write_result(folder / "a.h5", header, {}, 1000, {}, a);
  write_result(folder / "b.h5", header, {}, 1000, {}, b);
  write_result(folder / "c.h5", elsewhere, {}, 1000, {}, a);
  write_result(folder / "d.h5", without, {});
  const ResultReader ra(folder / "a.h5"), rb(folder / "b.h5");
  CHECK(compare_results(ra, ra, 9).profiles == ProfileComparison{100, 0, std::nullopt});
  const Comparison differing = compare_results(ra, rb, 9);
  CHECK_FALSE(differing.equal());
  CHECK(differing.profiles == ProfileComparison{100, 3, 51});
  CHECK_FALSE(compare_results(ra, ResultReader(folder / "c.h5"), 9).profiles);
  const Comparison one_sided = compare_results(ra, ResultReader(folder / "d.h5"), 9);
  CHECK_FALSE(one_sided.profiles);
  REQUIRE(one_sided.queries.size() == 1);
  check_equal(one_sided.queries[0].what, "profile");
}
