// Parts that shards search, and the result that they make.
#include <algorithm>
#include <atomic>
#include <functional>

#include "library/shards.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Mode {
  const char* name;
  std::vector<Engine> engines;
  std::function<void(Query&)> ask;
};

const std::vector<Mode>& modes() {
  static const std::vector<Engine> kAll{Engine::kSweep, Engine::kGrid, Engine::kKdtree};
  static const std::vector<Mode> kModes{
      {"set", kAll, [](Query&) {}},
      {"first poses", {Engine::kSweep}, [](Query& query) { query.first_pose = true; }},
      {"between poses",
       {Engine::kSweep},
       [](Query& query) { query.between_poses = query.first_pose = true; }},
      {"clearances", {Engine::kSweep}, [](Query& query) { query.clearance = 0.2; }},
      {"profile", {Engine::kSweep}, [](Query& query) { query.profile = 0.3; }},
      {"all tables",
       {Engine::kSweep},
       [](Query& query) {
         query.first_pose = true;
         query.clearance = query.profile = 0.3;
       }},
      {"nothing found", kAll, [](Query& query) { query.radius = 1e-4; }}};
  return kModes;
}

/// The numbers of shards to try; many for the mode in which a part holds every table.
std::vector<std::uint32_t> counts(const Mode& mode, Engine engine) {
  if (mode.name == std::string("all tables")) return {1, 2, 7, 64};
  return engine == Engine::kSweep ? std::vector<std::uint32_t>{2, 7}
                                  : std::vector<std::uint32_t>{3};
}

}  // namespace

TEST_CASE("merged parts have the bytes of the search of everything") {
  for (const Mode& mode : modes()) {
    for (const Engine engine : mode.engines) {
      Shards shards({.engine = engine});
      mode.ask(shards.scene.query);
      const std::string whole = shards.whole();
      for (const std::uint32_t count : counts(mode, engine)) {
        CAPTURE(mode.name, name_of(engine), count);
        auto parts = shards.parts(count);
        std::ranges::reverse(parts);
        CHECK(shards.merged(parts) == whole);
      }
    }
  }
}

TEST_CASE("parts of different engines make one result") {
  Shards shards({.engine = Engine::kSweep}), others({.engine = Engine::kKdtree});
  auto parts = shards.parts(3);
  parts[1] = others.parts(3)[1];
  CHECK(shards.merged(parts) == shards.whole());
}

TEST_CASE("a merge reports what a search does") {
  Shards shards;
  Query& query = shards.scene.query;
  query.first_pose = true;
  query.clearance = query.profile = 0.3;
  shards.merged(shards.parts(5));
  const SearchReport whole = search(Store(shards.scene.folder / "wall.h5"), query,
                                    shards.scene.folder / "again.h5", {.threads = 2});
  const MergeReport& report = shards.report;
  CHECK(report.parts == 5);
  CHECK(report.parameters == query);
  CHECK(report.environment_points == whole.environment_points);
  CHECK(report.colliding_points == whole.colliding_points);
  CHECK(report.clearance_points == whole.clearance_points);
  CHECK(report.profile_poses == whole.profile_poses);
  CHECK(report.profile_poses < query.poses.size());
  CHECK(report.first_place == whole.first_place);
  CHECK(report.least_clearance == whole.least_clearance);
  CHECK(report.least_profile == whole.least_profile);
}

TEST_CASE("a merge with little memory has the same bytes and with less it is refused") {
  Shards shards;
  shards.scene.query.clearance = shards.scene.query.profile = 0.3;
  const auto parts = shards.parts(7);
  double enough = 0;
  try {
    shards.merged(parts, {.memory_bytes = 1 << 20, .overwrite = true});
  } catch (const ResourceError& error) {
    CHECK(error.remedy() == Remedy::kMoreMemory);
    enough = error.amount();
  }
  REQUIRE(enough > 0);
  CHECK(shards.merged(parts, {.memory_bytes = static_cast<std::uint64_t>(enough),
                              .overwrite = true}) == shards.whole());
}

TEST_CASE("parts that are missing or there twice are refused by number") {
  Shards shards;
  const auto parts = shards.parts(7);
  const auto some = [&](const std::vector<std::size_t>& which) {
    std::vector<std::filesystem::path> out;
    out.reserve(which.size());
    for (const std::size_t i : which) out.push_back(parts[i - 1]);
    return out;
  };
  CHECK_THAT(shards.refusal(some({1, 2, 4, 5, 6, 7})), Contains("part 3 of 7 is missing"));
  CHECK_THAT(shards.refusal(some({7, 4, 1})), Contains("parts 2-3, 5-6 of 7 are missing"));
  CHECK_THAT(shards.refusal(some({1, 2, 3, 4, 5, 6, 7, 3})),
             Contains("part3.h5: is given twice; give each part once"));
  CHECK_THROWS_AS(merge({}, shards.scene.folder / "merged.h5"), UsageError);
}

