// How many ignored points would collide, against brute force, whichever engine searches.
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/query/search_result.hpp"
#include "io/files/hdf5.hpp"
#include "io/store/store_reader.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/engines/brute_force.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Counts {
  std::uint64_t colliding = 0, high = 0;
};

/// Random points of five classes in a cube of two metres, and a model that turns on its way
/// through.
class Cloud {
 public:
  explicit Cloud(unsigned seed) : random_(seed) {
    const auto any = [this](double most) {
      return std::uniform_real_distribution<double>(-most, most)(random_);
    };
    std::vector<Quantum> points;
    for (int i = 0; i < 3000; ++i) {
      const auto number = [&] { return static_cast<std::int32_t>(any(1000)); };
      points.push_back({number(), number(), number()});
    }
    classes_ = random_classes(points.size(), 4);
    write_classed(folder / "cloud.las", points, classes_, 6, {0, 0, 0});
    convert({folder / "cloud.las"}, folder / "cloud.h5", {.cell_points = 64, .threads = 2});
    const StoreReader store(folder / "cloud.h5");
    for (const Quantum& q : points) {
      places_.push_back(position(store.quantisation(), q[0], q[1], q[2]));
    }
    for (int i = 0; i < 12; ++i)
      query.model.vertices.push_back({any(0.2), any(0.2), 0.4 + any(0.4)});
    for (int i = 0; i < 20; ++i) {
      const double turn = any(3.1), c = std::cos(turn), s = std::sin(turn);
      query.poses.push_back(
          {{c, -s, 0, s, c, 0, 0, 0, 1}, {-1 + 0.1 * i, any(0.2), any(0.3) - 0.4}});
    }
    query.radius = 0.08;
    query.ignore_classes = {1, 3};
    query.ignore_boxes = {{{-0.2, -0.2, -0.2}, {0.3, 0.2, 0.4}}};
  }

  bool is_ignored(std::size_t i) const {
    const Vec3& p = places_[i];
    const Box& box = query.ignore_boxes.front();
    bool in_box = true;
    for (int k = 0; k < 3; ++k) in_box = in_box && p[k] >= box.lo[k] && p[k] <= box.hi[k];
    return in_box || classes_[i] == 1 || classes_[i] == 3;
  }

  /// The expected counts: brute force over the ignored points, body by body.
  Counts by_hand() const {
    std::vector<Vec3> ignored;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (is_ignored(i)) ignored.push_back(places_[i]);
    }
    struct First {
      std::uint32_t pose = kNoPose;
      double z = 0;
    };
    std::vector<First> first(ignored.size());
    double lowest = std::numeric_limits<double>::max();
    const auto add = [&](const Query& body, const std::vector<std::uint32_t>& path_pose) {
      for (const Vec3& p : body.model.vertices) lowest = std::min(lowest, p.z);
      const auto poses = brute_force_first_poses(ignored, body);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        if (poses[i] == kNoPose) continue;
        const std::uint32_t pose = path_pose.empty() ? poses[i] : path_pose[poses[i]];
        if (pose >= first[i].pose) continue;  // at the same pose the first body counts
        first[i] = {pose, pulled_back(body.poses[poses[i]], ignored[i]).z};
      }
    };
    if (query.bodies.empty()) add(query, {});
    for (const Body& body : query.bodies) {
      add(Query(body.model, body.poses, query), body.path_pose);
    }
    Counts out;
    for (const First& of : first) {
      if (of.pose == kNoPose) continue;
      ++out.colliding;
      if (of.z - lowest > 0.5) ++out.high;
    }
    return out;
  }

  SearchReport run(const std::string& name, SearchOptions options = {}) const {
    options.threads = options.threads == 0 ? 2 : options.threads;
    options.device = Device::kCpu;
    return search(Store(folder / "cloud.h5"), query, folder / name, options);
  }

  void check(const Answer& answer, const Counts& expected) const {
    CHECK(answer.ignored_colliding == expected.colliding);
    CHECK(answer.ignored_colliding_high == expected.high);
  }

  /// Expects the class of each point of a table; `none` stands for the rows without a point.
  template <typename Rows>
  void check_classes(const Rows& rows, std::uint64_t none = ~std::uint64_t{0}) const {
    std::vector<std::uint8_t> expected;
    for (const std::uint64_t source : rows.source) {
      expected.push_back(source == none ? std::uint8_t{0} : classes_[source]);
    }
    CHECK(expected.size() > 10);
    CHECK(rows.point_class == expected);
  }

  ScratchFolder folder;
  Query query;

 private:
  std::mt19937_64 random_;
  std::vector<std::uint8_t> classes_;
  std::vector<Vec3> places_;
};

