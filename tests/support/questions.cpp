#include "support/questions.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/geometry/inside.hpp"
#include "core/geometry/predicate.hpp"
#include "core/query/search_result.hpp"
#include "core/trajectory/chainage.hpp"
#include "search/check_query.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/engines/brute_force.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Box kRoom{{100, -200, 0}, {104, -197, 1}};

std::uint32_t on_path(const MovingBody& body, std::uint32_t pose) {
  return body.path_pose.empty() ? pose : body.path_pose[pose];
}

/// Whether nothing of a body is above its floor, which searches refuse.
bool is_below_floor(const MovingBody& body) {
  return body.floor && std::ranges::all_of(body.model.vertices,
                                           [&](const Vec3& p) { return p.z <= *body.floor; });
}

/// What a body is asked by itself.
Query alone(const Query& query, const MovingBody& body, double radius) {
  Query one(body.model, {body.poses.begin(), body.poses.end()}, query);
  one.radius = radius;
  one.floor = body.floor;
  raise_floors(one, query.radius - radius);
  return one;
}

/// The last pose of the path at which each place is touched.
std::vector<std::uint32_t> last_touches(std::span<const Vec3> places, const Query& query) {
  std::vector<std::uint32_t> out(places.size(), 0);
  for (const MovingBody& body : moving_bodies(query)) {
    Query one = alone(query, body, query.radius);
    const std::size_t more = query.between_poses && body.poses.size() > 1 ? 1 : 0;
    for (std::uint32_t i = 0; i + more < body.poses.size(); ++i) {
      one.poses.assign(body.poses.begin() + i, body.poses.begin() + i + 1 + more);
      const auto touched = brute_force_first_poses(places, one);
      for (std::size_t e = 0; e < places.size(); ++e) {
        if (touched[e] != kNoPose) out[e] = std::max(out[e], on_path(body, i));
      }
    }
  }
  return out;
}

/// The least squared distance to a place, below 0 inside a solid, and where it is first found.
struct Least {
  double squared = kInfinity;
  FirstTouch first;
  auto operator<=>(const Least&) const = default;
};

std::vector<Least> least_distances(std::span<const Vec3> places, const Query& query,
                                   double radius) {
  std::vector<Least> out(places.size());
  std::uint32_t number = 0;
  for (const MovingBody& body : moving_bodies(query)) {
    const auto found = brute_force_clearances(places, alone(query, body, radius));
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i].found()) continue;  // it is below the floor at all poses
      out[i] = std::min(out[i], {found[i].squared, {on_path(body, found[i].pose), number}});
    }
    ++number;
  }
  return out;
}

/// Which of the places are certainly too close.
std::vector<bool> certain_of(std::span<const Vec3> places, const Query& query, double radius) {
  std::vector<bool> out(places.size(), !(radius < query.radius));
  if (radius > 0 && radius < query.radius) {
    const auto touches = first_touches(places, query, radius);
    for (std::size_t i = 0; i < places.size(); ++i) out[i] = touches[i].pose != kNoPose;
  } else if (radius <= 0 && has_solids(query)) {
    Query raised = query;
    raise_floors(raised, query.radius - radius);
    const auto least = least_distances(places, raised, query.radius);
    for (std::size_t i = 0; i < places.size(); ++i) {
      out[i] = least[i].squared < -(radius * radius);
    }
  }
  return out;
}

/// Points of a scan that are searched, or that are not.
struct Points {
  std::vector<Vec3> places;
  std::vector<std::uint64_t> source;

  void add(const Vec3& place, std::uint64_t number) {
    places.push_back(place);
    source.push_back(number);
  }
};

