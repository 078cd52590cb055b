#include "io/result/result.hpp"

#include <hdf5.h>

#include <cmath>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "io/result/answer.hpp"
#include "io/result/check_results.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a result is read as it was written") {
  const ScratchFolder folder;
  const bool first_pose = GENERATE(false, true);
  const std::size_t count = GENERATE(0u, 1u, 3u, 65'535u, 65'536u, 65'537u, 200'000u);
  ResultHeader header = sample_header(first_pose);
  header.between_poses = GENERATE(false, true);
  header.crs_wkt = GENERATE(std::string(), std::string("PROJCS[\"ETRS89 / UTM 32N — ä\"]"));
  const Collisions rows = sample_rows(header, count);
  write_result(folder / "out.h5", header, rows);

  const ResultReader reader(folder / "out.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.collisions() == count);
  CHECK(reader.name() == (folder / "out.h5").string());
  CHECK(same_rows(read_rows(reader), rows));
}

TEST_CASE("a result is read by any range of rows") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  const Collisions rows = sample_rows(header, 70'000);
  write_result(folder / "out.h5", header, rows);
  const ResultReader reader(folder / "out.h5");
  for (const std::size_t first : {0u, 8'191u, 8'192u, 32'767u, 65'535u, 69'990u}) {
    Collisions read;
    RowHashes<Collisions> hashes;
    reader.read(first, 10, read, hashes);
    CHECK(same_rows(read, part_of(rows, first, 10)));
  }
  Collisions read;
  RowHashes<Collisions> hashes;
  CHECK_THROWS_AS(reader.read(69'991, 10, read, hashes), std::logic_error);
  CHECK(reader.column(&Collisions::source) == rows.source);
  CHECK(reader.column(&Collisions::xyz) == rows.xyz);
  CHECK(reader.column(&Collisions::first_pose) == rows.first_pose);
}

TEST_CASE("equal contents give equal bytes, however they were appended and named") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(GENERATE(false, true));
  const Collisions rows = sample_rows(header, 150'000);
  write_result(folder / "a.h5", header, rows, 150'000);
  const std::string bytes = bytes_of(folder / "a.h5");
  for (const std::size_t step : {7u, 8'192u, 65'537u, 149'999u}) {
    write_result(folder / "another name.h5", header, rows, step);
    CHECK(bytes_of(folder / "another name.h5") == bytes);
  }
}

TEST_CASE("results of different queries differ in their bytes") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(false);
  write_result(folder / "a.h5", header, {});
  ResultHeader other = header;
  SECTION("radius") { other.radius = std::nextafter(header.radius, 1.0); }
  SECTION("between poses") { other.between_poses = true; }
  write_result(folder / "b.h5", other, {});
  CHECK(bytes_of(folder / "a.h5") != bytes_of(folder / "b.h5"));
}

TEST_CASE("a writer refuses rows that do not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  const Collisions rows = sample_rows(header, 4);
  ResultWriter writer(folder / "out.h5", header, 3);
  CHECK_THROWS_AS(writer.append(rows), std::logic_error);
  Collisions two = part_of(rows, 0, 2);
  two.first_pose.clear();
  CHECK_THROWS_AS(writer.append(two), std::logic_error);
  writer.append(part_of(rows, 0, 2));
  CHECK_THROWS_AS(writer.append(part_of(rows, 0, 1)), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
}

TEST_CASE("a result whose writer did not finish is refused") {
  const ScratchFolder folder;
  { ResultWriter writer(folder / "out.h5", sample_header(false), 0); }
  check_refused<InputError>([&] { return ResultReader(folder / "out.h5"); }, "out.h5 ... complete");
}

TEST_CASE("a folder that is not there is a resource error that names the file") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(ResultWriter(folder / "no/out.h5", sample_header(false), 0), ResourceError);
  check_refused([&] { return ResultWriter(folder / "no/out.h5", sample_header(false), 0); },
                "no/out.h5");
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

// Results that ignore points.
namespace {

ResultHeader ignoring_header() {
  ResultHeader header = sample_header(false);
  header.ignore_classes = {2, 7};
  header.ignore_boxes = {{{-1, -2, -3}, {4, 5, 6}}, {{0, 0, 0}, {1, 1, 1}}};
  header.ignored = {1234, {1000, 200}, {0, 34}};
  header.classes_hash = 0x123456789abcdef0;
  return header;
}

}  // namespace

TEST_CASE("a result keeps what was ignored") {
  const ScratchFolder folder;
  ResultHeader header = ignoring_header();
  SECTION("classes and boxes") {}
  SECTION("classes") {
    header.ignore_boxes.clear();
    header.ignored.in_boxes.clear();
  }
  SECTION("boxes") {
    header.ignore_classes.clear();
    header.ignored.of_classes.clear();
  }
  write_result(folder / "a.h5", header, sample_rows(header, 10));
  CHECK(same_answer(ResultReader(folder / "a.h5").header(), header));
}

TEST_CASE("damage to what was ignored is noticed") {
  const ScratchFolder folder;
  const ResultHeader header = ignoring_header();
  write_result(folder / "a.h5", header, sample_rows(header, 10));
  const std::string bytes = bytes_of(folder / "a.h5");
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t unseen = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x20);
    put_bytes(folder / "b.h5", changed);
    try {
      unseen += !same_answer(ResultReader(folder / "b.h5").header(), header);
    } catch (const InputError&) {
    }
  }
  check_equal(unseen, 0);
}

TEST_CASE("results that ignore other points answer other questions") {
  const ResultHeader a = ignoring_header();
  ResultHeader b = a;
  CHECK(query_differences(a, b).empty());
  std::string what = "ignored points";
  SECTION("class") { b.ignore_classes = {2}; }
  SECTION("box") { b.ignore_boxes.pop_back(); }
  SECTION("other classes of the same points") {
    b.classes_hash = 7;
    what = "classes";
  }
  const auto differences = query_differences(a, b);
  REQUIRE(differences.size() == 1);
  check_equal(differences[0].what, what);
}

namespace {

ResultHeader header_of_3() {
  ResultHeader header = sample_header(false);
  header.poses = 3;
  header.profile = 0.5;
  return header;
}

/// Replaces an attribute behind the reader's back.
template <typename Write>
void replace(const std::filesystem::path& path, const char* name, Write write) {
  const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
  REQUIRE(H5Adelete(file.get(), name) >= 0);
  write(file);
}

}  // namespace

TEST_CASE("results of other versions are refused") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", header_of_3(), {}, 1000, {}, sample_profile(header_of_3()));
  const auto version = GENERATE(as<std::uint32_t>(), 0, 5, 7, 0xffffffff);
  replace(folder / "a.h5", "version",
          [&](const hdf5::Id& file) { hdf5::write_number(file, "version", version); });
  check_refused(
      [&] { return ResultReader(folder / "a.h5"); },
      "is a result of version " + std::to_string(version) + " of another release; run it again");
}

TEST_CASE("malformed attributes of a profile and a model box are refused") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", header_of_3(), {}, 1000, {}, sample_profile(header_of_3()));
  std::string expected;
  SECTION("a negative length") {
    replace(folder / "a.h5", "profile",
            [](const hdf5::Id& file) { hdf5::write_number(file, "profile", -0.5); });
    expected = "'profile'";
  }
  SECTION("no number") {
    replace(folder / "a.h5", "profile",
            [](const hdf5::Id& file) { hdf5::write_number(file, "profile", std::nan("")); });
    expected = "'profile'";
  }
  SECTION("more poses than rows") {
    replace(folder / "a.h5", "poses",
            [](const hdf5::Id& file) { hdf5::write_number(file, "poses", std::uint64_t{4}); });
    expected = "one for each of 4 poses";
  }
  SECTION("a box from high to low") {
    replace(folder / "a.h5", "model_box", [](const hdf5::Id& file) {
      hdf5::write_attribute<double>(file, "model_box", std::vector<double>{0, 0, 1, 0, 0, 0}, 3);
    });
    expected = "'model_box'";
  }
  SECTION("a box of five numbers") {
    replace(folder / "a.h5", "model_box", [](const hdf5::Id& file) {
      hdf5::write_attribute<double>(file, "model_box", std::vector<double>{0, 0, 1, 0, 0});
    });
    expected = "model_box";
  }
  check_refused([&] { return ResultReader(folder / "a.h5"); }, expected);
}