void become_surface(Cloud& cloud, bool solid) {
  const Surface body = tetrahedron({-0.4, -0.3, 0}, {0.4, -0.3, 0}, {0, 0.4, 0}, {0, 0, 0.9});
  cloud.query.model = body.vertices;
  cloud.query.model.triangles = body.triangles;
  if (solid) cloud.query.model.solid_of.assign(body.triangles.size(), 0);
}

}  // namespace

TEST_CASE("ignored points that would collide are counted as brute force counts them") {
  const unsigned seed = GENERATE(1U, 2U, 3U);
  Cloud cloud(seed);
  SECTION("points") {}
  SECTION("points with distances") { cloud.query.clearance = cloud.query.profile = 0.2; }
  SECTION("points between poses") { cloud.query.between_poses = true; }
  SECTION("a surface") { become_surface(cloud, false); }
  SECTION("a solid") { become_surface(cloud, true); }
  const Counts expected = cloud.by_hand();
  CHECK(expected.colliding > 20);
  CHECK(expected.high > 0);
  CHECK(expected.high < expected.colliding);
  const SearchReport report = cloud.run("out.h5");
  cloud.check(report, expected);
  cloud.check(Result(cloud.folder / "out.h5").answer(), expected);
}

TEST_CASE("ignored points that would collide are counted for all bodies of a vehicle") {
  Cloud cloud(4);
  Query& query = cloud.query;
  Body low, high;
  low.name = "low";
  low.model = {{0, 0, 0}, {0.1, 0, 0.1}};
  high.name = "high";
  high.model = {{0, 0, 0.7}, {-0.1, 0.1, 0.6}};
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    low.poses.push_back(query.poses[i]);
    low.path_pose.push_back(i);
    if (i % 2 == 0) continue;
    high.poses.push_back(query.poses[i]);
    high.path_pose.push_back(i);
  }
  query.bodies = {low, high};
  query.model.vertices.clear();
  const Counts expected = cloud.by_hand();
  CHECK(expected.high > 0);
  CHECK(expected.high < expected.colliding);
  cloud.check(cloud.run("out.h5"), expected);
}

TEST_CASE("the count of ignored points that would collide depends on the question alone") {
  Cloud cloud(5);
  const Counts expected = cloud.by_hand();
  SECTION("not on the engine and its options") {
    for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
      cloud.check(cloud.run("out.h5", {.engine = engine, .threads = 1, .overwrite = true}),
                  expected);
    }
  }
  SECTION("not on whether the result was there already") {
    cloud.run("out.h5");
    const SearchReport again = cloud.run("out.h5", {.resume = true});
    CHECK(again.was_finished);
    cloud.check(again, expected);
  }
  SECTION("not on parts") {
    cloud.run("whole.h5");
    std::vector<std::filesystem::path> parts;
    std::uint64_t sum = 0;
    for (std::uint32_t number = 1; number <= 3; ++number) {
      parts.push_back(cloud.folder / ("part" + std::to_string(number) + ".h5"));
      const SearchReport part =
          cloud.run(parts.back().filename().string(), {.shard = Shard{number, 3}});
      sum += part.ignored_colliding;
    }
    CHECK(sum == expected.colliding);
    cloud.check(merge(parts, cloud.folder / "merged.h5"), expected);
    CHECK(bytes_of(cloud.folder / "merged.h5") == bytes_of(cloud.folder / "whole.h5"));
    cloud.check(merge(parts, cloud.folder / "merged.h5", {.resume = true}), expected);
  }
}