/// The table of the query's profile.
ProfileRows profile_of(const Points& points, const Query& query) {
  ProfileRows rows;
  std::vector<NearestPoint> least(query.poses.size(), {kInfinity, Profile::kNoPoint});
  rows.distance.assign(least.size(), std::nan(""));
  for (const MovingBody& body : moving_bodies(query)) {
    const auto found = brute_force_profile(points.places, alone(query, body, query.radius));
    for (std::uint32_t k = 0; k < found.size(); ++k) {
      const std::uint32_t pose = on_path(body, k);
      rows.distance[pose] = 0;  // a body is there
      if (std::pair(found[k].squared, found[k].source) <
          std::pair(least[pose].squared, least[pose].source)) {
        least[pose] = found[k];
      }
    }
  }
  rows.chainage = chainage_of(query.poses);
  for (std::size_t i = 0; i < least.size(); ++i) {
    const bool found = std::isfinite(least[i].squared);
    if (rows.distance[i] == 0) rows.distance[i] = signed_root(least[i].squared);
    rows.source.push_back(found ? points.source[least[i].source] : Profile::kNoPoint);
    const double none = std::nan("");
    rows.xyz.push_back(found ? points.places[least[i].source] : Vec3{none, none, none});
  }
  return rows;
}

/// Adds the nearest free point to each row.
void add_depths(const std::vector<Vec3>& places, const std::vector<bool>& is_free,
                Collisions& rows) {
  for (const Vec3& at : rows.xyz) {
    double least = kInfinity;
    std::uint64_t source = Collisions::kNoPoint;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double squared = squared_distance(places[i], at);
      if (!is_free[i] || !(squared < least)) continue;
      least = squared;
      source = i;
    }
    rows.depth.push_back(source == Collisions::kNoPoint ? std::nan("") : std::sqrt(least));
    rows.depth_source.push_back(source);
  }
}

/// Counts what the tables hold, and takes the places that matter most, the first of equal ones.
void summarise_plainly(Truth& truth) {
  Answer& answer = truth.answer;
  const auto class_at = [](const auto& rows, std::size_t i) {
    return rows.point_class.empty() ? std::nullopt : std::optional(rows.point_class[i]);
  };
  const Collisions& rows = truth.collisions;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows.first_pose.empty() &&
        (!answer.first_place || rows.first_pose[i] < answer.first_place->pose)) {
      answer.first_place = {rows.source[i],
                            rows.first_pose[i],
                            rows.xyz[i],
                            0,
                            rows.body.empty() ? 0 : rows.body[i],
                            class_at(rows, i)};
    }
    if (!rows.depth.empty() && rows.depth[i] > (answer.deepest ? answer.deepest->depth : -1)) {
      answer.deepest = {rows.depth[i], rows.source[i], rows.xyz[i], rows.depth_source[i]};
    }
    if (!rows.certain.empty()) answer.certain.points += rows.certain[i];
  }
  const Clearances& near = truth.clearances;
  for (std::size_t i = 0; i < near.size(); ++i) {
    answer.inside_points += near.distance[i] < 0 ? 1 : 0;
    if (answer.least_clearance && near.distance[i] >= answer.least_clearance->distance) continue;
    answer.least_clearance = {near.source[i],
                              near.pose[i],
                              near.xyz[i],
                              near.distance[i],
                              near.body.empty() ? 0 : near.body[i],
                              class_at(near, i)};
  }
  const Profile& profile = truth.profile;
  for (std::uint32_t i = 0; i < profile.size(); ++i) {
    if (profile.source[i] == Profile::kNoPoint) continue;
    ++answer.profile_poses;
    if (answer.least_profile && profile.distance[i] >= answer.least_profile->distance) continue;
    answer.least_profile = {profile.source[i],   i, profile.xyz[i],
                            profile.distance[i], 0, class_at(profile, i)};
  }
  answer.colliding_points = rows.size();
  answer.near_points = truth.near.size();
  answer.clearance_points = near.size();
  for (const std::uint8_t value : rows.point_class) ++answer.classes[value];
  for (const std::uint8_t value : truth.near.point_class) ++answer.classes[value];
}

