// What a part holds beside its rows: the warnings of its run.
#include <sys/resource.h>

#include <atomic>
#include <functional>
#include <optional>

#include "io/result/result.hpp"
#include "library/shards.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Message kOfAll{Message::Severity::kWarning,
                     "dusty",
                     "the model is dusty",
                     {{"grains", 7}, {"share of it", 0.5}}};
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

/// Searches three parts. All warn of the question and of kOfAll, the second one also of kOfOne.
std::vector<std::filesystem::path> warned_parts(Shards& shards) {
  shards.options.input_warnings = {kOfAll};
  auto parts = shards.parts(3);
  shards.options.input_warnings = {kOfAll, kOfOne, kOfOne};
  parts[1] = shards.parts(3, "late")[1];
  return parts;
}

/// Changes the header and the findings of a part without rows.
void change(const std::filesystem::path& part,
            const std::function<void(ResultPart&, ResultFindings&)>& how) {
  std::optional<ResultHeader> header;
  ResultFindings findings;
  {
    const ResultReader reader(part, Parts::kAccepted);
    REQUIRE(reader.collisions() == 0);
    header = reader.header();
    findings = reader.findings();
  }
  how(*header->part, findings);
  ResultWriter(part, *header, 0).finish(findings);
}

/// Limits the number of files that the process may open, until the end of its scope.
class OpenFilesLimit {
 public:
  explicit OpenFilesLimit(rlim_t files) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit changed = before_;
    changed.rlim_cur = files;
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &changed) == 0);
  }
  ~OpenFilesLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  OpenFilesLimit(const OpenFilesLimit&) = delete;
  OpenFilesLimit& operator=(const OpenFilesLimit&) = delete;

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("a merge repeats each warning of its parts once") {
  Shards shards;
  const auto parts = warned_parts(shards);
  std::vector<Message> told;
  const MergeOptions options{.overwrite = true,
                             .message = [&](const Message& one) { told.push_back(one); }};
  const std::string merged = shards.merged(parts, options);
  CHECK(told.size() == shards.report.part_warnings.size());
  // The result keeps each once, whatever number of parts has it.
  const std::vector<Message> kept = Result(shards.scene.folder / "merged.h5").warnings();
  REQUIRE(of_inputs(kept).size() == 2);
  CHECK(of_inputs(kept)[0].numbers == kOfAll.numbers);
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
  CHECK(told[0].text == "the model is dusty (in all parts)");
  CHECK(told[1].text == "the path came late (in 1 of 3 parts)");

  CHECK(shards.merged(parts, {.resume = true}) == merged);
  CHECK(shards.report.was_finished);
  CHECK(shards.report.warnings.size() == kept.size());
  CHECK(of_inputs(shards.report.part_warnings).size() == 2);
}

TEST_CASE("a merge keeps the warnings of one search of everything, with their stretches") {
  Shards shards;
  Message stretch = kOfAll;
  stretch.stretches = {{0, 3}, {7, 9}};
  shards.options.input_warnings = {stretch, kOfOne};
  const std::string whole = shards.whole();
  CHECK(shards.merged(shards.parts(3)) == whole);
  const std::vector<Message> kept = Result(shards.scene.folder / "merged.h5").warnings();
  REQUIRE(of_inputs(kept).size() == 2);
  CHECK(of_inputs(kept)[0].stretches == stretch.stretches);
}

TEST_CASE("a strict merge refuses parts whose runs warned") {
  Shards shards;
  shards.scene.query.radius = 1e-4;
  const auto parts = warned_parts(shards);
  const auto told = [&](const auto& warnings) {
    for (const auto& part : parts) {
      change(part, [&](ResultPart&, ResultFindings& found) { found.warnings = warnings; });
    }
    return shards.refusal(parts, {.strict = true});
  };
  CHECK_THAT(shards.refusal(parts, {.strict = true}),
             Contains("strict: ") && Contains("dusty") && Contains("late"));
  CHECK(told(std::vector<Message>{kOfOne}) ==
        "strict: 1 warning (late), expected none; no output was written");
  CHECK(told(std::vector<Message>{}).empty());
  shards.merged(parts);
  CHECK(shards.report.part_warnings.empty());
}

