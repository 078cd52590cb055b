// A run that asks for everything, stopped in every pass and resumed.
#include <map>

#include "clearway/error.hpp"
#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The query of the first body alone, with everything that may be asked together.
Query everything(const Vehicle& vehicle) {
  Query query(vehicle.query.bodies[0].model, vehicle.query.poses,
              {.radius = 0.06, .first_pose = true, .clearance = 0.1, .profile = 0.2});
  query.floor = 0.03;
  query.depth = true;
  query.error_scan = query.error_pose = 0.001;
  query.ignore_boxes = {{{100, -200, 0}, {102.9, -197, 1}}};
  return query;
}

}  // namespace

TEST_CASE("a run with all questions, stopped again and again, has the bytes of one that was not") {
  const Vehicle vehicle(17, false, 600);
  const Query query = everything(vehicle);
  const Store store(vehicle.folder / "scan.h5");
  const SearchReport whole = search(store, query, vehicle.folder / "whole.h5", {.threads = 1});
  CHECK(whole.colliding_points > 20);
  CHECK(whole.floor_colliding.value() > 5);
  CHECK(whole.ignored_colliding > 5);

  const std::filesystem::path parts = vehicle.folder / "parts.h5";
  std::map<std::string, int> stops;  // in each stage
  std::map<std::string, std::uint64_t> searched;
  std::optional<SearchReport> last;
  int runs = 0;
  while (!last) {
    std::atomic<bool> stop = false;
    int pages = 0;
    std::string stage;
    std::uint64_t before = 0;
    SearchOptions options{.threads = 1, .resume = runs > 0};
    options.stop = &stop;
    options.progress = [&](const ProgressUpdate& now) {
      if (stage != now.stage) before = 0;
      stage = now.stage;
      searched[stage] += now.done - before;
      before = now.done;
      if (now.done > 0 && !now.finished && stage != "group" && stage != "write" && ++pages == 4)
        stop = true;
    };
    try {
      last = search(store, query, parts, options);
    } catch (const Interrupted&) {
      ++stops[stage];
    }
    REQUIRE(++runs < 500);
  }
  for (const char* stage : {"search", "ignored", "last poses", "certain points", "near points",
                            "below the floor", "depth"}) {
    CAPTURE(stage);
    CHECK(stops[stage] > 0);
  }
  CHECK(searched["depth"] == whole.colliding_points);  // nothing was done twice
  CHECK(last->colliding_points == whole.colliding_points);
  CHECK(last->floor_colliding == whole.floor_colliding);
  CHECK(last->ignored_colliding == whole.ignored_colliding);
  CHECK(last->ignored_colliding_high == whole.ignored_colliding_high);
  check_same(bytes_of(parts), bytes_of(vehicle.folder / "whole.h5"));
}
