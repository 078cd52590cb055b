// `clearway-bench search`: engines that are set as no `clearway run` sets them.
#include <nlohmann/json.hpp>

#include "io/result/result.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A hall and searches of it, whose result is out.h5.
struct Searches : Workplace {
  Searches() {
    succeed("scene hall --points 30000 --model-points 300 --poses 150 -o .");
    succeed("convert environment.las -o site.h5");
  }
  Outcome search(const std::string& options) const {
    return run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "search" + asked + options);
  }
  std::vector<std::uint64_t> found(const std::string& options) const {
    const Outcome done = search(options);
    CAPTURE(options, done.err);
    require_success(done);
    return read_rows(ResultReader(folder / "out.h5")).source;
  }

  const std::string asked =
      " --env site.h5 --model model.ply --trajectory trajectory.txt --radius 0.1 -o out.h5 ";
};

}  // namespace

TEST_CASE("neither the field's voxel nor the grid's cell changes what is found") {
  const Searches work;
  work.succeed("run" + work.asked);
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
       {"--field-voxel 0", "--field-voxel nan", "--engine grid --field-voxel 0.1",
        "--grid-cell 0.1", "--precision float", "--engine grid --precision double",
        "--engine kdtree"}) {
    CAPTURE(options);
    check_outcome(work.search(options), 2);
  }
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
}
