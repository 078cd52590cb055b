// The calls of the library as a program that embeds it sees them.
#include <functional>
#include <map>

#include "library/api_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The message with which the call is refused; empty where it is not.
template <typename Call>
std::string usage_error_of(const Call& call) {
  try {
    call();
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

/// Checks the updates of every stage of a call, which has these stages among others.
template <typename Call>
void check_progress(const std::vector<std::string>& names, const Call& call) {
  struct Stage {
    std::uint64_t done = 0, total = 0;
    bool finished = false;
  };
  std::map<std::string, Stage> stages;
  bool sound = true;
  call([&](const ProgressUpdate& update) {
    Stage& stage = stages[std::string(update.stage)];
    sound = sound && (update.total == 0 || update.done <= update.total) &&
            (update.finished || update.done >= stage.done || stage.finished);
    stage = {update.done, update.total, update.finished};
  });
  CHECK(sound);
  for (const std::string& name : names) {
    const Stage& last = stages[name];
    CAPTURE(name, last.done, last.total);
    CHECK(last.finished);
    CHECK((last.total == 0 || last.done == last.total));
  }
}

}  // namespace

TEST_CASE("a result has the columns and the question of its search, and none that were not asked") {
  const ApiScene scene;
  const Store store(scene.folder / "wall.h5");
  CHECK(store.point_count() == 40'000);
  CHECK(store.box().hi.x == Approx(19.98));
  search(store, scene.query, scene.folder / "out.h5");
  const Result result(scene.folder / "out.h5");
  CHECK(result.size() > 0);
  CHECK(result.parameters() == QueryParameters(scene.query));
  CHECK(result.environment_points() == 40'000);
  CHECK(result.poses() == 200);
  CHECK(result.model_box() == Box{{0, 0, 0}, {0, 0.02, 0.3}});
  CHECK(result.xyz() == result.collisions().xyz);
  CHECK(result.source() == result.collisions().source);
  CHECK(result.first_pose().empty());
  CHECK(result.last_pose().empty());
  CHECK(result.first_body().empty());
  CHECK(result.clearance().source.empty());
  CHECK(result.collisions().depth.empty());
  CHECK_FALSE(result.answer().deepest);
}

TEST_CASE("progress never passes its total and ends finished") {
  const ApiScene scene;
  const auto again = scene.folder / "again.h5", output = scene.folder / "out.h5";
  check_progress({"count", "distribute", "partition"}, [&](const ProgressCallback& progress) {
    convert({scene.folder / "wall.las"}, again, {.cell_points = 64, .progress = progress});
  });
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    check_progress({"search", "write"}, [&](const ProgressCallback& progress) {
      search(Store(again), scene.query, output,
             {.engine = engine, .threads = 2, .overwrite = true, .progress = progress});
    });
  }
}

TEST_CASE("warnings are values") {
  ApiScene scene;
  const auto mesh = scene.folder.write(
      "mesh.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  std::vector<Message> warnings;
  CHECK_THROWS_AS(read_model_points(mesh), InputError);
  CHECK(read_model_points(mesh, {.spacing = 1}, &warnings).size() == 3);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].severity == Message::Severity::kNote);
  check_says(warnings[0].text, "1 triangle,");
  std::vector<Message> told;
  const ConvertReport converted =
      convert({mesh}, scene.folder / "mesh.h5",
              {.message = [&](const Message& message) { told.push_back(message); }});
  check_says(codes_of(converted.warnings), "mesh-faces");
  check_says(codes_of(told), "mesh-faces");
  scene.query.poses.clear();
  const Store store(scene.folder / "wall.h5");
  const SearchReport report = search(store, scene.query, scene.folder / "out.h5");
  check_says(codes_of(report.warnings), "no-poses");
  CHECK(report.colliding_points == 0);
}

TEST_CASE("check_search refuses what search refuses") {
  const ApiScene scene;
  const Store store(scene.folder / "wall.h5");
  const auto output = scene.folder / "out.h5";
  const auto check_both = [&](const QueryParameters& parameters, const SearchOptions& options) {
    const std::string early = usage_error_of([&] { check_search(parameters, output, options); });
    CHECK_FALSE(early.empty());
    check_lacks(early, "--");
    CHECK(early == usage_error_of([&] {
            search(store, {scene.query.model, scene.query.poses, parameters}, output, options);
          }));
  };
  check_both({.radius = 0}, {});
  check_both({.radius = 0.1, .between_poses = true, .clearance = 0.5}, {});
  check_both({.radius = 0.1, .clearance = 0.5}, {.engine = Engine::kKdtree});
  check_both({.radius = 0.1, .between_poses = true}, {.engine = Engine::kGrid});
  check_both({.radius = 0.1}, {.device = Device::kCpu, .gpus = {0}});
  check_both({.radius = 0.1}, {.gpus = {0, 0}});
  check_both({.radius = 0.1}, {.threads = -1});
  check_both({.radius = 0.1}, {.overwrite = true, .resume = true});
  CHECK_NOTHROW(check_search(scene.query, output));
  search(store, scene.query, output);
  // Only the search knows which question the file answers.
  CHECK_NOTHROW(check_search(scene.query, output));
  check_says(usage_error_of([&] { search(store, scene.query, output); }),
             "exists already, and answers the same question");
  put_bytes(output, "no result");
  check_both(scene.query, {});
  CHECK_NOTHROW(check_search(scene.query, output, {.overwrite = true}));
}

TEST_CASE("too little memory is refused with an amount that is enough for the same answer") {
  ApiScene scene;
  const auto out = scene.folder / "out.h5";
  // `run` takes its memory in bytes, and returns the bytes of what it wrote.
  const auto check_remedy = [&](const std::string& what,
                                const std::function<std::string(std::uint64_t)>& run,
                                int most_refusals = 1) {
    const RowName name(what);
    std::uint64_t enough = 1 << 20;
    for (int refusals = 0;; ++refusals) {
      try {
        const std::string found = run(enough);
        CHECK((refusals > 0 && refusals <= most_refusals));
        return check_same(found, run(std::uint64_t{4} << 30));
      } catch (const Error& error) {
        REQUIRE(error.remedy() == Remedy::kMoreMemory);
        REQUIRE(error.amount() > static_cast<double>(enough));
        enough = static_cast<std::uint64_t>(error.amount());
        REQUIRE(enough < (std::uint64_t{256} << 20));
      }
    }
  };
  const auto check_search_remedy = [&](const std::string& what, const std::filesystem::path& store,
                                       const Query& query, Engine engine, int refusals = 1) {
    const auto run = [&](std::uint64_t bytes) {
      search(Store(store), query, out,
             {.engine = engine,
              .device = Device::kCpu,
              .threads = 2,
              .memory_bytes = bytes,
              .overwrite = true});
      return bytes_of(out);
    };
    check_remedy(what, run, refusals);
  };
  const auto wall = scene.folder / "wall.h5";
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    check_search_remedy(name_of(engine), wall, scene.query, engine);
  }
  check_remedy("conversion", [&](std::uint64_t bytes) {
    convert({scene.folder / "wall.las"}, out,
            {.memory_bytes = bytes, .threads = 2, .overwrite = true});
    return bytes_of(out);
  });
  scene.query.first_pose = true;
  scene.query.clearance = scene.query.profile = 0.3;
  std::vector<std::filesystem::path> parts;
  for (std::uint32_t number = 1; number <= 7; ++number) {
    parts.push_back(scene.folder / ("part" + std::to_string(number) + ".h5"));
    search(Store(wall), scene.query, parts.back(), {.threads = 2, .shard = Shard{number, 7}});
  }
  check_remedy("merge", [&](std::uint64_t bytes) {
    merge(parts, out, {.memory_bytes = bytes, .overwrite = true});
    return bytes_of(out);
  });
  const AskedScan scan(41, true);
  Query vehicle = scan.vehicle(82);
  vehicle.first_pose = true;
  vehicle.clearance = vehicle.profile = 0.1;
  check_search_remedy("vehicle", scan.store, vehicle, Engine::kSweep);
  scene.query.clearance = scene.query.profile = 0;
  scene.query.depth = true;
  scene.query.floor = -0.1;
  check_search_remedy("depths", wall, scene.query, Engine::kSweep, 8);
}
