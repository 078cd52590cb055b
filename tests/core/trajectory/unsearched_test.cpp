#include "clearway/unsearched.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "clearway/follow.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Pose> straight(std::size_t count) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.5 * static_cast<double>(i), 0, 0}});
  }
  return poses;
}

/// A body that has the poses [from, to) of the path.
Body there(std::uint32_t from, std::uint32_t to) {
  Body body{.name = "body", .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}};
  for (std::uint32_t i = from; i < to; ++i) body.path_pose.push_back(i);
  body.poses.resize(body.path_pose.size());
  return body;
}

using Numbers = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("a body without a pose leaves a stretch up to the poses that it has") {
  const auto path = straight(11);
  const auto stretches = unsearched_stretches(path, std::vector<Body>{there(2, 8)});
  REQUIRE(stretches.size() == 2);
  check_equal(stretches[0].first_pose, 0);
  check_equal(stretches[0].last_pose, 1);
  check_equal(stretches[0].chainage_from, 0);
  check_equal(stretches[0].chainage_to, 1);
  CHECK_FALSE(stretches[0].has_answer);
  CHECK(stretches[0].bodies == Numbers{0});
  check_equal(stretches[1].first_pose, 8);
  check_equal(stretches[1].last_pose, 10);
  check_equal(stretches[1].chainage_from, 3.5);
  const SearchedLength length = searched_length(path, std::vector<Body>{there(2, 8)});
  check_equal(length.path, 5);
  check_equal(length.whole, 2.5);
  check_equal(length.part, 0);
}

TEST_CASE("where other bodies are searched there is an answer of a part") {
  const auto path = straight(11);
  Body holes = there(0, 11);
  holes.path_pose.erase(holes.path_pose.begin() + 5);
  holes.poses.pop_back();
  const std::vector<Body> bodies{there(2, 11), there(3, 11), holes};
  const auto stretches = unsearched_stretches(path, bodies);
  REQUIRE(stretches.size() == 3);
  CHECK(stretches[0].bodies == Numbers{0, 1});
  CHECK(stretches[0].has_answer);
  CHECK(stretches[1].bodies == Numbers{1});
  check_equal(stretches[1].first_pose, 2);
  check_equal(stretches[1].last_pose, 2);
  CHECK(stretches[2].bodies == Numbers{2});
  check_equal(stretches[2].first_pose, 5);
  check_equal(stretches[2].last_pose, 5);
  const SearchedLength length = searched_length(path, bodies);
  check_equal(length.whole, 2.5);
  check_equal(length.part, 2.5);
}

TEST_CASE("nothing is unsearched of a model, nor of bodies with all poses") {
  const auto path = straight(5);
  CHECK(unsearched_stretches(path, {}).empty());
  CHECK(unsearched_stretches(path, std::vector<Body>{there(0, 5)}).empty());
  check_equal(searched_length(path, {}).whole, 2);
  check_equal(searched_length({}, {}).path, 0);
  CHECK(unsearched_stretches({}, {}).empty());
}

TEST_CASE("a body that leaves the path at its ends is a note, one that lacks poses inside is not") {
  const auto poses = straight(21);
  const PathStations path(poses, 1);
  const BodyMount mount = BodyPivots{1, -1};
  FollowedPath followed = follow_path(path, mount, 1);
  auto doubts = doubts_about(followed, path, mount, "wagon");
  REQUIRE(doubts.size() == 1);
  check_equal(doubts[0].code, "body-off-path");
  CHECK(doubts[0].severity == Message::Severity::kNote);
  followed.off_path.insert(followed.off_path.begin() + 2, 10);
  doubts = doubts_about(followed, path, mount, "wagon");
  CHECK(doubts[0].severity == Message::Severity::kWarning);
}

TEST_CASE("the lengths of a path that three bodies share stay within it, whatever is rounded") {
  std::vector<Pose> path = straight(12);
  for (int scene = 1; scene <= 50; ++scene) {
    for (std::size_t i = 0; i < path.size(); ++i) {
      path[i].translation[0] = 0.1 * scene * std::sqrt(static_cast<double>(i + i * i));
    }
    for (std::uint32_t a = 1; a < 10; ++a) {
      for (std::uint32_t b = a + 1; b < 11; ++b) {
        const std::vector<Body> bodies{there(0, a), there(a, b), there(b, 12)};
        const SearchedLength length = searched_length(path, bodies);
        CHECK(length.whole >= 0);  // each body is missing somewhere, so this is 0 but for rounding
        CHECK(length.whole < 1e-12 * length.path);
        CHECK(length.part <= length.path);
      }
    }
  }
}

namespace {

std::vector<PoseRange> random_ranges(Random& random) {
  std::vector<PoseRange> out(random() % 6);
  for (PoseRange& range : out) {
    range.first = static_cast<std::uint32_t>(random() % 21);
    range.last = range.first + static_cast<std::uint32_t>(random() % 7);
  }
  return out;
}

std::set<std::uint32_t> poses_of(const std::vector<PoseRange>& ranges) {
  std::set<std::uint32_t> out;
  for (const PoseRange& range : ranges) {
    for (std::uint32_t pose = range.first; pose <= range.last; ++pose) out.insert(pose);
  }
  return out;
}

}  // namespace

TEST_CASE("stretches of poses are united and taken away as sets of poses are") {
  Random random(1);
  bool united_well = true, taken_well = true;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::vector<PoseRange> a = random_ranges(random), b = random_ranges(random);
    const std::vector<PoseRange> one = united_ranges(a);
    const bool apart = std::ranges::adjacent_find(one, [](const auto& x, const auto& y) {
                         return y.first <= x.last;
                       }) == one.end();
    united_well &= apart && poses_of(one) == poses_of(a);
    std::set<std::uint32_t> rest = poses_of(a);
    for (const std::uint32_t pose : poses_of(b)) rest.erase(pose);
    taken_well &= poses_of(without(a, b)) == rest;
  }
  CHECK(united_well);
  CHECK(taken_well);
}
