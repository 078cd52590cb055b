// Results of vehicles: names of bodies, and the columns that name one.
#include <algorithm>
#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "io/result/check_results.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

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

  void write(const std::string& name) const {
    ResultWriter writer(folder / name, header, rows.size(), near.size());
    writer.append(rows);
    writer.append(near);
    writer.finish();
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
  vehicle.write("out.h5");
  const ResultReader result(vehicle.folder / "out.h5");
  CHECK(same_answer(result.header(), vehicle.header));
  CHECK_FALSE(vehicle.fault("out.h5"));
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
    CHECK_THAT(*fault, Contains("its rows are damaged"));
  } else {
    CHECK_THAT(*fault, Contains("body, row 1: expected one of the bodies"));
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
    CHECK_THROWS_WITH(ResultReader(path), Contains("'bodies'"));
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
  CHECK(comparison.differing_first_poses == 1);
  CHECK(comparison.clearances->differing == 1);
  CHECK(compare_results(in_a, in_a, 9).equal());
  b.header.bodies[2] = "rear";
  const auto differences = query_differences(a.header, b.header);
  REQUIRE(differences.size() == 1);
  CHECK(differences[0].what == "bodies");
  CHECK(differences[0].b == "front bogie, body, rear");
}