/// Checks each column, where NaN equals NaN.
template <typename Rows>
void check_rows(const Rows& found, const Rows& expected) {
  for_each_column<Rows>([&](const auto& column) {
    const auto &a = found.*column.values, &b = expected.*column.values;
    INFO(Table<Rows>::kGroup << "/" << column.dataset);
    REQUIRE(a.size() == b.size());
    const auto differs = [&](std::size_t i) {
      return !(a[i] == b[i]) && std::memcmp(&a[i], &b[i], sizeof(a[i])) != 0;
    };
    std::size_t row = 0;
    while (row < a.size() && !differs(row)) ++row;
    INFO("row " << row << " of " << a.size());
    CHECK(row == a.size());
  });
}

}  // namespace

std::vector<FirstTouch> first_touches(std::span<const Vec3> places, const Query& query,
                                      double radius) {
  std::vector<FirstTouch> out(places.size());
  std::uint32_t number = 0;
  for (const MovingBody& body : moving_bodies(query)) {
    const auto poses = brute_force_first_poses(places, alone(query, body, radius));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i] != kNoPose) out[i] = std::min(out[i], {on_path(body, poses[i]), number});
    }
    ++number;
  }
  return out;
}

void check_tables(const Truth& truth, const Collisions& collisions, const Nearby& near,
                  const Clearances& clearances, const Profile& profile) {
  check_rows(collisions, truth.collisions);
  check_rows(near, truth.near);
  check_rows(clearances, truth.clearances);
  check_rows({profile, {}}, truth.profile);
}

void check_answer(const Truth& truth, const Answer& answer) {
  const Answer& expected = truth.answer;
  CHECK(answer.environment_points == expected.environment_points);
  CHECK(answer.model_points == expected.model_points);
  CHECK(answer.model_solids == expected.model_solids);
  CHECK(answer.poses == expected.poses);
  CHECK(answer.bodies == expected.bodies);
  if (expected.searched) CHECK(answer.searched == expected.searched);
  CHECK(answer.colliding_points == expected.colliding_points);
  CHECK(answer.near_points == expected.near_points);
  CHECK(answer.clearance_points == expected.clearance_points);
  CHECK(answer.inside_points == expected.inside_points);
  CHECK(answer.profile_poses == expected.profile_poses);
  CHECK(answer.first_place == expected.first_place);
  CHECK(answer.least_clearance == expected.least_clearance);
  CHECK(answer.least_profile == expected.least_profile);
  CHECK(answer.classes == expected.classes);
  REQUIRE(answer.deepest.has_value() == expected.deepest.has_value());
  if (answer.deepest) {
    CHECK(answer.deepest->depth == expected.deepest->depth);
    CHECK(answer.deepest->source == expected.deepest->source);
    CHECK(answer.deepest->xyz == expected.deepest->xyz);
    CHECK(answer.deepest->depth_source == expected.deepest->depth_source);
  }
  CHECK(answer.certain.points == expected.certain.points);
  CHECK(answer.ignored.points == expected.ignored.points);
  CHECK(answer.ignored_colliding == expected.ignored_colliding);
  CHECK(answer.ignored_colliding_high == expected.ignored_colliding_high);
  CHECK(answer.floor_colliding == expected.floor_colliding);
}

void check(const Truth& truth, const Result& result) {
  check_tables(truth, result.collisions(), result.near(), result.clearance(), result.profile());
  check_answer(truth, result.answer());
}

void check(const Truth& truth, const SessionAnswer& answer) {
  check_tables(truth, answer.collisions(), answer.near(), answer.clearances(), answer.profile());
  check_answer(truth, answer);
}

std::vector<Body> three_bodies(Random& random, const std::vector<Pose>& path, bool gaps) {
  const Box part{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}};
  std::vector<Body> bodies;
  for (const char* name : {"front", "middle", "rear"}) {
    bodies.push_back({name, random_points(random, part, 25), {}, {}});
  }
  bodies[2].model = bodies[0].model;
  const auto add = [&](std::size_t body, std::uint32_t pose, const Vec3& by) {
    Pose at = path[pose];
    for (int k = 0; k < 3; ++k) at.translation[k] += by[k];
    bodies[body].poses.push_back(at);
    bodies[body].path_pose.push_back(pose);
  };
  for (std::uint32_t i = 0; i < path.size(); ++i) {
    add(0, i, {0, 0, 0});
    if (i >= 5 && i + 7 < path.size()) add(1, i, {0.4, 0, 0});
    if (gaps ? i % 5 != 2 : i < 30) add(2, i, {0, i % 3 == 0 ? 0 : -0.3, 0});
  }
  return bodies;
}

