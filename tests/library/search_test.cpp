// The calls of the library as a program that embeds it sees them.
#include <algorithm>
#include <map>

#include "library/api_scene.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

bool has_warning(const std::vector<Message>& warnings, const std::string& code) {
  return std::ranges::any_of(warnings, [&](const Message& warning) {
    return warning.severity == Message::Severity::kWarning && warning.code == code &&
           !warning.text.empty();
  });
}

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

/// Checks that the call, whose argument is its memory in bytes, runs with the amount that its
/// refusal names.
template <typename Call>
void check_memory_remedy(const Call& call) {
  double enough = 0;
  try {
    call(std::uint64_t{1} << 20);
  } catch (const Error& error) {
    CHECK(error.remedy() == Remedy::kMoreMemory);
    enough = error.amount();
  }
  REQUIRE(enough > 0);
  CHECK_NOTHROW(call(static_cast<std::uint64_t>(enough)));
}

/// Checks the updates of every stage of a call.
class ProgressCheck {
 public:
  ProgressCallback callback() {
    return [this](const ProgressUpdate& update) {
      Stage& stage = stages_[std::string(update.stage)];
      sound_ = sound_ && (update.total == 0 || update.done <= update.total) &&
               (update.finished || update.done >= stage.done || stage.finished);
      stage = {update.done, update.total, update.finished};
    };
  }
  void check(const std::vector<std::string>& names) const {
    CHECK(sound_);
    for (const std::string& name : names) {
      CAPTURE(name);
      REQUIRE(stages_.contains(name));
      const Stage& last = stages_.at(name);
      CHECK(last.finished);
      CHECK((last.total == 0 || last.done == last.total));
    }
  }

 private:
  struct Stage {
    std::uint64_t done = 0, total = 0;
    bool finished = false;
  };
  std::map<std::string, Stage> stages_;
  bool sound_ = true;
};

}  // namespace

TEST_CASE("a result's columns are those of its file") {
  ApiScene scene;
  scene.query.first_pose = true;
  scene.query.clearance = 0.3;
  const Store store(scene.folder / "wall.h5");
  CHECK(store.point_count() == 40'000);
  CHECK(store.box().hi.x == Approx(19.98));
  const auto output = scene.folder / "out.h5";
  const SearchReport report = search(store, scene.query, output, {.threads = 2});
  const Result result(output);
  const ResultReader reader(output);
  const Collisions rows = read_rows(reader);
  REQUIRE(result.size() > 0);
  CHECK(result.size() == report.colliding_points);
  CHECK(result.parameters() == QueryParameters(scene.query));
  CHECK(result.environment_points() == 40'000);
  CHECK(result.poses() == 200);
  CHECK(same_rows({result.source(), result.xyz(), result.first_pose()}, rows));
  const Clearances expected = read_rows<Clearances>(reader);
  const Clearances clearances = result.clearance();
  CHECK(clearances.source.size() == report.clearance_points);
  CHECK(clearances.source == expected.source);
  CHECK(clearances.xyz == expected.xyz);
  CHECK(clearances.distance == expected.distance);
  CHECK(clearances.pose == expected.pose);
}

TEST_CASE("columns that were not asked for are empty") {
  const ApiScene scene;
  search(Store(scene.folder / "wall.h5"), scene.query, scene.folder / "out.h5");
  const Result result(scene.folder / "out.h5");
  CHECK(result.first_pose().empty());
  CHECK(result.clearance().source.empty());
}

TEST_CASE("a search that is stopped goes on to the same bytes") {
  const ApiScene scene;
  const Store store(scene.folder / "wall.h5");
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    CAPTURE(name_of(engine));
    const auto whole = scene.folder / "whole.h5", output = scene.folder / "out.h5";
    SearchOptions options{.engine = engine, .device = Device::kCpu, .threads = 1};
    options.overwrite = true;
    search(store, scene.query, whole, options);
    std::atomic<bool> stop = false;
    options.stop = &stop;
    options.progress = [&](const ProgressUpdate& update) { stop = stop || update.done > 0; };
    CHECK_THROWS_AS(search(store, scene.query, output, options), Interrupted);
    options.overwrite = false;
    options.resume = true;
    stop = true;  // at once
    options.progress = nullptr;
    CHECK_THROWS_AS(search(store, scene.query, output, options), Interrupted);
    stop = false;
    const SearchReport report = search(store, scene.query, output, options);
    CHECK_FALSE(report.was_finished);
    CHECK((bytes_of(output) == bytes_of(whole)));
    CHECK(search(store, scene.query, output, options).was_finished);
    std::filesystem::remove(output);
  }
}

TEST_CASE("a profile has the same bytes whatever the threads, the memory and the stops") {
  ApiScene scene;
  scene.query.profile = 0.2;
  const auto convert_to = [&](const std::string& name, std::uint32_t cell_points) {
    convert({scene.folder / "wall.las"}, scene.folder / name, {.cell_points = cell_points});
    return Store(scene.folder / name);
  };
  const Store store(scene.folder / "wall.h5"), other = convert_to("other.h5", 700);
  const auto whole = scene.folder / "whole.h5", output = scene.folder / "out.h5";
  const SearchReport report = search(store, scene.query, whole, {.threads = 1});
  CHECK(report.profile_poses == 200);
  const auto check_same = [&] {
    CHECK((bytes_of(output) == bytes_of(whole)));
    const SearchReport again =
        search(store, scene.query, output, {.device = Device::kCpu, .resume = true});
    CHECK(again.was_finished);
    CHECK(again.profile_poses == 200);
    std::filesystem::remove(output);
  };
  search(store, scene.query, output, {.threads = 3, .memory_bytes = 40 << 20});
  check_same();
  search(other, scene.query, output, {.threads = 2});
  check_same();
  std::atomic<bool> stop = false;
  SearchOptions options{.device = Device::kCpu, .threads = 1, .stop = &stop};
  options.progress = [&](const ProgressUpdate& update) { stop = stop || update.done > 9000; };
  CHECK_THROWS_AS(search(store, scene.query, output, options), Interrupted);
  stop = false;
  CHECK(search(store, scene.query, output, {.threads = 2, .resume = true}).resumed_cells > 0);
  check_same();
}

TEST_CASE("progress never passes its total and ends finished") {
  const ApiScene scene;
  ProgressCheck conversion, run;
  convert({scene.folder / "wall.las"}, scene.folder / "again.h5",
          {.cell_points = 64, .progress = conversion.callback()});
  conversion.check({"count", "distribute", "partition"});
  const Store store(scene.folder / "again.h5");
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    search(store, scene.query, scene.folder / "out.h5",
           {.engine = engine, .threads = 2, .overwrite = true, .progress = run.callback()});
    run.check({"search", "write"});
  }
}

