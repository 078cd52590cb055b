// Results as they are written and read again.
#include "io/result/result.hpp"

#include <cmath>

#include "core/util/format.hpp"
#include "io/result/answer.hpp"
#include "io/result/floor_facts.hpp"
#include "io/result/sample_result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Headers that ask for different tables and columns.
std::vector<ResultHeader> asked_headers(std::uint64_t poses) {
  std::vector<ResultHeader> all{sample_header(false), sample_header(true), full_header(poses)};
  all[1].between_poses = true;
  all[1].crs_wkt = "PROJCS[\"ETRS89 / UTM 32N — ä\"]";
  all[1].clearance = 0.3;
  all[1].ignore_boxes = all[2].ignore_boxes;
  all[1].ignored = {12, {}, {5, 7}};
  // Bodies without first poses are only those of clearances.
  all.push_back(all[2]);
  all[3].first_pose = false;
  all[3].ignore_boxes.clear();
  all[3].ignored.in_boxes.clear();
  return all;
}

}  // namespace

TEST_CASE("a result is read as it was written, and its bytes depend on nothing else") {
  const std::size_t count = GENERATE(0u, 1u, 3u, 65'535u, 65'536u, 65'537u, 150'000u);
  const std::size_t which = GENERATE(0u, 1u, 2u, 3u);
  CAPTURE(count, which);
  const SampleResult sample(asked_headers(std::max<std::size_t>(count, 1))[which], count);
  sample.write();
  CHECK(sample.is_read());
  check_equal(sample.fault(), "");
  const ResultReader reader(sample.path());
  CHECK(reader.collisions() == count);
  CHECK(reader.clearances() == sample.near.size());
  CHECK(reader.profile_rows() == sample.profile.size());
  check_equal(reader.name(), sample.path().string());
  CHECK(reader.column(&Collisions::body) == sample.rows.body);
  const std::string bytes = bytes_of(sample.path());
  for (const std::size_t step : {65'537u, 149'999u, 150'000u}) {
    sample.write("another name.h5", step);
    check_same(bytes_of(sample.path("another name.h5")), bytes);
  }
}

TEST_CASE("a result is read by any range of rows") {
  const SampleResult sample(sample_header(true), 70'000);
  sample.write("out.h5", 7);
  const ResultReader reader(sample.path());
  Collisions read;
  for (const std::size_t first : {0u, 8'191u, 8'192u, 32'767u, 65'535u, 69'990u}) {
    reader.read(first, 10, read);
    CHECK(same_table(read, part_of(sample.rows, first, 10)));
  }
  CHECK_THROWS_AS(reader.read(69'991, 10, read), std::logic_error);
  CHECK(reader.column(&Collisions::source) == sample.rows.source);
  CHECK(reader.column(&Collisions::xyz) == sample.rows.xyz);
  CHECK(reader.column(&Collisions::first_pose) == sample.rows.first_pose);
}

namespace {

/// A writer of a result with these numbers of rows.
struct Writer {
  Writer(const ResultHeader& header, std::uint64_t collisions, std::uint64_t clearances)
      : writer(folder / "out.h5", header, collisions, clearances) {}

  template <typename Rows>
  void check_refused(const Rows& rows) {
    CHECK_THROWS_AS(writer.append(rows), std::logic_error);
  }

  ScratchFolder folder;
  ResultWriter writer;
};

}  // namespace

TEST_CASE("a writer refuses rows that do not belong to its result") {
  const SampleResult sample(full_header(3), 4);
  const Collisions two = part_of(sample.rows, 0, 2);
  Writer one(sample.header, 3, 2);
  one.check_refused(sample.rows);
  Collisions changed = two;
  changed.first_pose.clear();
  one.check_refused(changed);
  changed = two;
  changed.body.clear();
  one.check_refused(changed);
  one.check_refused(part_of(sample.near, 0, 1));  // clearances before the collisions
  one.check_refused(sample.profile);
  one.writer.append(two);
  one.check_refused(part_of(sample.rows, 0, 1));
  CHECK_THROWS_AS(one.writer.finish(), std::logic_error);
  one.writer.append(part_of(sample.rows, 2, 1));
  one.check_refused(part_of(sample.near, 0, 3));
  one.writer.append(part_of(sample.near, 1, 1));
  one.check_refused(part_of(sample.near, 0, 1));
  CHECK_THROWS_AS(one.writer.finish(), std::logic_error);
  one.writer.append(part_of(sample.near, 2, 1));
  ProfileRows poses = sample.profile;
  poses.source.pop_back();
  one.check_refused(poses);
  one.writer.append(part_of(sample.profile, 0, 2));
  one.check_refused(part_of(sample.profile, 0, 2));
  CHECK_THROWS_AS(one.writer.finish(), std::logic_error);

  Writer plain(sample_header(true), 2, 0);
  plain.check_refused(two);  // of bodies, and with classes
  plain.check_refused(Clearances{});
  plain.check_refused(ProfileRows{});
}

TEST_CASE("a result that is not finished, or has no folder, is refused by name") {
  const ScratchFolder folder;
  { ResultWriter writer(folder / "out.h5", sample_header(false), 0); }
  check_refused<InputError>([&] { return ResultReader(folder / "out.h5"); }, "out.h5 ... complete");
  check_refused<ResourceError>(
      [&] { return ResultWriter(folder / "no/out.h5", sample_header(false), 0); }, "no/out.h5");
}

TEST_CASE("a warning that is said twice names the stretches of both") {
  constexpr auto kWarning = Message::Severity::kWarning;
  const auto missing = [](std::vector<PoseRange> stretches) {
    return Message{kWarning, "nothing-below", "no ground", {}, std::move(stretches)};
  };
  std::vector<Message> warnings;
  add_warnings({missing({{0, 4}, {20, 25}}), {Message::Severity::kNote, "nothing-below", "note"}},
               warnings);
  add_warnings({missing({{3, 9}}), missing({})}, warnings);
  add_warnings({missing({{30, 31}})}, warnings);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].stretches == std::vector<PoseRange>{{0, 9}, {20, 25}, {30, 31}});
  // One about the whole path raises no doubt, and so does not stand for those about stretches.
  CHECK(warnings[1].stretches.empty());
}

TEST_CASE("a vehicle's result keeps the floor of each body, which outputs say in words") {
  SampleResult vehicle(full_header(10), 10);
  vehicle.header.body_floors = {0.25, std::nullopt, -0.5};
  {
    ResultWriter writer(vehicle.path(), vehicle.header, 0);
    writer.append(vehicle.profile);
    ResultFindings findings;
    findings.floor_colliding = 12;
    writer.finish(findings);
  }
  const ResultReader result(vehicle.path());
  CHECK(same_answer(result.header(), vehicle.header));
  Answer answer = counted_answer(result);
  CHECK(answer.body_floors == vehicle.header.body_floors);
  const auto words = [&] { return floor_words(floor_json(answer), "m"); };
  check_equal(words(),
              "the floors of the vehicle's bodies (front bogie 0.25 m, body none, back -0.5 m)");
  answer.body_floors = {0.25, 0.25, 0.25};
  check_equal(words(), "0.25 m of the vehicle");
  answer.budget = ErrorBudget{.scan = 0.01, .sigmas = 3};
  const std::string clear = format_brief(answer.budget->clear());
  check_equal(words(), "0.25 m of the vehicle (" + format_brief(0.25 - answer.budget->clear()) +
                           " m with the errors)");
  answer.body_floors.back() = 0.3;
  check_equal(words(),
              "the floors of the vehicle's bodies (front bogie 0.25 m, body 0.25 m, back 0.3 "
              "m; with the errors " +
                  clear + " m lower)");
  answer.budget.reset();
  for (int i = 0; i < 5; ++i) {
    answer.bodies.push_back("wagon " + std::to_string(i));
    answer.body_floors.push_back(i < 3 ? std::optional(0.1 * (i + 1)) : std::nullopt);
  }
  check_equal(words(), "the floors of the vehicle's bodies (0.1 m to 0.3 m, 2 bodies without)");
}