AskedScan::AskedScan(std::uint64_t seed, bool plain) {
  Random random(seed);
  std::vector<Quantum> points;
  for (int i = 0; i < 2500; ++i) {
    points.push_back({static_cast<std::int32_t>(below(random, 4000)),
                      static_cast<std::int32_t>(below(random, 3000)),
                      static_cast<std::int32_t>(below(random, 1000))});
    if (i % 20 == 0) points.push_back(points[below(random, points.size())]);
  }
  for (const Quantum& q : points) places.push_back(position(kMillimetres, q[0], q[1], q[2]));
  if (plain) {
    write_las(folder / "scan.las", points);
  } else {
    classes = random_classes(points.size(), 4);
    write_classed(folder / "scan.las", points, classes, 6, {100, -200, 0});
  }
  store = converted("store.h5", {.cell_points = 64});
  const Box part{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}};
  for (const std::size_t count : {1, 25, 120})
    models.emplace_back(random_points(random, part, count));
  for (Vec3& p : models[1].vertices) p.z = 5 * p.z + 0.2;  // higher than the ground may be
  const Surface surface = random_surface(random, part, 30);
  models.emplace_back(surface.vertices, surface.triangles);
  Bodies solids;
  solids.add(box_surface({part.lo, {0.3, 0.2, 0.5}}));
  solids.add(mapped(unit_sphere(1), [](const Vec3& v) { return plus({0.4, 0, 0.3}, 0.2, v); }));
  solids.add({{{0, 0, -0.2}, {0.4, 0, -0.2}, {0, 0.4, -0.2}}, {{0, 1, 2}}}, false);
  models.emplace_back(solids.surface.vertices, solids.surface.triangles, solids.solid_of);
}

std::filesystem::path AskedScan::converted(const std::string& name, ConvertOptions how) const {
  how.threads = 2;
  if (!classes.empty()) {
    how.origins = folder.write("origins.csv", "first,x,y,z\n0,101,-198.5,0.5\n1500,103,-198,0.8\n");
  }
  convert({folder / "scan.las"}, folder / name, how);
  return folder / name;
}

std::vector<Pose> AskedScan::path(Random& random, std::size_t poses) {
  return smooth_path(random, kRoom, poses);
}

Query AskedScan::vehicle(std::uint64_t seed, std::size_t poses, bool gaps) const {
  Random random(seed);
  Query query({}, path(random, poses), {.radius = 0.06});
  query.bodies = three_bodies(random, query.poses, gaps);
  return query;
}

Question AskedScan::question(Random& random) const {
  for (;;) {
    Question asked = any_question(random);
    if (std::ranges::any_of(moving_bodies(asked.query), is_below_floor)) continue;
    try {
      const SearchOptions options{.engine = asked.engine};
      check_query(asked.query, options);
      check_bodies(asked.query, options);
      if (asked.query.model.is_surface()) check_surface(asked.query, options);
      return asked;
    } catch (const UsageError&) {  // what it asks for cannot be combined
    }
  }
}