TEST_CASE("parts of different runs are refused and named") {
  Shards shards;
  auto parts = shards.parts(2);
  parts[1] = shards.parts(3, "third")[1];
  CHECK_THAT(shards.refusal(parts),
             Contains("third2.h5: is part 2 of 3, but") && Contains("part1.h5 is part 1 of 2"));

  shards.scene.query.radius = 0.2;
  parts[1] = shards.parts(2, "wide")[1];
  CHECK_THAT(shards.refusal(parts), Contains("wide2.h5: answers another question than") &&
                                        Contains("part1.h5: radius is 0.2 m, not 0.1 m"));
  shards.scene.query.radius = 0.1;
  shards.scene.query.model.vertices[0].x = 0.01;
  parts[1] = shards.parts(2, "moved")[1];
  CHECK_THAT(shards.refusal(parts),
             Contains("moved2.h5: answers another question than") && Contains(": model is"));
  shards.scene.query.model.vertices[0].x = 0;

  // A store of the same points in other cells is refused, because parts of both would lack points.
  convert({shards.scene.folder / "wall.las"}, shards.scene.folder / "other.h5",
          {.cell_points = 128, .threads = 2});
  shards.store = "other.h5";
  parts[1] = shards.parts(2, "other")[1];
  CHECK_THAT(shards.refusal(parts), Contains("other2.h5: divides the work otherwise than"));

  parts[1] = shards.scene.folder / "whole.h5";
  shards.whole();
  CHECK_THAT(shards.refusal(parts), Contains("whole.h5: is a whole result"));
  parts[1] = shards.scene.folder / "wall.h5";
  CHECK_THAT(shards.refusal(parts), Contains("wall.h5: attribute 'format'"));
}

TEST_CASE("damage in a part is noticed") {
  Shards shards;
  Query& query = shards.scene.query;
  query.first_pose = true;
  query.clearance = query.profile = 0.3;
  const auto parts = shards.parts(2);
  const std::string sound = bytes_of(parts[1]);
  std::size_t refused = 0, tries = 0;
  for (std::size_t at = 0; at < sound.size(); at += sound.size() / 97) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(~damaged[at]);
    put_bytes(parts[1], damaged);
    ++tries;
    const std::string said = shards.refusal(parts);
    refused += !said.empty();
    if (!said.empty()) CHECK_THAT(said, Contains("part2.h5"));
    std::filesystem::remove(shards.scene.folder / "merged.h5");
  }
  CHECK(refused > tries / 2);  // the other tries change bytes that HDF5 does not use
}

TEST_CASE("a part is no result") {
  Shards shards;
  const auto parts = shards.parts(2);
  try {
    const Result part(parts[0]);
    FAIL("it was opened");
  } catch (const InputError& error) {
    CHECK(error.remedy() == Remedy::kMerge);
    CHECK_THAT(error.what(), Contains("part1.h5: is part 1 of 2 of a result"));
  }
  CHECK_THROWS_AS(merge(parts, parts[0], {.overwrite = true}), UsageError);
  shards.merged(parts);
  CHECK_THROWS_AS(merge(parts, shards.scene.folder / "merged.h5"), UsageError);
}

TEST_CASE("shards are numbered from 1") {
  Shards shards;
  const Store store(shards.scene.folder / "wall.h5");
  for (const Shard& shard : {Shard{0, 2}, Shard{3, 2}, Shard{1, 0}, Shard{1, Shard::kMost + 1}}) {
    CHECK_THROWS_AS(search(store, shards.scene.query, shards.scene.folder / "x.h5",
                           {.threads = 2, .shard = shard}),
                    UsageError);
  }
}

TEST_CASE("a merge stops when asked to and leaves nothing") {
  Shards shards;
  const auto parts = shards.parts(2);
  const std::atomic<bool> stop = true;
  CHECK_THROWS_AS(merge(parts, shards.scene.folder / "merged.h5", {.stop = &stop}), Interrupted);
  CHECK(!std::filesystem::exists(shards.scene.folder / "merged.h5"));
}
