// The memory and devices that a run may use, and how it reports them.
#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A small hall in cells of 1,000 points.
class SmallHall {
 public:
  SmallHall() {
    const std::string folder = quoted(folder_ / "");
    if (run("scene hall --points 40000 --model-points 2000 --poses 400 -o " + folder).exit_code !=
            0 ||
        run("convert " + path("environment.las") + " --cell-points 1000 -o " + path("site.h5"))
                .exit_code != 0) {
      throw std::runtime_error("no hall");
    }
  }
  Outcome run(const std::string& arguments) const { return run_program(folder_, arguments); }
  Outcome search(const std::string& options, const std::string& output = "out.h5") const {
    return run("run --env " + path("site.h5") + " --model " + path("model.ply") + " --trajectory " +
               path("trajectory.txt") + " --radius 0.1 --force -o " + path(output) + " " + options);
  }
  std::string path(const std::string& name) const { return quoted(folder_ / name); }
  std::string bytes(const std::string& name) const { return bytes_of(folder_ / name); }

 private:
  ScratchFolder folder_;
};

/// The smallest budget that a refusal names.
std::uint64_t smallest_budget(const std::string& refusal) {
  const std::string before = "; --memory ";
  const auto at = refusal.find(before);
  REQUIRE(at != std::string::npos);
  return std::stoull(refusal.substr(at + before.size()));
}

}  // namespace

TEST_CASE("the smallest memory that a refusal names works, and a byte less is refused") {
  const SmallHall hall;
  for (const std::string options :
       {"", "--first-pose", "--clearance 0.3 --first-pose", "--between-poses", "--threads 9",
        "--threads 1", "--engine kdtree --threads 4", "--engine grid --threads 3"}) {
    CAPTURE(options);
    require_success(hall.search(options, "expected.h5"));
    const Outcome refused = hall.search(options + " --memory 1K");
    check_refused(refused, 4, "too little");
    const std::uint64_t smallest = smallest_budget(refused.err);
    CHECK(smallest < (std::uint64_t{100} << 20));
    check_refused(hall.search(options + " --memory " + std::to_string(smallest - 1)), 4,
                  std::to_string(smallest));
    const Outcome least =
        require_success(hall.search(options + " --json --memory " + std::to_string(smallest)));
#ifndef CLEARWAY_SANITIZED  // sanitizers take memory of their own
    CHECK(json_of(least)["peak_host_bytes"] <= smallest);
#endif
    CHECK(json_of(least)["needed_host_bytes"] <= smallest);
    check_same(hall.bytes("out.h5"), hall.bytes("expected.h5"));
  }
}

TEST_CASE("run --json tells of pages and stages") {
  const SmallHall hall;
  const json report = json_of(require_success(hall.search("--json --threads 3 --engine sweep")));
  check_json(report, R"({"device": "cpu", "slots": 5})");
  CHECK(report["pages"] == report["cells_read"]);
  CHECK(report["cells_read"] <= report["cells_total"]);
  CHECK(report["page_bytes"].get<std::uint64_t>() > 1000);
  const json& seconds = report["seconds"];
  for (const char* stage : {"read", "compute"}) {
    CAPTURE(stage);
    CHECK(seconds[stage] > 0);
    CHECK(seconds[stage] <= seconds["search"]);
  }
  check_json(seconds, R"({"upload": 0})");
  CHECK(seconds["search"] < seconds["total"]);
  CHECK(seconds["inputs"] > 0);
}

TEST_CASE("CUDA where there is none exits with 4 and says what to do") {
  const SmallHall hall;
  for (const char* options : {"--device cuda", "--gpus 900,901", "--device cuda --gpus 1000"}) {
    CAPTURE(options);
    const Outcome outcome = hall.search(options);
    if (outcome.exit_code == 0) continue;  // the machine has a GPU
    const bool has_gpus = outcome.err.find("that CUDA can use") != std::string::npos;
    check_refused(outcome, 4, has_gpus ? "error: GPU " : "--device cpu");
  }
  check_outcome(hall.search("--device auto"), 0);
  check_outcome(hall.search("--device cpu"), 0);
}

TEST_CASE("options of devices and engines that do not fit are refused") {
  const SmallHall hall;
  check_cases([&](const std::string& more) { return hall.search(more); },
              {
                  {"--gpus 0,x", 2, "--gpus"},
                  {"--gpus -1", 2, "--gpus"},
                  {"--gpus 1,0,1", 2, "a GPU is named twice"},
                  {"--device gpu", 2, "--device"},
                  {"--device-memory 2X", 2, "--device-memory"},
                  {"--device cpu --gpus 0", 2, "--device cuda"},
                  {"--device cpu --device-memory 2G", 2, "--device cuda"},
                  {"--engine kdtree --device cuda", 2, "--engine sweep"},
              });
}
