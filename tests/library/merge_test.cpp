// Parts that shards search, and the result that they make.
#include <algorithm>
#include <atomic>

#include "library/api_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Searches of the whole query and of its shards, all with the same options, and merges of the
/// parts.
struct Shards {
  explicit Shards(SearchOptions with = {}) : options(std::move(with)) {
    options.threads = 2;
    options.overwrite = true;
    options.device = Device::kCpu;
    query.poses[50].translation[1] = 0.5;  // away from the wall, so that some poses meet nothing
  }

  SearchReport search_to(const std::filesystem::path& file) const {
    return search(Store(scene.folder / store), query, file, options);
  }

  /// The bytes of the result of the whole search.
  std::string whole() {
    options.shard.reset();
    search_to(scene.folder / "whole.h5");
    return bytes_of(scene.folder / "whole.h5");
  }

  std::vector<std::filesystem::path> parts(std::uint32_t count, const std::string& name = "part") {
    std::vector<std::filesystem::path> out;
    for (std::uint32_t number = 1; number <= count; ++number) {
      options.shard = Shard{number, count};
      out.push_back(scene.folder / (name + std::to_string(number) + ".h5"));
      search_to(out.back());
    }
    return out;
  }

  std::string merged(const std::vector<std::filesystem::path>& parts,
                     const MergeOptions& how = {.overwrite = true}) {
    report = merge(parts, output, how);
    return bytes_of(output);
  }

  /// Checks that merging is refused with these words and leaves nothing.
  void check_merge_refused(const std::vector<std::filesystem::path>& parts, std::string_view words,
                           const MergeOptions& how = {}) const {
    check_refused<InputError>([&] { merge(parts, output, how); }, words);
    CHECK(!std::filesystem::exists(output));
    CHECK(!std::filesystem::exists(output.string() + ".partial"));
  }

  ApiScene scene;
  Query& query = scene.query;
  std::filesystem::path output = scene.folder / "merged.h5";
  std::string store = "wall.h5";
  MergeReport report;
  SearchOptions options;
};

void ask_for_all_tables(Query& query) {
  query.first_pose = true;
  query.clearance = query.profile = 0.3;
}

/// Warnings of reading the inputs.
const Message kOfAll{Message::Severity::kWarning,
                     "dusty",
                     "the model is dusty",
                     {{"grains", 7}, {"share of it", 0.5}},
                     {{0, 3}, {7, 9}}};
const Message kOfOne{Message::Severity::kWarning, "late", "the path came late"};

/// The warnings that are about the inputs, without those about the scene's question.
template <typename Warning>
std::vector<Warning> of_inputs(const std::vector<Warning>& warnings) {
  std::vector<Warning> out;
  for (const Warning& one : warnings) {
    if (one.code == kOfAll.code || one.code == kOfOne.code) out.push_back(one);
  }
  return out;
}

}  // namespace

TEST_CASE("64 parts of every table have the bytes of the search of everything, and say so") {
  Shards shards;
  ask_for_all_tables(shards.query);
  const std::string whole = shards.whole();
  auto parts = shards.parts(64);
  std::ranges::reverse(parts);
  CHECK(shards.merged(parts) == whole);
  CHECK(shards.report.parts == 64);
  CHECK(shards.report.parameters == shards.query);
  CHECK(shards.report.profile_poses < shards.query.poses.size());
  CHECK(shards.merged(parts, {.resume = true}) == whole);
  CHECK(shards.report.was_finished);
  CHECK(shards.report.parts == 64);
}

TEST_CASE("parts that found nothing make a result that says so, whatever engine searched") {
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    CAPTURE(name_of(engine));
    Shards shards({.engine = engine});
    shards.query.radius = 1e-4;
    CHECK(shards.merged(shards.parts(3)) == shards.whole());
    CHECK(shards.report.colliding_points == 0);
  }
}

