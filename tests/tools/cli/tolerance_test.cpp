// The built program with --tolerance: what it reports, records and refuses.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "cpu/brute_force.hpp"
#include "io/result/journal.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// The least distance of every point of the hall, by brute force.
std::vector<double> distances_in(const Hall& hall) {
  const StoreReader store(hall.path("site.h5"));
  std::vector<Vec3> environment;
  for (const Quantum& q : points_by_source(store)) {
    environment.push_back(position(store.quantisation(), q[0], q[1], q[2]));
  }
  const std::vector<Vec3> model = read_model_points(hall.path("model.ply"));
  const std::vector<Pose> poses = read_trajectory(hall.path("trajectory.txt"), {});
  std::vector<double> out;
  for (const Clearance& c : brute_force_clearances(environment, {model, poses, {0.1}})) {
    out.push_back(std::sqrt(c.squared));
  }
  return out;
}

}  // namespace

TEST_CASE("with a tolerance only points near the radius differ, and the run says what it spared") {
  const Work work;
  const std::vector<double> distances = distances_in(work.hall);
  std::uint64_t spared = 0;
  for (const double tolerance : {1e-6, 0.01, 0.06}) {
    CAPTURE(tolerance);
    const Outcome run =
        work.run_hall(work.hall / "site.h5", "out.h5",
                      "--force --json --device cpu --tolerance " + std::to_string(tolerance));
    REQUIRE(run.exit_code == 0);
    const ResultReader result(work.folder / "out.h5");
    std::vector<bool> found(distances.size());
    for (const std::uint64_t source : read_rows(result).source) found[source] = true;
    double farthest = 0;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (found[i] == (distances[i] < 0.1)) continue;
      farthest = std::max(farthest, std::abs(distances[i] - 0.1));
    }
    CHECK(farthest <= tolerance);
    CHECK(result.header().tolerance == tolerance);
    CHECK(result.header().engine == "sweep");
    CHECK(result.header().model_points == 300);
    CHECK(result.header().poses == 150);

    const json report = json::parse(run.out);
    const json& told = report["tolerance"];
    CHECK(told["metres"] == tolerance);
    CHECK(told["model_points"] == 300);
    CHECK(told["poses"] == 150);
    const std::uint64_t points = told["model_points_kept"], poses = told["poses_kept"];
    CHECK(points <= 300);
    CHECK(poses <= 150);
    CHECK(told["searches_saved"] == 300 * 150 - points * poses);
    CHECK(report["searches"] == 300 * 150);
    spared += told["searches_saved"].get<std::uint64_t>() +
              told["settled_by_bounds"].get<std::uint64_t>();
    CHECK(report["seconds"]["thin"].is_number());
    CHECK_THAT(run.err, Contains("of 300 model points and ") && Contains("of 150 poses"));
    CHECK(work.run("verify " + work.path("out.h5")).exit_code == 0);
  }
  CHECK(spared > 300);
}

TEST_CASE("without a tolerance the result holds none, and the run reports none") {
  const Work work;
  const Outcome run = work.run_hall(work.hall / "site.h5", "out.h5", "--json");
  REQUIRE(run.exit_code == 0);
  CHECK(json::parse(run.out)["tolerance"].is_null());
  const ResultReader result(work.folder / "out.h5");
  CHECK(result.header().tolerance == 0);
  CHECK(result.header().engine.empty());
}

TEST_CASE("with a tolerance neither threads, memory nor the store's cells change the result") {
  const Work work;
  const std::string options = "--device cpu --tolerance 0.03 --force ";
  REQUIRE(work.run_hall(work.hall / "site.h5", "out.h5", options).exit_code == 0);
  const std::string expected = work.bytes("out.h5");
  for (const char* other : {"--threads 1", "--threads 3 --memory 1G", "--engine sweep"}) {
    REQUIRE(work.run_hall(work.hall / "site.h5", "out.h5", options + other).exit_code == 0);
    CHECK((work.bytes("out.h5") == expected));
  }
  REQUIRE(work.run("convert " + work.hall / "environment.las" + " --cell-points 500 -o " +
                   work.path("other.h5"))
              .exit_code == 0);
  REQUIRE(work.run_hall(work.path("other.h5"), "out.h5", options).exit_code == 0);
  CHECK((work.bytes("out.h5") == expected));
  // The field is not made coarser to fit into memory, because the answer depends on it.
  check_refused(work.run_hall(work.hall / "site.h5", "out.h5", options + "--memory 1M"), 4,
                "--memory");
}

TEST_CASE("compare and info name tolerance and engine") {
  const Work work;
  REQUIRE(work.run_hall(work.hall / "site.h5", "exact.h5").exit_code == 0);
  REQUIRE(work.run_hall(work.hall / "site.h5", "near.h5", "--tolerance 0.02").exit_code == 0);
  const Outcome compare =
      work.run("compare --json " + work.path("exact.h5") + " " + work.path("near.h5"));
  const json differences = json::parse(compare.out)["question_differences"];
  REQUIRE(differences.size() == 1);
  CHECK(differences[0]["what"] == "tolerance");
  CHECK(differences[0]["a"] == "none: exact");
  CHECK(differences[0]["b"] == "0.02 m, engine sweep");
  const json info = json::parse(work.run("info --json " + work.path("near.h5")).out);
  CHECK(info["tolerance"] == 0.02);
  CHECK(info["engine"] == "sweep");
  CHECK_FALSE(
      json::parse(work.run("info --json " + work.path("exact.h5")).out).contains("tolerance"));
}

TEST_CASE("a journal of another tolerance is refused") {
  const Work work;
  JournalRecord finished_cell;
  finished_cell.put(std::uint8_t{1});
  JournalWriter::create(journal_of(work.folder / "out.h5"),
                        {{"radius", "0.1"}, {"tolerance", "0.02"}, {"field_voxel", "0.3"}}, 5)
      .append(finished_cell);
  const auto resumed = [&](const std::string& options) {
    return work.run_hall(work.hall / "site.h5", "out.h5", "--device cpu --resume " + options);
  };
  check_refused(resumed(""), 2, "tolerance is 0.02, expected 0,");
  check_refused(resumed("--tolerance 0.03"), 2, "tolerance is 0.02, expected 0.03");
  check_refused(resumed("--tolerance 0.02"), 2, "field_voxel is 0.3, expected 0");
}

TEST_CASE("a tolerance that no engine or not this engine takes is wrong usage") {
  const Work work;
  const std::string site = work.hall / "site.h5";
  const std::pair<std::string, std::string> others[] = {
      {"--first-pose", "first poses"},
      {"--clearance 0.3", "clearances"},
      {"--between-poses", "motion between poses"}};
  for (const auto& [option, what] : others) {
    CAPTURE(option);
    check_refused(work.run_hall(site, "out.h5", "--tolerance 0.01 " + option), 2,
                  "a tolerance and " + what + " cannot be combined");
  }
  for (const char* engine : {"kdtree", "grid"}) {
    check_refused(work.run_hall(site, "out.h5", std::string("--tolerance 0.01 --engine ") + engine),
                  2, "take --engine sweep");
  }
  for (const char* value : {"0", "-0.01", "x", "nan", "inf", "1e999", "0.1", "0.2"}) {
    CAPTURE(value);
    check_refused(work.run_hall(site, "out.h5", std::string("--tolerance ") + value), 2,
                  "tolerance");
  }
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5.partial"));
  CHECK_FALSE(std::filesystem::exists(journal_of(work.folder / "out.h5")));
}