TEST_CASE("what stops a search while it counts ignored points leaves nothing behind") {
  Cloud cloud(6);
  std::atomic<bool> stop = false;
  SearchOptions options;
  options.stop = &stop;
  options.progress = [&](const ProgressUpdate& update) {
    if (update.stage == "ignored") stop = true;
  };
  CHECK_THROWS_AS(cloud.run("out.h5", options), Interrupted);
  CHECK_FALSE(std::filesystem::exists(cloud.folder / "out.h5"));
  cloud.check(cloud.run("out.h5", {.resume = true}), cloud.by_hand());
}

TEST_CASE("a query that ignores nothing has no ignored points that collide") {
  Cloud cloud(7);
  cloud.query.ignore_classes.clear();
  cloud.query.ignore_boxes.clear();
  cloud.check(cloud.run("out.h5"), {});
  cloud.query.ignore_classes = {9};  // a class that no point has
  cloud.check(cloud.run("none.h5"), {});
}

TEST_CASE("each table has the class of its points, whatever searched and in however many parts") {
  Cloud cloud(9);
  cloud.query.ignore_classes.clear();
  cloud.query.ignore_boxes.clear();
  cloud.query.first_pose = true;
  cloud.query.clearance = cloud.query.profile = 0.1;
  cloud.query.error_scan = 0.004;
  const SearchReport report = cloud.run("whole.h5");
  const Result result(cloud.folder / "whole.h5");
  const Collisions collisions = result.collisions();
  cloud.check_classes(collisions);
  cloud.check_classes(result.near());
  cloud.check_classes(result.clearance());
  cloud.check_classes(result.profile(), Profile::kNoPoint);

  std::map<std::uint8_t, std::uint64_t> counts;
  for (const std::uint8_t value : collisions.point_class) ++counts[value];
  for (const std::uint8_t value : result.near().point_class) ++counts[value];
  CHECK(counts.size() == 5);
  const auto check = [&](const Answer& answer) {
    CHECK(answer.classes == counts);
    CHECK(answer.least_clearance->point_class == report.least_clearance->point_class);
    CHECK(answer.least_profile->point_class == report.least_profile->point_class);
    CHECK(answer.first_place->point_class == report.first_place->point_class);
  };
  REQUIRE(report.least_profile->point_class);
  check(report);
  check(result.answer());
  check(cloud.run("whole.h5", {.resume = true}));

  std::vector<std::filesystem::path> parts;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    parts.push_back(cloud.folder / ("part" + std::to_string(number) + ".h5"));
    cloud.run(parts.back().filename().string(), {.shard = Shard{number, 3}});
  }
  check(merge(parts, cloud.folder / "merged.h5"));
  CHECK(bytes_of(cloud.folder / "merged.h5") == bytes_of(cloud.folder / "whole.h5"));

  const Session session(cloud.folder / "cloud.h5");
  const SessionAnswer answer = session.search(cloud.query);
  CHECK(answer.collisions().point_class == collisions.point_class);
  check(answer);
}

TEST_CASE("a vehicle with a floor may touch the ground that is ignored, but nothing above it") {
  const auto codes_of = [](const SearchReport& report) {
    std::string codes;
    for (const Message& warning : report.warnings) codes += warning.code + " ";
    return codes;
  };
  Cloud cloud(8);
  const SearchReport plain = cloud.run("a.h5");
  CHECK(plain.ignored_colliding > plain.colliding_points);
  CHECK_THAT(codes_of(plain), Contains("ignored-collide") && Contains("ignored-high"));
  cloud.query.floor = -1e3;  // below everything
  const SearchReport above = cloud.run("b.h5");
  CHECK_THAT(codes_of(above), !Contains("ignored-collide") && Contains("ignored-high"));
  CHECK(Result(cloud.folder / "a.h5").source() == Result(cloud.folder / "b.h5").source());
}

TEST_CASE("strict searches refuse no warning that only the search itself can give") {
  Cloud cloud(8);
  std::size_t others = 0;
  for (const Message& warning : cloud.run("out.h5").warnings) {
    if (!warning.code.starts_with("ignored-")) ++others;
  }
  if (others == 0) {
    CHECK_NOTHROW(cloud.run("strict.h5", {.strict = true}));
  } else {
    CHECK_THROWS_WITH(cloud.run("strict.h5", {.strict = true}),
                      Contains("strict: " + std::to_string(others)) && !Contains("ignored-"));
  }
}