TEST_CASE("parts that are missing or there twice are refused by number") {
  Shards shards;
  const auto parts = shards.parts(7);
  struct Row {
    std::vector<std::size_t> given;
    const char* words;
  };
  for (const Row& row :
       {Row{{1, 2, 4, 5, 6, 7}, "part 3 of 7 is missing"},
        Row{{7, 4, 1}, "parts 2-3, 5-6 of 7 are missing"},
        Row{{1, 2, 3, 4, 5, 6, 7, 3}, "part3.h5: is given twice; give each part once"}}) {
    std::vector<std::filesystem::path> given;
    for (const std::size_t number : row.given) given.push_back(parts[number - 1]);
    shards.check_merge_refused(given, row.words);
  }
  CHECK_THROWS_AS(merge({}, shards.output), UsageError);
}

TEST_CASE("parts of different runs are refused and named") {
  Shards shards;
  auto parts = shards.parts(2);
  const auto refused_with = [&](const std::filesystem::path& part, std::string_view words) {
    parts[1] = part;
    shards.check_merge_refused(parts, words);
  };
  refused_with(shards.parts(3, "third")[1], "third2.h5: is part 2 of 3, but ... is part 1 of 2");
  shards.query.radius = 0.2;
  refused_with(shards.parts(2, "wide")[1], "wide2.h5: answers another question than ... radius is");
  shards.check_merge_refused(parts, "part1.h5: radius is 0.2 m, not 0.1 m");
  shards.query.radius = 0.1;
  shards.query.model.vertices[0].x = 0.01;
  refused_with(shards.parts(2, "moved")[1],
               "moved2.h5: answers another question than ... : model is");
  shards.query.model.vertices[0].x = 0;

  // A store of the same points in other cells is refused, because parts of both would lack points.
  convert({shards.scene.folder / "wall.las"}, shards.scene.folder / "other.h5",
          {.cell_points = 128, .threads = 2});
  shards.store = "other.h5";
  refused_with(shards.parts(2, "other")[1], "other2.h5: divides the work otherwise than");

  shards.whole();
  refused_with(shards.scene.folder / "whole.h5", "whole.h5: is a whole result");
  refused_with(shards.scene.folder / "wall.h5", "wall.h5: is not a result");
}

TEST_CASE("damage in a part is noticed") {
  Shards shards;
  ask_for_all_tables(shards.query);
  const auto parts = shards.parts(2);
  const std::string sound = bytes_of(parts[1]);
  std::size_t refused = 0, tries = 0;
  for (std::size_t at = 0; at < sound.size(); at += sound.size() / 97) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(~damaged[at]);
    put_bytes(parts[1], damaged);
    ++tries;
    try {
      shards.merged(parts);
    } catch (const InputError& error) {
      ++refused;
      check_says(error.what(), "part2.h5");
    }
  }
  CHECK(refused > tries / 2);  // the other tries change bytes that HDF5 does not use
}

TEST_CASE("a part is no result, and neither takes the place of the other") {
  Shards shards;
  const auto parts = shards.parts(2);
  check_refused<InputError>([&] { Result{parts[0]}; }, "part1.h5: is part 1 of 2 of a result");
  CHECK_THROWS_AS(merge(parts, parts[0], {.overwrite = true}), UsageError);
  const std::atomic<bool> stop = true;
  CHECK_THROWS_AS(merge(parts, shards.output, {.stop = &stop}), Interrupted);
  CHECK(!std::filesystem::exists(shards.output));
  shards.merged(parts);
  CHECK_THROWS_AS(merge(parts, shards.output), UsageError);
  shards.options.overwrite = false;
  shards.options.resume = true;
  check_refused<UsageError>([&] { shards.search_to(shards.output); },
                            "is the whole result, and part 2 of 2 is asked for");
}

