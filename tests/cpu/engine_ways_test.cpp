// First poses between poses: every engine and brute force against definitions of their own.
#include <algorithm>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/exact_way.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint32_t kNeverOnWay = kNoPose;

/// The first pose of a point e by the definition of version 0.1.0: the least pose that touches e,
/// or from which a segment starts whose inside touches e. at_pose: whether the pose itself touches
/// e.
struct Earlier {
  std::uint32_t pose = kNeverOnWay;
  bool at_pose = false;

  Earlier(const Vec3& e, const Query& query) {
    for (std::uint32_t i = 0; i < query.poses.size() && pose == kNeverOnWay; ++i) {
      for (const Vec3& m : query.model.vertices) {
        const Vec3 a = transform(query.poses[i], m);
        at_pose |= collides(e, a, query.radius);
        const bool inside = i + 1 < query.poses.size() &&
                            collides_inside(e, a, transform(query.poses[i + 1], m), query.radius);
        if (at_pose || inside) pose = i;
      }
    }
  }
};

}  // namespace

TEST_CASE("ways with and without their ends touch the same points, one pose apart at most") {
  Random random(17);
  const Box room{{-4, -3, -1}, {5, 4, 2}};
  const Quantisation millimetre{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  const auto points = quantise(random_points(random, room, 2000), millimetre);
  const auto positions = positions_of(points, millimetre);
  const auto model = random_points(random, {{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}}, 40);
  for (const std::size_t poses : {2, 10, 150}) {  // steps far above the radii, to below them
    std::uint64_t wrong = 0, lower = 0, equal = 0;
    for (const double radius : {0.02, 0.1, 0.6}) {
      const Query query{model, smooth_path(random, room, poses), {radius}};
      const auto found = check_between_poses(points, millimetre, query);
      for (std::size_t i = 0; i < found.size(); ++i) {
        const Earlier earlier(positions[i], query);
        const bool leads_there = earlier.at_pose && earlier.pose > 0;
        wrong += found[i] != (leads_there ? earlier.pose - 1 : earlier.pose);
        lower += leads_there;
        equal += !leads_there && earlier.pose != kNeverOnWay;
      }
    }
    CAPTURE(poses);
    check_equal(wrong, 0);
    CHECK(lower > 0);
    CHECK(equal > 10);
  }
}

namespace {

/// A pose of whole numbers: a place, and a quarter turn about an axis or none.
struct WholePose {
  std::int64_t turn[9];
  WholePoint place;

  static WholePose random(Random& random, std::int64_t size) {
    constexpr std::int64_t kTurns[4][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                           {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                           {0, 0, 1, 0, 1, 0, -1, 0, 0},
                                           {1, 0, 0, 0, 0, 1, 0, -1, 0}};
    WholePose pose{};
    std::copy_n(kTurns[below(random, 4)], 9, pose.turn);
    pose.place = whole(random, size);
    return pose;
  }

  static WholePoint whole(Random& random, std::int64_t size) {
    const auto coordinate = [&] {
      return static_cast<std::int64_t>(below(random, static_cast<std::uint64_t>(2 * size + 1))) -
             size;
    };
    return {coordinate(), coordinate(), coordinate()};
  }

  WholePoint moved(const WholePoint& m) const {
    return {turn[0] * m.x + turn[1] * m.y + turn[2] * m.z + place.x,
            turn[3] * m.x + turn[4] * m.y + turn[5] * m.z + place.y,
            turn[6] * m.x + turn[7] * m.y + turn[8] * m.z + place.z};
  }

  Pose as_pose() const {
    Pose pose{};
    for (int k = 0; k < 9; ++k) pose.rotation[k] = static_cast<double>(turn[k]);
    const Vec3 p = place.as_double();
    for (int k = 0; k < 3; ++k) pose.translation[k] = p[k];
    return pose;
  }
};

struct WholeScene {
  std::vector<WholePoint> environment, model;
  std::vector<WholePose> poses;
  std::int64_t quarters;  ///< the radius in quarters of a unit

  explicit WholeScene(Random& random) : quarters(static_cast<std::int64_t>(1 + below(random, 20))) {
    for (int i = 0; i < 300; ++i) environment.push_back(WholePose::whole(random, 13));
    const std::uint64_t model_points = 1 + below(random, 6), steps = below(random, 12);
    for (std::uint64_t i = 0; i < model_points; ++i) model.push_back(WholePose::whole(random, 2));
    poses.push_back(WholePose::random(random, 10));
    for (std::uint64_t i = 0; i < steps; ++i) add_step(random);
  }

  /// Adds a stop, a short step or a jump.
  void add_step(Random& random) {
    WholePose next = poses.back();
    const std::uint64_t kind = below(random, 4);
    if (kind == 1 || kind == 2) {
      const WholePoint step = WholePose::whole(random, 1);
      next.place = {next.place.x + step.x, next.place.y + step.y, next.place.z + step.z};
    } else if (kind == 3) {
      next = WholePose::random(random, 10);
    }
    poses.push_back(next);
  }

  Query query() const {
    Query out;
    for (const WholePoint& m : model) out.model.vertices.push_back(m.as_double());
    for (const WholePose& pose : poses) out.poses.push_back(pose.as_pose());
    out.radius = static_cast<double>(quarters) / 4;
    return out;
  }

  /// The first way whose closed segments come nearer to e than the radius. undecided: set where
  /// double may round a tie with the radius on one of the ways up to there.
  std::uint32_t first_way(const WholePoint& e, bool& undecided) const {
    const std::size_t ways = poses.size() == 1 ? 1 : poses.size() - 1;
    for (std::size_t i = 0; i < ways; ++i) {
      const WholePose& next = poses[std::min(i + 1, poses.size() - 1)];
      for (const WholePoint& m : model) {
        const ExactWay way(e, poses[i].moved(m), next.moved(m));
        undecided = undecided || way.is_rounded_tie(quarters);
        if (way.is_within(quarters)) return static_cast<std::uint32_t>(i);
      }
    }
    return kNeverOnWay;
  }
};

}  // namespace

TEST_CASE("first poses are those of whole numbers' arithmetic") {
  Random random(41);
  int wrong = 0, hits = 0, decided = 0;
  for (int scenes = 0; scenes < 60; ++scenes) {
    const WholeScene scene(random);
    std::vector<Quantum> points;
    for (const WholePoint& e : scene.environment) {
      points.push_back({static_cast<std::int32_t>(e.x), static_cast<std::int32_t>(e.y),
                        static_cast<std::int32_t>(e.z)});
    }
    const auto found = check_between_poses(points, {{1, 1, 1}, {0, 0, 0}}, scene.query());
    for (std::size_t i = 0; i < found.size(); ++i) {
      bool undecided = false;
      const std::uint32_t exact = scene.first_way(scene.environment[i], undecided);
      if (undecided) continue;
      ++decided;
      wrong += found[i] != exact;
      hits += exact != kNeverOnWay;
    }
  }
  check_equal(wrong, 0);
  CHECK(hits > 1000);
  CHECK(decided > 17'000);
}
