// Public alignments, and poses of one of them that an independent program computed in 50 digits.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "clearway/alignment.hpp"
#include "clearway/error.hpp"
#include "clearway/file_unit.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::filesystem::path alignment_named(const std::string& name) {
  return data_folder() / "alignments" / name;
}

struct KnownPose {
  std::string kind;  ///< file, low or reverse
  double station = 0;
  double numbers[12];  ///< position, then the columns of the rotation
};

std::vector<KnownPose> known_poses() {
  std::ifstream in(alignment_named("PR_Twin_Branch_poses.csv"));
  std::vector<KnownPose> poses;
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    KnownPose pose;
    fields >> pose.kind >> pose.station;
    for (double& number : pose.numbers) fields >> number;
    pose.kind.erase(0, pose.kind.find('/') + 1);
    REQUIRE(fields);
    poses.push_back(pose);
  }
  return poses;
}

std::string warnings_in(std::vector<Message> remarks) {
  std::erase_if(remarks,
                [](const Message& one) { return one.severity == Message::Severity::kNote; });
  return codes_of(remarks);
}

}  // namespace

TEST_CASE("a real alignment in US survey feet has the poses that are known") {
  const auto known = known_poses();
  REQUIRE(known.size() == 26);
  for (const KnownPose& pose : known) {
    AlignmentOptions options;
    options.station_from = options.station_to = pose.station / kMetresPerUsSurveyFoot;
    options.reverse = pose.kind == "reverse";
    // The file has no cant, so naming a rail changes nothing.
    if (pose.kind == "low") options.cant = CantLine::kInsideRail;
    const auto poses =
        read_alignment(alignment_named("PR_Twin_Branch_section_alignment.xml"), options);
    REQUIRE(poses.size() == 1);
    for (int k = 0; k < 3; ++k) {
      check_near(poses[0].translation[k], pose.numbers[k], 2e-9);
      for (int column = 0; column < 3; ++column) {
        CHECK(std::abs(poses[0].rotation[3 * k + column] - pose.numbers[3 + 3 * column + k]) <
              1e-9);
      }
    }
  }
}

TEST_CASE("public alignments are read, or refused with the reason") {
  std::vector<Message> remarks;
  const auto twin =
      read_alignment(alignment_named("PR_Twin_Branch_section_alignment.xml"), {}, &remarks);
  check_equal(twin.size(), 8526);
  check_equal(warnings_in(remarks), "alignment-feet");

  const auto first = alignment_named("UT-Alignment-Aplitop-1.xml");
  remarks.clear();
  const auto clothoids = read_alignment(first, {}, &remarks);
  check_equal(clothoids.size(), 5072);
  check_equal(warnings_in(remarks), "");
  // It ends where the file says that the last line does.
  check_near(clothoids.back().translation[0], 335420.420696, 1e-9);
  check_near(clothoids.back().translation[1], 4084689.855782, 1e-9);
  check_near(clothoids.back().translation[2], 350.7, 1e-4);
  check_refused([&] { return read_alignment(first, {.order = AxisOrder::kEastingNorthing}); },
                "Center lies on the other side ... --order ne");

  const auto second = alignment_named("Alignment-Aplitop-2.XML");
  check_refused([&] { return read_alignment(second, {.max_gap = 0.01}); }, "no profile");
  // The radius of its second curve is 1.3 mm off its centre, which places nothing, and makes the
  // curve 0.5 mm shorter than its chord. Most lines of this file end with CR CR LF, which are two.
  check_equal(read_alignment(second, {.height = 0}).size(), 56512);
  check_refused([&] { return read_alignment(second, {.max_gap = 0.0001, .height = 0}); },
                "line 82 ... 0.000475 m ... --max-gap 0.0005");

  const auto late = alignment_named("TOI-M14334-0000A.XML");
  remarks.clear();
  const auto road = read_alignment(late, {.step = 1}, &remarks);
  check_equal(warnings_in(remarks), "profile-shorter");
  check_near(road.front().translation[2], 125.687614, 1e-9);
  check_near(road.back().translation[2], 125.806, 1e-8);
}