TEST_CASE("shards are numbered from 1, and a search says which one it was of") {
  Shards shards;
  const auto file = shards.scene.folder / "out.h5";
  for (const Shard& shard : {Shard{0, 2}, Shard{3, 2}, Shard{1, 0}, Shard{1, Shard::kMost + 1}}) {
    shards.options.shard = shard;
    CHECK_THROWS_AS(shards.search_to(file), UsageError);
  }
  shards.options.shard = Shard{2, 3};
  CHECK(shards.search_to(file).shard == Shard{2, 3});
  shards.query.depth = true;  // only the whole search knows which points are free
  check_refused<UsageError>([&] { shards.search_to(file); }, "shards");
  shards.options.shard.reset();
  CHECK(!shards.search_to(file).shard);
}

TEST_CASE("a merge repeats each warning of its parts once") {
  Shards shards;
  shards.options.input_warnings = {kOfAll};
  auto parts = shards.parts(3);
  shards.options.input_warnings = {kOfAll, kOfOne, kOfOne};
  parts[1] = shards.parts(3, "late")[1];
  std::vector<Message> told;
  const std::string merged = shards.merged(
      parts, {.overwrite = true, .message = [&](const Message& one) { told.push_back(one); }});
  CHECK(told.size() == shards.report.part_warnings.size());
  // The result keeps each once, whatever number of parts has it.
  const std::vector<Message> kept = Result(shards.output).warnings();
  REQUIRE(of_inputs(kept).size() == 2);
  CHECK(of_inputs(kept)[0].numbers == kOfAll.numbers);
  CHECK(of_inputs(kept)[0].stretches == kOfAll.stretches);
  CHECK(kept.size() == shards.report.warnings.size());
  const auto warnings = of_inputs(shards.report.part_warnings);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].code == "dusty");
  CHECK(warnings[0].parts == 3);
  CHECK(warnings[0].text == kOfAll.text);
  CHECK(warnings[0].numbers == kOfAll.numbers);
  CHECK(warnings[0].severity == Message::Severity::kWarning);
  CHECK(warnings[1].code == "late");
  CHECK(warnings[1].parts == 1);
  told = of_inputs(told);
  REQUIRE(told.size() == 2);
  check_equal(told[0].text, "the model is dusty (in all parts)");
  check_equal(told[1].text, "the path came late (in 1 of 3 parts)");

  CHECK(shards.merged(parts, {.resume = true}) == merged);
  CHECK(shards.report.was_finished);
  CHECK(shards.report.warnings.size() == kept.size());
  CHECK(of_inputs(shards.report.part_warnings).size() == 2);

  shards.options.input_warnings = {kOfAll, kOfOne};
  CHECK(shards.merged(shards.parts(3)) == shards.whole());
  std::filesystem::remove(shards.output);
  shards.check_merge_refused(parts, "strict: ... dusty ... late", {.strict = true});
}

TEST_CASE("a part that was interrupted and is resumed holds the warnings") {
  Shards shards;
  const auto output = shards.scene.folder / "part1.h5";
  auto parts = shards.parts(2, "sound");
  std::atomic<bool> stop = false;
  shards.options = {.device = Device::kCpu,
                    .threads = 1,
                    .shard = Shard{1, 2},
                    .input_warnings = {kOfAll},
                    .progress = [&](const ProgressUpdate& now) { stop = stop || now.done > 0; },
                    .stop = &stop};
  CHECK_THROWS_AS(shards.search_to(output), Interrupted);
  REQUIRE(std::filesystem::exists(shards.scene.folder / "part1.h5.journal"));
  stop = false;
  shards.options.progress = nullptr;
  shards.options.resume = true;
  shards.search_to(output);
  parts[0] = output;
  shards.merged(parts);
  const auto warnings = of_inputs(shards.report.part_warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].code == "dusty");
  CHECK(warnings[0].parts == 1);

  // With other warnings about the same inputs it stays the same part, and is made again to say
  // them.
  CHECK(shards.search_to(output).was_finished);
  shards.options.input_warnings = {kOfOne};
  CHECK_FALSE(shards.search_to(output).was_finished);
}