Question AskedScan::any_question(Random& random) const {
  const auto one_in = [&](std::uint64_t n) { return below(random, n) == 0; };
  const auto any_model = [&] { return models[below(random, models.size())]; };
  const std::size_t counts[] = {1, 1, 2, 5, 14, 40};
  const std::size_t poses = counts[below(random, std::size(counts))];
  Question asked;
  Query& query = asked.query;
  const bool between = one_in(4);
  if (one_in(3)) {
    query = vehicle(random(), poses, !between);
    for (Body& body : query.bodies) {
      if (one_in(2)) body.model = any_model();
      if (one_in(6)) body.floor = uniform(random, -0.1, 0.05);
    }
    if (one_in(2)) query.bodies[2].model = query.bodies[0].model;
    query.bodies.resize(1 + below(random, 3));
    if (query.bodies.size() > 1 && one_in(3)) query.bodies.erase(query.bodies.begin());
  } else {
    query = Query(any_model(), path(random, poses), {});
  }
  query.radius = one_in(2) ? 0.05 : 0.13;
  query.between_poses = between;
  query.first_pose = one_in(2);
  if (one_in(3)) query.clearance = one_in(2) ? 0.04 : 0.3;
  if (one_in(3)) query.profile = one_in(2) ? 0.02 : 0.5;
  if (one_in(3)) query.floor = uniform(random, -0.15, 0.05);
  query.depth = one_in(5);
  if (!classes.empty()) {
    query.seen = one_in(8);
    if (one_in(4)) query.ignore_classes = {static_cast<std::uint8_t>(below(random, 6)), 1};
  }
  if (one_in(4)) {  // it ends at a point
    const Vec3 corner = places[below(random, places.size())], size{1.5, 1, 0.6};
    query.ignore_boxes = {one_in(2) ? Box{corner, corner + size} : Box{corner - size, corner}};
  }
  if (one_in(3)) query.error_scan = one_in(2) ? 0.02 : 0.004;
  if (one_in(8)) query.error_pose = 0.003;
  const bool plain = query.bodies.empty() && !query.model.is_surface();
  if (plain && one_in(2)) asked.engine = one_in(2) ? Engine::kKdtree : Engine::kGrid;
  return asked;
}

Truth AskedScan::truth(const Query& query, const std::optional<ErrorBudget>& budget) const {
  Truth out;
  Answer& answer = out.answer;
  Points searched, ignored;
  for (std::uint64_t i = 0; i < places.size(); ++i) {
    const auto holds = [&](const Box& box) { return box.contains(places[i]); };
    const bool is_ignored =
        std::ranges::any_of(query.ignore_boxes, holds) ||
        (!classes.empty() && std::ranges::count(query.ignore_classes, classes[i]) > 0);
    (is_ignored ? ignored : searched).add(places[i], i);
  }
  const auto add_row = [&](auto& rows, std::uint64_t source) {
    rows.source.push_back(source);
    rows.xyz.push_back(places[source]);
    if (!classes.empty()) rows.point_class.push_back(classes[source]);
  };
  const auto add_touch = [&](auto& rows, const FirstTouch& touch) {
    if (query.first_pose) rows.first_pose.push_back(touch.pose);
    if (query.first_pose && !query.bodies.empty()) rows.body.push_back(touch.body);
  };
  const auto touches = first_touches(searched.places, query, query.radius);
  Query without_floors = query;
  without_floors.floor.reset();
  for (Body& body : without_floors.bodies) body.floor.reset();
  const auto unjudged =
      has_floor(query) ? first_touches(searched.places, without_floors, query.radius) : touches;
  const auto close =
      budget ? first_touches(searched.places, query, budget->near_radius(query.radius)) : touches;
  std::vector<bool> is_free(places.size());
  if (has_floor(query)) answer.floor_colliding = 0;
  for (std::size_t i = 0; i < searched.source.size(); ++i) {
    const std::uint64_t source = searched.source[i];
    is_free[source] = unjudged[i].pose == kNoPose;
    if (touches[i].pose != kNoPose) {
      add_row(out.collisions, source);
      add_touch(out.collisions, touches[i]);
    } else if (close[i].pose != kNoPose) {
      add_row(out.near, source);
      add_touch(out.near, close[i]);
    } else if (answer.floor_colliding && !is_free[source]) {
      ++*answer.floor_colliding;
    }
  }
  Collisions& rows = out.collisions;
  if (query.first_pose) rows.last_pose = last_touches(rows.xyz, query);
  if (budget) {
    for (const bool certain : certain_of(rows.xyz, query, budget->certain_radius(query.radius))) {
      rows.certain.push_back(certain ? 1 : 0);
    }
  }
  if (query.depth) add_depths(places, is_free, rows);
  if (query.clearance > 0) {
    const auto least = least_distances(searched.places, query, query.radius);
    for (std::size_t i = 0; i < least.size(); ++i) {
      if (!(least[i].squared < rounded_product(query.clearance, query.clearance))) continue;
      add_row(out.clearances, searched.source[i]);
      out.clearances.distance.push_back(signed_root(least[i].squared));
      out.clearances.pose.push_back(least[i].first.pose);
      if (!query.bodies.empty()) out.clearances.body.push_back(least[i].first.body);
    }
  }
  if (query.profile > 0) {
    out.profile = profile_of(searched, query);
    for (const std::uint64_t source : out.profile.source) {
      if (classes.empty()) break;
      out.profile.point_class.push_back(source == Profile::kNoPoint ? 0 : classes[source]);
    }
  }
  summarise_plainly(out);
  double lowest = kInfinity;
  const std::vector<MovingBody> bodies = moving_bodies(query);
  for (const MovingBody& body : bodies) {
    answer.model_points += body.model.vertices.size();
    answer.model_solids += body.model.solid_count();
    for (const Vec3& p : body.model.vertices) lowest = std::min(lowest, p.z);
    if (!body.name.empty()) answer.bodies.emplace_back(body.name);
  }
  const auto ignored_touches = first_touches(ignored.places, query, query.radius);
  for (std::size_t i = 0; i < ignored_touches.size(); ++i) {
    const auto [pose, body] = ignored_touches[i];
    if (pose == kNoPose) continue;
    ++answer.ignored_colliding;
    if (pulled_back(*bodies[body].pose_at(pose), ignored.places[i]).z - lowest > 0.5) {
      ++answer.ignored_colliding_high;
    }
  }
  answer.ignored.points = ignored.source.size();
  answer.environment_points = places.size();
  answer.poses = query.poses.size();
  if (!query.bodies.empty()) answer.searched = searched_length(query.poses, query.bodies);
  return out;
}

