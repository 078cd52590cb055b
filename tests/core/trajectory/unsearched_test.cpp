#include "clearway/unsearched.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "clearway/follow.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/paths.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A body that has the poses [from, to) of the path.
Body there(std::uint32_t from, std::uint32_t to) {
  Body body{.name = "body", .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}};
  for (std::uint32_t i = from; i < to; ++i) body.path_pose.push_back(i);
  body.poses.resize(body.path_pose.size());
  return body;
}

/// Stretches and lengths in one text: poses, metres, the bodies that are not there, and whether
/// others are.
std::string unsearched(const std::vector<Pose>& path, const std::vector<Body>& bodies) {
  std::ostringstream out;
  for (const auto& stretch : unsearched_stretches(path, bodies)) {
    out << stretch.first_pose << "-" << stretch.last_pose << " at " << stretch.chainage_from
        << " to " << stretch.chainage_to << " m without";
    for (const std::uint32_t body : stretch.bodies) out << " " << body;
    out << (stretch.has_answer ? ", in part; " : "; ");
  }
  const SearchedLength length = searched_length(path, bodies);
  out << length.whole << " and " << length.part << " of " << length.path << " m";
  return out.str();
}

}  // namespace

TEST_CASE("a stretch without a body reaches up to the poses that the body has") {
  const auto path = straight_poses(11, 0.5);
  check_equal(unsearched(path, {there(2, 8)}),
              "0-1 at 0 to 1 m without 0; 8-10 at 3.5 to 5 m without 0; 2.5 and 0 of 5 m");
  // Where other bodies are searched there is an answer of a part.
  Body holes = there(0, 11);
  holes.path_pose.erase(holes.path_pose.begin() + 5);
  holes.poses.pop_back();
  check_equal(unsearched(path, {there(2, 11), there(3, 11), holes}),
              "0-2 at 0 to 1 m without 0 1, in part; 2-2 at 1 to 1.5 m without 1, in part; 5-5 "
              "at 2 to 3 m without 2, in part; 2.5 and 2.5 of 5 m");
  // Nothing is unsearched of a model, nor of bodies with all poses.
  check_equal(unsearched(path, {}), "5 and 0 of 5 m");
  check_equal(unsearched(path, {there(0, 11)}), "5 and 0 of 5 m");
  check_equal(unsearched({}, {}), "0 and 0 of 0 m");
}

TEST_CASE("a body that leaves the path at its ends is a note, one that lacks poses inside is not") {
  const auto poses = straight_poses(21, 0.5);
  const PathStations path(poses, 1);
  const BodyMount mount = BodyPivots{1, -1};
  FollowedPath followed = follow_path(path, mount, 1);
  auto doubts = doubts_about(followed, path, mount, "wagon");
  check_equal(codes_of(doubts), "note body-off-path");
  check_says(doubts.at(0).text, "wagon: 4 of 21 poses of the path (poses 0-1, 19-20, from 0)");
  check_equal(doubts[0].numbers[0].second, 4);
  followed.off_path.insert(followed.off_path.begin() + 2, 10);
  doubts = doubts_about(followed, path, mount, "wagon");
  check_equal(codes_of(doubts), "body-off-path");
}

TEST_CASE("the lengths of a path that three bodies share stay within it, whatever is rounded") {
  std::vector<Pose> path = straight_poses(12, 0.5);
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
