#include "clearway/trajectory.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Pose> written_and_read(const ScratchFolder& folder, const std::vector<Pose>& poses) {
  const auto path = folder / "path.txt";
  NoProgress progress;
  write_trajectory(poses, File::create(path), progress);
  return read_trajectory(path, {TrajectoryFormat::kMatrix, true});
}

}  // namespace

TEST_CASE("a written trajectory reads back to the same numbers") {
  const ScratchFolder folder;
  Random random(41);
  std::vector<Pose> poses{translation({5e-324, -1e300, 0.1}), translation({-0.0, 5e6 + 1e-9, 1})};
  for (int i = 0; i < 500; ++i) {
    poses.push_back(random_rotation(random, random_point(random, {{-5e6, -1, 0}, {5e6, 1, 1e-9}})));
  }
  CHECK(written_and_read(folder, poses) == poses);
  CHECK(written_and_read(folder, {}).empty());
}

TEST_CASE("what puts a path in doubt is kept by the paths that are made of it") {
  const ScratchFolder folder;
  const auto path = folder / "path.txt";
  const std::vector<Pose> poses{translation({1, 2, 3}), translation({4, 5, 6})};
  constexpr auto kWarning = Message::Severity::kWarning;
  const std::vector<Message> of_given{{kWarning, "time-order", "a.csv: odd"},
                                      {kWarning, "quaternion-order", "a.csv: tilts,\nmuch"}};
  NoProgress progress;
  for (const bool is_table : {false, true}) {
    if (is_table) {
      write_trajectory_table(poses, {.station = {0, 1}}, {.remarks = of_given}, File::create(path),
                             progress);
    } else {
      write_trajectory(poses, File::create(path), progress, "thin of a.csv", of_given);
    }
    std::vector<Message> remarks;
    CHECK((read_trajectory(path, {}, &remarks) == poses));
    REQUIRE(remarks.size() == 1);
    CHECK(remarks[0].severity == kWarning);
    check_equal(remarks[0].code, "quaternion-order");
    check_equal(remarks[0].text, "a.csv: tilts, much");
  }
}
