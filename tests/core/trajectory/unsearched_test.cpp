#include "clearway/unsearched.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "clearway/follow.hpp"
#include "core/trajectory/follow/follow_path.hpp"

using namespace clearway;

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
  CHECK(stretches[0].first_pose == 0);
  CHECK(stretches[0].last_pose == 1);
  CHECK(stretches[0].chainage_from == 0);
  CHECK(stretches[0].chainage_to == 1);
  CHECK_FALSE(stretches[0].has_answer);
  CHECK(stretches[0].bodies == Numbers{0});
  CHECK(stretches[1].first_pose == 8);
  CHECK(stretches[1].last_pose == 10);
  CHECK(stretches[1].chainage_from == 3.5);
  const SearchedLength length = searched_length(path, std::vector<Body>{there(2, 8)});
  CHECK(length.path == 5);
  CHECK(length.whole == 2.5);
  CHECK(length.part == 0);
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
  CHECK(stretches[1].first_pose == 2);
  CHECK(stretches[1].last_pose == 2);
  CHECK(stretches[2].bodies == Numbers{2});
  CHECK(stretches[2].first_pose == 5);
  CHECK(stretches[2].last_pose == 5);
  const SearchedLength length = searched_length(path, bodies);
  CHECK(length.whole == 2.5);
  CHECK(length.part == 2.5);
}

TEST_CASE("nothing is unsearched of a model, nor of bodies with all poses") {
  const auto path = straight(5);
  CHECK(unsearched_stretches(path, {}).empty());
  CHECK(unsearched_stretches(path, std::vector<Body>{there(0, 5)}).empty());
  CHECK(searched_length(path, {}).whole == 2);
  CHECK(searched_length({}, {}).path == 0);
  CHECK(unsearched_stretches({}, {}).empty());
}

TEST_CASE("a body that leaves the path at its ends is a note, one that lacks poses inside is not") {
  const auto poses = straight(21);
  const PathStations path(poses, 1);
  const BodyMount mount = BodyPivots{1, -1};
  FollowedPath followed = follow_path(path, mount, 1);
  auto doubts = doubts_about(followed, path, mount, "wagon");
  REQUIRE(doubts.size() == 1);
  CHECK(doubts[0].code == "body-off-path");
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