std::string searched(const AskedScan& scan, const Query& query, const std::string& name,
                     const SearchOptions& options) {
  SearchOptions how = options;
  how.device = Device::kCpu;
  how.overwrite = !how.resume;
  search(Store(scan.store), query, scan.folder / name, how);
  return bytes_of(scan.folder / name);
}

std::string searched_in_parts(const AskedScan& scan, const Query& query, std::uint32_t count,
                              const SearchOptions& options, MergeReport& report) {
  std::vector<std::filesystem::path> parts;
  SearchOptions how = options;
  for (std::uint32_t number = count; number > 0; --number) {
    how.shard = Shard{number, count};
    // Parts of the set may be found by different engines.
    if (number % 2 == 0) how.engine = Engine::kSweep;
    parts.push_back(scan.folder / ("part" + std::to_string(number) + ".h5"));
    searched(scan, query, parts.back().filename(), how);
  }
  report = merge(parts, scan.folder / "merged.h5", {.threads = 2, .overwrite = true});
  return bytes_of(scan.folder / "merged.h5");
}

std::string searched_in_pieces(const AskedScan& scan, const Query& query, Random& random,
                               const SearchOptions& options, SearchReport& report) {
  const auto output = scan.folder / "pieces.h5";
  std::filesystem::remove(output);
  SearchOptions how = options;
  how.device = Device::kCpu;
  how.journal_interval_seconds = 0;
  for (std::uint64_t most = 8;; most *= 2) {
    std::atomic<bool> stop = false;
    std::atomic<std::uint64_t> left = 1 + below(random, most);
    how.stop = &stop;
    how.progress = [&](const ProgressUpdate&) { stop = stop || --left == 0; };
    try {
      report = search(Store(scan.store), query, output, how);
      return bytes_of(output);
    } catch (const Interrupted&) {
      how.resume = true;
    }
  }
}

}  // namespace clearway::test
