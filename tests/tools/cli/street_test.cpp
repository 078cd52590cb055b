// Real scans through the built program: the known answer for the street, and what is refused.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "cpu/brute_force.hpp"
#include "io/scans/point_reader.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

std::filesystem::path street(const std::string& name) { return data_folder() / "street" / name; }

/// FNV-1a with 64 bits over the indices as 8 little-endian bytes each. The starting value is that
/// with which the known answers were recorded, a tenth of the usual one.
std::uint64_t fnv1a(const std::vector<std::uint64_t>& indices) {
  std::uint64_t hash = 1469598103934665603;
  for (const std::uint64_t index : indices) {
    for (unsigned i = 0; i < 8; ++i) hash = (hash ^ (index >> (8 * i) & 0xff)) * 0x100000001b3;
  }
  return hash;
}

void convert_street(const ScratchFolder& folder, const std::string& options) {
  REQUIRE(run_program(folder, "convert --force " + quoted(street("street.las")) + " -o " +
                                  quoted(folder / "street.h5") + " " + options)
              .exit_code == 0);
}

void check_street(const ScratchFolder& folder, const std::string& radius, std::size_t count,
                  std::uint64_t hash) {
  REQUIRE(run_program(folder, "run --force --env " + quoted(folder / "street.h5") + " --model " +
                                  quoted(street("beetle.ply")) + " --trajectory " +
                                  quoted(street("trajectory.txt")) + " --radius " + radius +
                                  " -o " + quoted(folder / "out.h5"))
              .exit_code == 0);
  const auto rows = read_rows(ResultReader(folder / "out.h5"));
  CHECK(rows.size() == count);
  CHECK(fnv1a(rows.source) == hash);
}

/// Every n-th value of a list.
template <typename Value>
std::vector<Value> thinned(const std::vector<Value>& all, std::size_t n) {
  std::vector<Value> out;
  for (std::size_t i = 0; i < all.size(); i += n) out.push_back(all[i]);
  return out;
}

void write_trajectory_file(const std::filesystem::path& path, const std::vector<Pose>& poses) {
  std::string text;
  for (const Pose& pose : poses) {
    char line[400];
    const double* r = pose.rotation;
    const double* t = pose.translation;
    std::snprintf(line, sizeof line,
                  "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", r[0],
                  r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2]);
    text += line;
  }
  put_bytes(path, text);
}

/// A piece of the street around one of its poses, small enough for brute force.
struct Crop {
  Crop() {
    model = thinned(read_model_points(street("beetle.ply")), 60);
    poses = thinned(read_trajectory(street("trajectory.txt"), {}), 9);
    const double* centre = poses[poses.size() / 2].translation;
    const auto reader = open_point_file(street("street.las"));
    quantisation = *reader->info().quantisation;
    PointBatch batch;
    while (points.size() < 20'000 && reader->read(batch)) {
      for (const Quantum& q : batch.quanta) {
        const Vec3 p = position(quantisation, q[0], q[1], q[2]);
        const bool near = std::abs(p.x - centre[0]) < 4 && std::abs(p.y - centre[1]) < 4;
        if (near && points.size() < 20'000) points.push_back(q);
      }
    }
  }

  void move(const Vec3& by) {
    for (int k = 0; k < 3; ++k) {
      quantisation.offset[k] += by[k];
      for (Pose& pose : poses) pose.translation[k] += by[k];
    }
  }

  std::vector<Vec3> positions() const {
    std::vector<Vec3> out;
    for (const Quantum& q : points) out.push_back(position(quantisation, q[0], q[1], q[2]));
    return out;
  }

  std::vector<Vec3> model;
  std::vector<Pose> poses;
  std::vector<Quantum> points;
  Quantisation quantisation{};
};

void check_against_brute_force(const Crop& crop, double radius) {
  const ScratchFolder folder;
  write_las(folder / "crop.las", crop.points, crop.quantisation);
  write_ply(folder / "model.ply", crop.model);
  write_trajectory_file(folder / "path.txt", crop.poses);
  REQUIRE(run_program(folder, "convert " + quoted(folder / "crop.las") + " -o " +
                                  quoted(folder / "crop.h5") + " --cell-points 1000")
              .exit_code == 0);
  REQUIRE(run_program(folder, "run --first-pose --profile 0.5 --env " + quoted(folder / "crop.h5") +
                                  " --model " + quoted(folder / "model.ply") + " --trajectory " +
                                  quoted(folder / "path.txt") + " --radius " +
                                  std::to_string(radius) + " -o " + quoted(folder / "out.h5"))
              .exit_code == 0);
  const auto positions = crop.positions();
  const auto first = brute_force_first_poses(positions, {crop.model, crop.poses, {radius, true}});
  Collisions expected;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == HitSet::kNever) continue;
    expected.source.push_back(i);
    expected.xyz.push_back(positions[i]);
    expected.first_pose.push_back(first[i]);
  }
  CHECK(expected.size() > 100);
  CHECK(expected.size() < crop.points.size());
  const ResultReader result(folder / "out.h5");
  CHECK(same_rows(read_rows(result), expected));
  Query query{crop.model, crop.poses, {radius}};
  query.profile = 0.5;
  ProfileRows profile;
  REQUIRE(RowStream<ProfileRows>(result).read(profile));
  const auto nearest = brute_force_profile(positions, query);
  for (std::size_t pose = 0; pose < nearest.size(); ++pose) {
    CHECK(profile.distance[pose] == std::sqrt(nearest[pose].squared));
    CHECK(profile.source[pose] == nearest[pose].source);
  }
}