TEST_CASE("warnings are values") {
  ApiScene scene;
  put_bytes(scene.folder / "mesh.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  std::vector<Message> warnings;
  CHECK_THROWS_AS(read_model_points(scene.folder / "mesh.ply"), InputError);
  CHECK(read_model_points(scene.folder / "mesh.ply", {.spacing = 1}, &warnings).size() == 3);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].severity == Message::Severity::kNote);
  CHECK_THAT(warnings[0].text, Contains("1 triangle,"));
  std::vector<Message> told;
  const ConvertReport converted =
      convert({scene.folder / "mesh.ply"}, scene.folder / "mesh.h5",
              {.message = [&](const Message& message) { told.push_back(message); }});
  CHECK(has_warning(converted.warnings, "mesh-faces"));
  CHECK(has_warning(told, "mesh-faces"));
  scene.query.poses.clear();
  const Store store(scene.folder / "wall.h5");
  const SearchReport report = search(store, scene.query, scene.folder / "out.h5");
  CHECK(has_warning(report.warnings, "no-poses"));
  CHECK(report.colliding_points == 0);
}

TEST_CASE("check_search refuses what search refuses") {
  ApiScene scene;
  const Store store(scene.folder / "wall.h5");
  const auto output = scene.folder / "out.h5";
  const auto check = [&](const QueryParameters& parameters, const SearchOptions& options) {
    const std::string early = usage_error_of([&] { check_search(parameters, output, options); });
    CHECK_FALSE(early.empty());
    CHECK_THAT(early, !Contains("--"));
    CHECK(early == usage_error_of([&] {
            search(store, {scene.query.model, scene.query.poses, parameters}, output, options);
          }));
  };
  check({.radius = 0}, {});
  check({.radius = 0.1, .between_poses = true, .clearance = 0.5}, {});
  check({.radius = 0.1, .clearance = 0.5}, {.engine = Engine::kKdtree});
  check({.radius = 0.1, .between_poses = true}, {.engine = Engine::kGrid});
  check({.radius = 0.1}, {.device = Device::kCpu, .gpus = {0}});
  check({.radius = 0.1}, {.gpus = {0, 0}});
  check({.radius = 0.1}, {.threads = -1});
  check({.radius = 0.1}, {.overwrite = true, .resume = true});
  CHECK_NOTHROW(check_search(scene.query, output));
  search(store, scene.query, output);
  // Only the search knows which question the file answers.
  CHECK_NOTHROW(check_search(scene.query, output));
  CHECK_THAT(usage_error_of([&] { search(store, scene.query, output); }),
             Contains("exists already, and answers the same question"));
  put_bytes(output, "no result");
  check(scene.query, {});
  CHECK_NOTHROW(check_search(scene.query, output, {.overwrite = true}));
}

TEST_CASE("too little memory is refused with an amount that is enough") {
  const ApiScene scene;
  const Store store(scene.folder / "wall.h5");
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    CAPTURE(name_of(engine));
    check_memory_remedy([&](std::uint64_t bytes) {
      search(store, scene.query, scene.folder / "out.h5",
             {.engine = engine,
              .device = Device::kCpu,
              .threads = 2,
              .memory_bytes = bytes,
              .overwrite = true});
    });
  }
  check_memory_remedy([&](std::uint64_t bytes) {
    convert({scene.folder / "wall.las"}, scene.folder / "again.h5",
            {.memory_bytes = bytes, .threads = 2});
  });
}
