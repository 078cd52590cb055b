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

std::vector<std::string> codes_in(const std::vector<Message>& remarks) {
  std::vector<std::string> codes;
  for (const Message& remark : remarks) {
    if (remark.severity == Message::Severity::kWarning) codes.push_back(remark.code);
  }
  return codes;
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

TEST_CASE("places on real clothoids, arcs and lines are those of 30 digits") {
  // Station, position and x axis by the formulas of docs/design/trajectory.md (mpmath).
  const double known[][7] = {
      {33.25, 335116.361810185364, 4084603.02680801523, 368.20682298962234, 0.627114372515553225,
       0.776835384491086011, 0.0570469033954561365},
      {62.0, 335120.474720778417, 4084630.40040405413, 369.385234773535111, -0.141763861729100564,
       0.989589073933876492, 0.0248288593846995581},
      {120.75, 335158.569626190736, 4084650.59545867278, 368.905295895882979, 0.69544022491188804,
       -0.717405320457394471, -0.041140001870754973},
      {380.0, 335316.274655695767, 4084633.2257195769, 351.829896907216495, 0.312804885079886612,
       0.947461237048705125, -0.0668603631481033501},
      {490.0625, 335403.666140990831, 4084686.95207400976, 348.706864843008346,
       0.978988064930436362, 0.169667022784457637, 0.113117063713738834}};
  for (const auto& row : known) {
    const auto poses = read_alignment(alignment_named("UT-Alignment-Aplitop-1.xml"),
                                      {.station_from = row[0], .station_to = row[0]});
    REQUIRE(poses.size() == 1);
    for (int k = 0; k < 3; ++k) {
      check_near(poses[0].translation[k], row[1 + k], 1e-9);
      check_near(poses[0].rotation[3 * k], row[4 + k], 1e-10);
    }
  }
}

TEST_CASE("public alignments are read, or refused with the reason") {
  std::vector<Message> remarks;
  const auto twin =
      read_alignment(alignment_named("PR_Twin_Branch_section_alignment.xml"), {}, &remarks);
  check_equal(twin.size(), 8526);
  check_equal(codes_in(remarks), {"alignment-feet"});

  const auto first = alignment_named("UT-Alignment-Aplitop-1.xml");
  remarks.clear();
  const auto clothoids = read_alignment(first, {}, &remarks);
  check_equal(clothoids.size(), 5072);
  CHECK(codes_in(remarks).empty());
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
  check_equal(codes_in(remarks), {"profile-shorter"});
  check_near(road.front().translation[2], 125.687614, 1e-9);
  check_near(road.back().translation[2], 125.806, 1e-8);

  remarks.clear();
  const auto crossing = read_alignment(alignment_named("TOI-Y3-0000A.XML"), {.step = 1}, &remarks);
  check_equal(codes_in(remarks), {"profile-shorter"});
  check_equal(crossing.size(), 37);
  check_near(crossing.back().translation[2], 126.005283, 1e-9);
}