Outcome convert_file(const ScratchFolder& folder, const std::filesystem::path& file,
                     const std::string& options = "") {
  return run_program(
      folder, "convert --force " + quoted(file) + " -o " + quoted(folder / "a.h5") + " " + options);
}

}  // namespace

TEST_CASE("the street gives the known answer") {
  const ScratchFolder folder;
  convert_street(folder, "");
  check_street(folder, "0.1", 78'439, 0xd4d727161424e54f);
  check_street(folder, "0.5", 238'446, 0xb326e6aa58c9fb30);
  const std::string bytes = bytes_of(folder / "street.h5");
  convert_street(folder, "--memory 224M --threads 1");
  CHECK((bytes_of(folder / "street.h5") == bytes));
  convert_street(folder, "--cell-points 1000");
  check_street(folder, "0.1", 78'439, 0xd4d727161424e54f);
}

TEST_CASE("the street is warned of its steps and of nothing else") {
  const ScratchFolder folder;
  convert_street(folder, "");
  const std::string run = "run --strict --env " + quoted(folder / "street.h5") + " --model " +
                          quoted(street("beetle.ply")) + " --trajectory " +
                          quoted(street("trajectory.txt")) + " --radius 0.1 -o " +
                          quoted(folder / "out.h5");
  const Outcome outcome = run_program(folder, run);
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.err, Contains("at 153 of 153 steps") && Contains("--between-poses") &&
                              Contains("strict: 1 warning (large-steps)"));
  CHECK(run_program(folder, run + " --between-poses").exit_code == 0);
}

TEST_CASE("a piece of the street gives what brute force gives, also far from the origin") {
  Crop crop;
  REQUIRE(crop.points.size() > 5000);
  check_against_brute_force(crop, 0.1);
  check_against_brute_force(crop, 0.5);
  crop.move({5e6, 2e6, 1e3});
  check_against_brute_force(crop, 0.1);
}

TEST_CASE("LAS and PLY files of many kinds become sound stores") {
  const ScratchFolder folder;
  for (const char* name :
       {"1.0_0.las", "1.1_1.las", "1.2-with-color.las", "1.2_3.las", "1_4_w_evlr.las",
        "autzen-utm.las", "autzen_trim_7.las", "extrabytes.las", "no-points-1.3.las", "rand1_6.las",
        "simple1_3.las", "test1_4.las", "simple_binary.ply", "simple_text.ply",
        "text_extradim.ply"}) {
    CAPTURE(name);
    const Outcome outcome = convert_file(folder, data_folder() / "formats" / name);
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.out.empty());
    CHECK(run_program(folder, "verify " + quoted(folder / "a.h5")).exit_code == 0);
  }
}

TEST_CASE("degrees are refused and feet reported in real files") {
  const ScratchFolder folder;
  for (const char* name : {"epsg_4326.las", "simple1_4.las"}) {
    CAPTURE(name);
    const Outcome refused = convert_file(folder, data_folder() / "formats" / name);
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains(name) && Contains("degrees") && Contains("--ignore-crs"));
    CHECK(convert_file(folder, data_folder() / "formats" / name, "--ignore-crs").exit_code == 0);
  }
  const Outcome feet = convert_file(folder, data_folder() / "formats" / "test1_4.las");
  CHECK(feet.exit_code == 0);
  CHECK_THAT(feet.err, Contains("feet"));
}

