// Random questions, whose answers are those of brute force however they are asked, and a search
// that is stopped in every pass.
#include "support/questions.hpp"

#include <map>

#include "search/devices.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Counts of what was found in all questions together, so that no kind of answer is missing.
using Tally = std::map<std::string, std::int64_t>;

void add(const Truth& truth, Tally& tally) {
  const Collisions& rows = truth.collisions;
  for (std::size_t i = 0; i < rows.last_pose.size(); ++i) {
    tally["points touched again"] += rows.last_pose[i] > rows.first_pose[i];
  }
  for (const double distance : truth.profile.distance) {
    tally["poses far from all points"] += std::isinf(distance);
    tally["poses without a body"] += std::isnan(distance);
  }
  const Answer& answer = truth.answer;
  tally["by the second body"] += std::ranges::count(rows.body, 1U);
  tally["deep"] += std::ranges::count_if(rows.depth, [](double depth) { return depth > 0.05; });
  tally["certain"] += static_cast<std::int64_t>(answer.certain.points);
  tally["near"] += static_cast<std::int64_t>(answer.near_points);
  tally["inside"] += static_cast<std::int64_t>(answer.inside_points);
  tally["below a floor"] += static_cast<std::int64_t>(answer.floor_colliding.value_or(0));
  tally["ignored"] += static_cast<std::int64_t>(answer.ignored_colliding);
  tally["ignored and high"] += static_cast<std::int64_t>(answer.ignored_colliding_high);
}

}  // namespace

TEST_CASE(
    "random questions have the answer of brute force, and its bytes, however they are asked") {
  Tally tally;
  int empty = 0, pieces = 0;
  for (const bool plain : {false, true}) {
    const AskedScan scan(41, plain);
    const Session session(scan.store, {.device = Device::kCpu, .threads = 2});
    const auto other_cells = scan.converted("other.h5", {.cell_points = plain ? 700U : 4096U});
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      CAPTURE(plain, seed);
      Random random(seed);
      const auto [query, engine] = scan.question(random);
      const int threads = 1 + static_cast<int>(below(random, 3));
      SearchOptions options{.engine = engine, .device = Device::kCpu, .threads = threads};
      options.overwrite = true;
      const auto output = scan.folder / "out.h5";
      const SearchReport report = search(Store(scan.store), query, output, options);
      const std::string bytes = bytes_of(output);
      const Truth truth = scan.truth(query, report.budget);
      check(truth, Result(output));
      check_answer(truth, report);
      add(truth, tally);
      empty += truth.collisions.size() == 0;

      // In a session
      const SessionAnswer answer = session.search(query, {.engine = engine});
      check(truth, answer);
      CHECK(answer.verdict() == report.verdict());
      answer.save(output, true);
      check_same(bytes_of(output), bytes);

      // In cells of another size
      search(Store(other_cells), query, output, options);
      check_same(bytes_of(output), bytes);

      // On a GPU, where there is one
      if (engine != Engine::kKdtree && may_take_gpus({})) {
        options.device = Device::kCuda;
        search(Store(scan.store), query, output, options);
        check_same(bytes_of(output), bytes);
        options.device = Device::kCpu;
      }

      // Stopped again and again, and resumed; then asked once more
      SearchReport resumed;
      check_same(
          searched_in_pieces(scan, query, random, {.engine = engine, .threads = threads}, resumed),
          bytes);
      check_answer(truth, resumed);
      options.overwrite = false;
      options.resume = true;
      const SearchReport finished =
          search(Store(scan.store), query, scan.folder / "pieces.h5", options);
      CHECK(finished.was_finished);
      check_answer(truth, finished);
      pieces += resumed.resumed_cells > 0;

      // In parts that are merged
      if (query.depth) continue;  // only the whole search knows which points are free
      const std::uint32_t counts[] = {1, 2, 3, 7};
      MergeReport merged;
      check_same(searched_in_parts(scan, query, counts[below(random, 4)],
                                   {.engine = engine, .threads = threads}, merged),
                 bytes);
      check_answer(truth, merged);
      CHECK(merged.verdict() == report.verdict());
    }
  }
  for (const auto& [what, count] : tally) {
    INFO(what);
    CHECK(count > 15);
  }
  CHECK(empty > 5);
  CHECK(pieces > 50);
}

