// `clearway-bench search`: engines that are set as no `clearway run` sets them.
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "io/result/result.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
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

struct Searches : Work {
  Outcome search(const std::string& options, const std::string& store = "") const {
    return run_program_at(CLEARWAY_BENCH_PROGRAM, folder,
                          "search --env " + (store.empty() ? hall / "site.h5" : store) +
                              " --model " + hall / "model.ply" + " --trajectory " +
                              hall / "trajectory.txt" + " --radius 0.1 -o " + path("out.h5") + " " +
                              options);
  }
  std::vector<std::uint64_t> found(const std::string& options,
                                   const std::string& store = "") const {
    const Outcome done = search(options, store);
    CAPTURE(options, done.err);
    require_success(done);
    return read_rows(ResultReader(folder / "out.h5")).source;
  }
};

}  // namespace

TEST_CASE("within a tolerance only points near the radius differ, whatever threads and cells") {
  const Searches work;
  const std::vector<double> distances = distances_in(work.hall);
  require_success(work.run("convert " + work.hall / "environment.las" + " --cell-points 500 -o " +
                           work.path("other.h5")));
  for (const double tolerance : {1e-6, 0.01, 0.06}) {
    const std::string options = "--tolerance " + std::to_string(tolerance);
    const json report = json_of(require_success(work.search(options)));
    check_json(report, R"({"model_points": 300, "poses": 150})");
    CHECK(report["model_points_searched"] <= 300);
    CHECK(report["poses_searched"] <= 150);
    const std::vector<std::uint64_t> sources = work.found(options + " --threads 1");
    std::vector<bool> found(distances.size());
    for (const std::uint64_t source : sources) found[source] = true;
    double farthest = 0;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (found[i] == (distances[i] < 0.1)) continue;
      farthest = std::max(farthest, std::abs(distances[i] - 0.1));
    }
    CHECK(farthest <= tolerance);
    CHECK((work.found(options + " --threads 3 --memory 1G") == sources));
    CHECK((work.found(options, work.path("other.h5")) == sources));
  }
}

TEST_CASE("neither the field's voxel nor the grid's cell changes what is found") {
  const Searches work;
  require_success(work.run_hall(work.hall / "site.h5", "out.h5"));
  const auto expected = read_rows(ResultReader(work.folder / "out.h5")).source;
  for (const char* options :
       {"--field-voxel 0.02", "--field-voxel 0.5", "--field-voxel 1e9", "--engine grid",
        "--engine grid --grid-cell 0.2", "--engine grid --grid-cell 3"}) {
    CHECK((work.found(options) == expected));
  }
  check_json(json_of(work.search("--engine grid --grid-cell 0.2")), R"({"grid_cell": 0.2})");
  check_outcome(work.search("--engine grid --precision float"), 0);
}

TEST_CASE("settings that the engine does not have are refused") {
  const Searches work;
  for (const char* options :
       {"--tolerance 0.1", "--tolerance 0", "--tolerance nan", "--engine grid --tolerance 0.01",
        "--engine grid --field-voxel 0.1", "--grid-cell 0.1", "--precision float",
        "--engine grid --precision double", "--engine kdtree"}) {
    CAPTURE(options);
    check_outcome(work.search(options), 2);
  }
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
}