TEST_CASE("the warnings of a question are those of the search of everything") {
  Shards shards;
  for (Pose& pose : shards.scene.query.poses) pose.translation[1] += 1000;  // away from the scan
  shards.options.shard.reset();
  const SearchReport whole = search(Store(shards.scene.folder / "wall.h5"), shards.scene.query,
                                    shards.scene.folder / "whole.h5", shards.options);
  REQUIRE(!whole.warnings.empty());
  shards.merged(shards.parts(2));
  REQUIRE(shards.report.part_warnings.size() == whole.warnings.size());
  for (std::size_t i = 0; i < whole.warnings.size(); ++i) {
    CHECK(shards.report.part_warnings[i].code == whole.warnings[i].code);
    CHECK(shards.report.part_warnings[i].text == whole.warnings[i].text);
    CHECK(shards.report.part_warnings[i].numbers == whole.warnings[i].numbers);
    CHECK(shards.report.part_warnings[i].parts == 2);
  }
}

TEST_CASE("a part that was interrupted and is resumed holds the warnings") {
  Shards shards;
  const Store store(shards.scene.folder / "wall.h5");
  const auto output = shards.scene.folder / "part1.h5";
  std::atomic<bool> stop = false;
  SearchOptions options{.engine = Engine::kSweep,
                        .device = Device::kCpu,
                        .threads = 1,
                        .shard = Shard{1, 2},
                        .input_warnings = {kOfAll},
                        .stop = &stop};
  options.progress = [&](const ProgressUpdate& update) { stop = stop || update.done > 0; };
  CHECK_THROWS_AS(search(store, shards.scene.query, output, options), Interrupted);
  REQUIRE(std::filesystem::exists(shards.scene.folder / "part1.h5.journal"));
  stop = false;
  options.progress = nullptr;
  options.resume = true;
  search(store, shards.scene.query, output, options);
  auto parts = shards.parts(2, "sound");
  parts[0] = output;
  shards.merged(parts);
  const auto warnings = of_inputs(shards.report.part_warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].code == "dusty");
  CHECK(warnings[0].parts == 1);

  // With other warnings about the same inputs it stays the same part, and is made again to say
  // them.
  CHECK(search(store, shards.scene.query, output, options).was_finished);
  options.input_warnings = {kOfOne};
  CHECK_FALSE(search(store, shards.scene.query, output, options).was_finished);
}

TEST_CASE("more parts than files that may be open are refused before merging begins") {
  Shards shards;
  const auto parts = shards.parts(40);
  {
    const OpenFilesLimit limit(48);
    CHECK_THROWS_WITH(merge(parts, shards.scene.folder / "merged.h5"),
                      Contains("to merge 40 parts needs") && Contains("ulimit -n"));
  }
  CHECK(!std::filesystem::exists(shards.scene.folder / "merged.h5"));
  CHECK_NOTHROW(shards.merged(parts));
}

TEST_CASE("a search says which part it was of") {
  Shards shards;
  const Store store(shards.scene.folder / "wall.h5");
  const auto output = shards.scene.folder / "out.h5";
  SearchOptions options{.threads = 1, .shard = Shard{2, 3}};
  CHECK(search(store, shards.scene.query, output, options).shard == Shard{2, 3});
  options.overwrite = true;
  options.shard.reset();
  CHECK(!search(store, shards.scene.query, output, options).shard);
}

TEST_CASE("a part in the place of a result is named where a search is resumed") {
  Shards shards;
  const auto parts = shards.parts(2);
  const Store store(shards.scene.folder / "wall.h5");
  const auto said = [&](std::optional<Shard> shard, const std::filesystem::path& output) {
    try {
      search(store, shards.scene.query, output, {.threads = 1, .shard = shard, .resume = true});
    } catch (const UsageError& error) {
      CHECK(error.remedy() == Remedy::kOtherPart);
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(said({}, parts[0]),
             Contains("part1.h5: is part 1 of 2, and the whole result is asked for"));
  CHECK_THAT(said(Shard{2, 2}, parts[0]), Contains("is part 1 of 2, and part 2 of 2 is asked for"));
  shards.whole();
  CHECK_THAT(said(Shard{2, 2}, shards.scene.folder / "whole.h5"),
             Contains("is the whole result, and part 2 of 2 is asked for"));
}