TEST_CASE("a run with all questions, stopped again and again, has the bytes of one that was not") {
  const AskedScan scan(17, true);
  const Query vehicle = scan.vehicle(39, 600);
  Query query(vehicle.bodies[0].model, vehicle.poses,
              {.radius = 0.06, .first_pose = true, .clearance = 0.1, .profile = 0.2});
  query.floor = 0.03;
  query.depth = true;
  query.error_scan = query.error_pose = 0.001;
  query.ignore_boxes = {{{100, -200, 0}, {102, -197, 1}}};
  const Store store(scan.store);
  const SearchReport whole = search(store, query, scan.folder / "whole.h5", {.threads = 1});
  CHECK(whole.colliding_points > 20);
  CHECK(whole.floor_colliding.value() > 5);
  CHECK(whole.ignored_colliding > 5);
  std::uint64_t least = 0;
  try {
    search(store, query, scan.folder / "none.h5",
           {.device = Device::kCpu, .threads = 1, .memory_bytes = 1});
  } catch (const ResourceError& error) {
    least = static_cast<std::uint64_t>(error.amount());
  }
  // In the least memory the questions are asked one after another, and otherwise in one visit.
  // Where one cell ends by a stop, those that other threads search end unfinished, and are searched
  // again.
  const std::vector<std::string> one_visit{"search", "depth"};
  const std::vector<std::string> visits{"search", "ignored", "near", "below",
                                        "last",   "certain", "depth"};
  const std::uint64_t enough = SearchOptions().memory_bytes;
  struct Row {
    int threads;
    std::uint64_t memory_bytes;
    std::vector<std::string> stages;
  };
  for (const auto& [threads, memory_bytes, stages] :
       {Row{1, enough, one_visit}, Row{4, enough, one_visit}, Row{1, least, visits}}) {
    CAPTURE(threads, memory_bytes);
    const auto output =
        scan.folder / (std::to_string(threads) + std::to_string(memory_bytes) + ".h5");
    std::map<std::string, int> stops;  // in each stage
    std::map<std::string, std::uint64_t> searched;
    std::optional<SearchReport> last;
    int runs = 0;
    while (!last) {
      std::atomic<bool> stop = false;
      int pages = 0;
      std::string stage;
      std::uint64_t before = 0;
      SearchOptions options{.device = Device::kCpu,
                            .threads = threads,
                            .memory_bytes = memory_bytes,
                            .resume = runs > 0};
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
        last = search(store, query, output, options);
      } catch (const Interrupted&) {
        ++stops[stage];
        CHECK_FALSE(std::filesystem::exists(output));
      }
      REQUIRE(++runs < 500);
    }
    for (const std::string& stage : stages) {
      CAPTURE(stage);
      CHECK(stops[stage] > 0);
    }
    if (threads == 1) CHECK(searched["depth"] == whole.colliding_points);  // nothing was done twice
    CHECK(last->colliding_points == whole.colliding_points);
    CHECK(last->floor_colliding == whole.floor_colliding);
    CHECK(last->ignored_colliding == whole.ignored_colliding);
    CHECK(last->ignored_colliding_high == whole.ignored_colliding_high);
    check_same(bytes_of(output), bytes_of(scan.folder / "whole.h5"));
  }
}

TEST_CASE("a search that was stopped goes on only for its own question, and ends at once") {
  const AskedScan scan(41, true);
  Query query = scan.vehicle(80);
  const auto output = scan.folder / "out.h5";
  std::atomic<bool> stop = false;
  SearchOptions options{.threads = 1, .journal_interval_seconds = 0};
  options.progress = [&stop](const ProgressUpdate& update) {
    if (update.stage == "search" && update.done > update.total / 3) stop = true;
  };
  options.stop = &stop;
  const auto run = [&] { return search(Store(scan.store), query, output, options); };
  CHECK_THROWS_AS(run(), Interrupted);
  options.progress = nullptr;
  options.resume = true;
  CHECK_THROWS_AS(run(), Interrupted);
  stop = false;
  query.depth = true;
  check_refused<UsageError>(run, "depth");
  query.depth = false;
  query.bodies[1].name = "another";
  CHECK_THROWS_AS(run(), UsageError);
  query.bodies[1].name = "middle";
  const SearchReport report = run();
  CHECK(report.resumed_cells > 0);
  CHECK_FALSE(report.was_finished);
  const SearchReport again = run();
  CHECK(again.was_finished);
  CHECK(again.colliding_points == report.colliding_points);
}
