// Results that ignore points.
#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "io/result/check_results.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

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
    header.classes_hash = 0;
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
  CHECK(unseen == 0);
}

TEST_CASE("results that ignore other points answer other questions") {
  const ResultHeader a = ignoring_header();
  ResultHeader b = a;
  CHECK(query_differences(a, b).empty());
  SECTION("class") { b.ignore_classes = {2}; }
  SECTION("box") { b.ignore_boxes.pop_back(); }
  SECTION("other classes of the same points") { b.classes_hash = 7; }
  const auto differences = query_differences(a, b);
  REQUIRE(differences.size() == 1);
  CHECK(differences[0].what == "ignored points");
}