TEST_CASE("public cases of heights in feet and of web Mercator are no clear lorry") {
  const ScratchFolder folder;
  const auto file = [](const std::string& name) { return data_folder() / "cases" / name; };
  const auto colliding = [&](const std::string& model, const std::string& path,
                             const std::string& radius) {
    const Outcome run =
        run_program(folder, "run --json --force --env " + quoted(folder / "a.h5") + " --model " +
                                quoted(file(model)) + " --trajectory " + quoted(file(path)) +
                                " --radius " + radius + " -o " + quoted(folder / "out.h5"));
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    return nlohmann::json::parse(run.out);
  };
  for (const char* name : {"f1_esri_vertcs.las", "f1_geotiff_4096_6360.las"}) {
    CAPTURE(name);
    const Outcome refused = convert_file(folder, file(name));
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("its heights are in us-survey-foot") &&
                                Contains("--unit-z us-ft converts the heights"));
    REQUIRE(convert_file(folder, file(name), "--unit-z us-ft").exit_code == 0);
    CHECK(colliding("f1_lorry.off", "f1_road.txt", "0.1")["colliding_points"] > 0);
  }
  const Outcome mercator = convert_file(folder, file("f2_web_mercator.las"));
  CHECK(mercator.exit_code == 3);
  CHECK_THAT(mercator.err, Contains("1.494 times by area") && Contains("--ignore-crs"));
  REQUIRE(convert_file(folder, file("f2_web_mercator.las"), "--ignore-crs").exit_code == 0);
  const auto report = colliding("f2_lorry.off", "f2_path.txt", "0.3");
  CHECK(std::ranges::any_of(report["warnings"], [](const nlohmann::json& warning) {
    return warning["code"] == "store-map-scale";
  }));
  REQUIRE(convert_file(folder, file("f5_geotiff_3077.las")).exit_code == 0);
  CHECK(StoreReader(folder / "a.h5").metadata().unit == LengthUnit::kUsSurveyFoot);
}

TEST_CASE("malformed scans are refused by name") {
  const ScratchFolder folder;
  for (const char* name : {"1.2-no-points.las", "garbage_nVariableLength.las", "broken_size.laz",
                           "no_vertex.ply", "empty.ply", "bad-crc.e57", "missingheader.pcd"}) {
    CAPTURE(name);
    const Outcome outcome = convert_file(folder, data_folder() / "malformed" / name);
    CHECK(outcome.exit_code == 3);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Contains(name));
    CHECK_FALSE(std::filesystem::exists(folder / "a.h5"));
  }
}

TEST_CASE("a car along y is turned into the street, as the car that was turned by hand") {
  const ScratchFolder folder;
  convert_street(folder, "");
  std::string turned;  // by -90 degrees about z
  std::ifstream car(street("prius.obj"));
  for (std::string line; std::getline(car, line);) {
    char x[40], y[40], z[40];
    if (std::sscanf(line.c_str(), "v %39s %39s %39s", x, y, z) == 3) {
      const std::string opposite = x[0] == '-' ? x + 1 : std::string("-") + x;
      line = std::string("v ") + y + " " + opposite + " " + z;
    }
    turned += line + "\n";
  }
  put_bytes(folder / "turned.obj", turned);
  const auto run = [&](const std::filesystem::path& model, const std::string& output,
                       const std::string& options) {
    const Outcome done = run_program(
        folder, "run --env " + quoted(folder / "street.h5") + " --model " + quoted(model) +
                    " --trajectory " + quoted(street("trajectory.txt")) +
                    " --radius 0.1 --model-above 0.3 --first-pose -o " + quoted(folder / output) +
                    " " + options);
    INFO(done.err);
    REQUIRE(done.exit_code == 0);
    return done.err;
  };
  run(folder / "turned.obj", "hand.h5", "");
  CHECK_THAT(run(street("prius.obj"), "turned.h5", "--forward +y"), !Contains("sideways"));
  CHECK_THAT(run(street("prius.obj"), "across.h5", ""),
             Contains("it drives sideways") && Contains("--forward and --up turn the model"));
  CHECK(run_program(folder,
                    "compare " + quoted(folder / "hand.h5") + " " + quoted(folder / "turned.h5"))
            .exit_code == 0);
  CHECK(run_program(folder,
                    "compare " + quoted(folder / "hand.h5") + " " + quoted(folder / "across.h5"))
            .exit_code == 1);
  const Outcome page = run_program(
      folder, "report " + quoted(folder / "turned.h5") + " --env " + quoted(folder / "street.h5") +
                  " --model " + quoted(street("prius.obj")) + " --model-above 0.3 --trajectory " +
                  quoted(street("trajectory.txt")) + " -o " + quoted(folder / "page.html"));
  INFO(page.err);
  CHECK(page.exit_code == 0);
}

TEST_CASE("one command goes from the street's files to the known answer and its page") {
  const ScratchFolder folder;
  const std::string check = "check " + quoted(street("street.las")) + " --model " +
                            quoted(street("beetle.ply")) + " --trajectory " +
                            quoted(street("trajectory.txt")) + " --radius 0.1 -o " +
                            quoted(folder / "site") + " --fail-on-collision";
  const Outcome first = run_program(folder, check);
  INFO(first.err);
  REQUIRE(first.exit_code == 1);
  const auto rows = read_rows(ResultReader(folder / "site/result.h5"));
  CHECK(rows.size() == 78439);
  CHECK(fnv1a(rows.source) == 0xd4d727161424e54f);
  for (const char* name : {"site.h5", "conflicts.csv", "report.html"}) {
    CHECK(std::filesystem::file_size(folder / "site" / name) > 0);
  }
  const Outcome second = run_program(folder, check);
  CHECK(second.exit_code == 1);
  CHECK(second.out == first.out);
  CHECK_THAT(second.err, Contains("nothing was to be done"));
}
