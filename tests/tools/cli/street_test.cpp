// Real scans through the built program: the known answer for the street, and what is refused.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "io/scans/point_reader.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

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
  require_success(run_program(
      folder, "convert --force " + quoted(street("street.las")) + " -o street.h5 " + options));
}

void check_street(const ScratchFolder& folder, const std::string& radius, std::size_t count,
                  std::uint64_t hash) {
  require_success(run_program(folder, "run --force --env street.h5 --model " +
                                          quoted(street("beetle.ply")) + " --trajectory " +
                                          quoted(street("trajectory.txt")) + " --radius " + radius +
                                          " -o out.h5"));
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
  require_success(run_program(folder, "convert crop.las -o crop.h5 --cell-points 1000"));
  require_success(run_program(folder,
                              "run --first-pose --profile 0.5 --env crop.h5 --model model.ply "
                              "--trajectory path.txt --radius " +
                                  std::to_string(radius) + " -o out.h5"));
  const auto positions = crop.positions();
  const auto first = brute_force_first_poses(positions, {crop.model, crop.poses, {radius, true}});
  Collisions expected;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == kNoPose) continue;
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
  return run_program(folder, "convert --force " + quoted(file) + " -o a.h5 " + options);
}

}  // namespace

TEST_CASE("the street gives the known answer") {
  const ScratchFolder folder;
  convert_street(folder, "");
  check_street(folder, "0.1", 78'439, 0xd4d727161424e54f);
  check_street(folder, "0.5", 238'446, 0xb326e6aa58c9fb30);
  const std::string bytes = bytes_of(folder / "street.h5");
  convert_street(folder, "--memory 224M --threads 1");
  check_same(bytes_of(folder / "street.h5"), bytes);
  convert_street(folder, "--cell-points 1000");
  check_street(folder, "0.1", 78'439, 0xd4d727161424e54f);
}

TEST_CASE("the street is warned of its steps and of nothing else") {
  const ScratchFolder folder;
  convert_street(folder, "");
  const std::string run = "run --strict --env street.h5 --model " + quoted(street("beetle.ply")) +
                          " --trajectory " + quoted(street("trajectory.txt")) +
                          " --radius 0.1 -o out.h5";
  check_outcome(run_program(folder, run), 3,
                "at 153 of 153 steps ... --between-poses ... strict: 1 warning (large-steps)");
  check_outcome(run_program(folder, run + " --between-poses"), 0);
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
  for (const std::string name :
       {"1.0_0.las", "1.1_1.las", "1.2-with-color.las", "1.2_3.las", "1_4_w_evlr.las",
        "autzen-utm.las", "autzen_trim_7.las", "extrabytes.las", "no-points-1.3.las", "rand1_6.las",
        "simple1_3.las", "test1_4.las", "simple_binary.ply", "simple_text.ply",
        "text_extradim.ply"}) {
    CAPTURE(name);
    const Outcome outcome = convert_file(folder, data_folder() / "formats" / name);
    check_outcome(outcome, 0);
    CHECK(outcome.out.empty());
    check_outcome(run_program(folder, "verify a.h5"), 0);
  }
}

TEST_CASE("degrees are refused and feet reported in real files") {
  const ScratchFolder folder;
  for (const char* name : {"epsg_4326.las", "simple1_4.las"}) {
    CAPTURE(name);
    check_outcome(convert_file(folder, data_folder() / "formats" / name), 3,
                  name + std::string(" ... degrees ... --ignore-crs"));
    check_outcome(convert_file(folder, data_folder() / "formats" / name, "--ignore-crs"), 0);
  }
  const Outcome feet = convert_file(folder, data_folder() / "formats" / "test1_4.las");
  check_outcome(feet, 0, "feet");
}

TEST_CASE("public cases of heights in feet and of web Mercator are no clear lorry") {
  const ScratchFolder folder;
  const auto file = [](const std::string& name) { return data_folder() / "cases" / name; };
  const auto colliding = [&](const std::string& model, const std::string& path,
                             const std::string& radius) {
    return json_of(require_success(run_program(
        folder, "run --json --force --env a.h5 --model " + quoted(file(model)) + " --trajectory " +
                    quoted(file(path)) + " --radius " + radius + " -o out.h5")));
  };
  for (const char* name : {"f1_esri_vertcs.las", "f1_geotiff_4096_6360.las"}) {
    CAPTURE(name);
    check_outcome(convert_file(folder, file(name)), 3,
                  "its heights are in us-survey-foot ... --unit-z us-ft converts the heights");
    require_success(convert_file(folder, file(name), "--unit-z us-ft"));
    CHECK(colliding("f1_lorry.off", "f1_road.txt", "0.1")["colliding_points"] > 0);
  }
  check_outcome(convert_file(folder, file("f2_web_mercator.las")), 3,
                "1.494 times by area ... --ignore-crs");
  require_success(convert_file(folder, file("f2_web_mercator.las"), "--ignore-crs"));
  const auto report = colliding("f2_lorry.off", "f2_path.txt", "0.3");
  CHECK(std::ranges::any_of(report["warnings"], [](const nlohmann::json& warning) {
    return warning["code"] == "store-map-scale";
  }));
  require_success(convert_file(folder, file("f5_geotiff_3077.las")));
  CHECK(StoreReader(folder / "a.h5").metadata().unit == LengthUnit::kUsSurveyFoot);
}

TEST_CASE("malformed scans are refused by name") {
  const ScratchFolder folder;
  for (const char* name : {"1.2-no-points.las", "garbage_nVariableLength.las", "broken_size.laz",
                           "no_vertex.ply", "empty.ply", "bad-crc.e57", "missingheader.pcd"}) {
    CAPTURE(name);
    check_refused(convert_file(folder, data_folder() / "malformed" / name), 3, name);
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
    const Outcome done = require_success(run_program(
        folder, "run --env street.h5 --model " + quoted(model) + " --trajectory " +
                    quoted(street("trajectory.txt")) +
                    " --radius 0.1 --floor 0.3 --first-pose -o " + output + " " + options));
    return done.err;
  };
  run(folder / "turned.obj", "hand.h5", "");
  check_lacks(run(street("prius.obj"), "turned.h5", "--forward +y"), "sideways");
  check_says(run(street("prius.obj"), "across.h5", ""),
             "it drives sideways ... --forward and --up turn the model");
  check_outcome(run_program(folder, "compare hand.h5 turned.h5"), 0);
  check_outcome(run_program(folder, "compare hand.h5 across.h5"), 1);
  check_outcome(run_program(folder, "report turned.h5 --env street.h5 --model " +
                                        quoted(street("prius.obj")) + " --trajectory " +
                                        quoted(street("trajectory.txt")) + " -o page.html"),
                0);
}

TEST_CASE("one command goes from the street's files to the known answer and its page") {
  const ScratchFolder folder;
  const std::string check = "check " + quoted(street("street.las")) + " --model " +
                            quoted(street("beetle.ply")) + " --trajectory " +
                            quoted(street("trajectory.txt")) +
                            " --radius 0.1 -o site --fail-on-collision";
  const Outcome first = run_program(folder, check);
  INFO(first.err);
  REQUIRE(first.exit_code == 1);
  // The steps of the path are larger than the radius, so `check` puts poses between, and the known
  // answer is of the path as it is.
  const auto rows = read_rows(ResultReader(folder / "site/result.h5"));
  require_success(run_program(
      folder, "run --env site/site.h5 --model " + quoted(street("beetle.ply")) + " --trajectory " +
                  quoted(street("trajectory.txt")) + " --radius 0.1 -o known.h5"));
  const auto known = read_rows(ResultReader(folder / "known.h5"));
  CHECK(known.size() == 78439);
  CHECK(fnv1a(known.source) == 0xd4d727161424e54f);
  CHECK(rows.size() > known.size());
  CHECK(std::ranges::includes(rows.source, known.source));
  for (const char* name : {"site.h5", "conflicts.csv", "report.html"}) {
    CHECK(std::filesystem::file_size(folder / "site" / name) > 0);
  }
  const Outcome second = run_program(folder, check);
  check_outcome(second, 1);
  CHECK(second.out == first.out);
  check_says(second.err, "nothing was to be done");
}
