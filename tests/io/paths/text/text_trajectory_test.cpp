#include "io/paths/text/text_trajectory.hpp"

#include <string>
#include <vector>

#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::size_t kPoses = 30'000;  // some 4 blocks of lines or more

/// Line i of a trajectory: a row-major matrix without a rotation.
std::string row_of(std::size_t i) {
  const std::string n = std::to_string(i);
  return "1 0 0 " + n + ".25 0 1 0 -" + n + ".5 0 0 1 " + n + "e-3";
}

Pose pose_of(std::size_t i) {
  const auto n = static_cast<double>(i);
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1},
          {n + 0.25, -(n + 0.5), std::stod(std::to_string(i) + "e-3")}};
}

std::string rows(std::size_t from, std::size_t to, const std::string& behind = "\n") {
  std::string text;
  for (std::size_t i = from; i < to; ++i) text += row_of(i) + behind;
  return text;
}

std::vector<Pose> read(const std::string& text, std::vector<Message>* remarks = nullptr) {
  const ScratchFolder scratch;
  return read_trajectory(scratch.write("path.txt", text), {}, remarks);
}

}  // namespace

TEST_CASE("a long trajectory has its poses in the order of its lines") {
  std::vector<Pose> expected;
  for (std::size_t i = 0; i < kPoses; ++i) expected.push_back(pose_of(i));
  for (const std::string& text :
       {rows(0, kPoses), rows(0, kPoses - 1) + row_of(kPoses - 1), rows(0, kPoses, " 0 0 0 1\n"),
        "# one\n\n" + rows(0, 9, "\r\n") + "\n// more\n" + rows(9, 20'000, " \n") + "\n#\n" +
            rows(20'000, kPoses)}) {
    CHECK((read(text) == expected));
  }
}

TEST_CASE("a long table keeps angles, times and names with their poses") {
  const ScratchFolder scratch;
  const std::string header = "name,time,x,y,z,roll_deg,pitch_deg,heading_deg\n";
  const auto row = [](std::size_t i) {
    const std::string n = std::to_string(i);
    return "\"a, " + n + "\"," + n + ".5," + n + ",1,2," + std::to_string(i % 7) + "," +
           std::to_string(i % 5) + "," + std::to_string(i % 360) + "\n";
  };
  std::string text = header;
  for (std::size_t i = 0; i < kPoses; ++i) text += row(i);
  PoseLabels labels;
  const auto poses = read_trajectory(scratch.write("a.csv", text), {}, nullptr, &labels);
  REQUIRE(poses.size() == kPoses);
  REQUIRE(labels.name.size() == kPoses);
  REQUIRE(labels.time.size() == kPoses);
  for (std::size_t i = 0; i < kPoses; ++i) {
    const auto number = static_cast<double>(i);
    const bool same = labels.name[i] == "a, " + std::to_string(i) &&
                      labels.time[i] == number + 0.5 && poses[i].translation[0] == number;
    if (!same) FAIL("line " << i);
  }
  for (const std::size_t i : {std::size_t{0}, std::size_t{12'345}, kPoses - 1}) {
    CHECK(poses[i] == read(header + row(i)).at(0));
  }
}

TEST_CASE("a line in the middle of a long trajectory is refused by its number") {
  const std::pair<std::string, const char*> cases[] = {
      {"#\n" + rows(0, 25'000) + "1 0 0 x\n" + rows(0, 5'000),
       "line 25002:  ... expected numbers only"},
      {rows(0, 25'000) + rows(0, 1, " 0 0 0 1\n") + rows(0, 5'000),
       "line 25001: 16 numbers; expected 12 as in the first line"},
      // The first of several faulty lines is named.
      {rows(0, 10'000) + "1 2\n" + rows(0, 9'000) + "nan\n", "line 10001: 2 numbers"},
      {rows(0, 25'000) + std::string(70'000, '1') + "\n",
       "line 25001: is longer than 65536 bytes"}};
  for (const auto& [text, words] : cases) check_refused<InputError>([&] { read(text); }, words);
}

TEST_CASE("a long trajectory that ends within a number is warned of by its last line") {
  std::vector<Message> remarks;
  check_equal(read(rows(0, 25'000) + "1 0 0 1 0 1 0 2 0 0 1 3.", &remarks).size(), 25'001);
  REQUIRE_FALSE(remarks.empty());
  check_equal(remarks[0].code, "cut-text");
  check_equal(remarks[0].numbers.at(0).second, 25'001);
}
