// Own shifts of conflicts against a brute force over all points, poses and candidates, which has
// nothing in common with the search but the squared distance.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/triangle.hpp"
#include "core/util/progress.hpp"
#include "findings/shift/least_shift.hpp"
#include "io/files/thread_limit.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

struct ShiftScene {
  Quantisation steps{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  std::vector<Pose> path;
  std::vector<Model> models;
  std::vector<std::vector<Pose>> poses;  ///< of each body, one for each pose of the path
  std::optional<double> floor;
  std::vector<std::vector<QuantumPoint>> sets;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;  ///< of the poses of each set
  Vec3 left{0, 1, 0};
  double radius = 0.1, most = 2;
  bool ways = false;
  std::uint64_t pairs = 0;  ///< as LeastShift is told

  std::vector<MovingBody> bodies() const {
    std::vector<MovingBody> out;
    for (std::size_t i = 0; i < models.size(); ++i)
      out.push_back({{}, models[i], poses[i], {}, floor});
    return out;
  }

  void add(const Vec3& place, std::size_t set = 0) {
    QuantumPoint& q = sets[set].emplace_back();
    for (int k = 0; k < 3; ++k) {
      q.q[k] =
          static_cast<std::int32_t>(std::lround((place[k] - steps.offset[k]) / steps.scale[k]));
    }
  }

  std::vector<SideShifts> shifts(int threads) const {
    std::vector<std::vector<QuantumPoint>> copy = sets;
    std::vector<PointsToFree> to_free;
    for (std::size_t i = 0; i < copy.size(); ++i) {
      to_free.push_back({copy[i], ranges[i].first, ranges[i].second});
    }
    return in_threads(threads, [&] {
      const std::vector<MovingBody> moving = bodies();
      const LeastShift least(moving, path, left, radius, ways, pairs, threads);
      NoProgress progress;
      return least.least(steps, to_free, most, progress);
    });
  }
};

// --- The brute force ---

struct Blocked {
  double from, to;
};

Vec3 solved(const double* m, const Vec3& v) {
  const Vec3 a{m[0], m[3], m[6]}, b{m[1], m[4], m[7]}, c{m[2], m[5], m[8]};
  const double volume = dot(a, cross(b, c));
  return {dot(v, cross(b, c)) / volume, dot(v, cross(c, a)) / volume, dot(v, cross(a, b)) / volume};
}

Vec3 turned_by(const double* m, const Vec3& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

Pose mixed(const Pose& a, const Pose& b, double share) {
  Pose out{};
  for (int k = 0; k < 9; ++k) out.rotation[k] = (1 - share) * a.rotation[k] + share * b.rotation[k];
  for (int k = 0; k < 3; ++k) {
    out.translation[k] = (1 - share) * a.translation[k] + share * b.translation[k];
  }
  return out;
}

/// A point as it moves through a body's frame.
struct Line {
  Vec3 from, way;
  Vec3 at(double shift) const { return from - shift * way; }
};

/// The shifts at which a point is closer than the radius to a triangle, whose distance is convex.
std::optional<Blocked> near_triangle(const Line& line, const Triangle& t, double radius) {
  const double size = std::max(length(t.b - t.a), length(t.c - t.a)) + radius;
  const Vec3 away = cross(line.from - t.a, line.way);
  if (length(away) > 1.001 * size * length(line.way)) return std::nullopt;  // passes far from it
  const auto distance = [&](double shift) { return squared_distance(line.at(shift), t); };
  const double speed = length(line.way);
  const double beside = dot(line.from - t.a, line.way) / (speed * speed);
  const double first = beside - size / speed, last = beside + size / speed;
  double lo = first, hi = last;
  for (int i = 0; i < 60; ++i) {
    const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    if (distance(a) <= distance(b)) {
      hi = b;
    } else {
      lo = a;
    }
  }
  const double nearest = (lo + hi) / 2, square = radius * radius;
  if (!(distance(nearest) < square)) return std::nullopt;
  const auto end_towards = [&](double outside) {
    double inside = nearest;
    for (int i = 0; i < 45; ++i) {
      const double middle = (inside + outside) / 2;
      (distance(middle) < square ? inside : outside) = middle;
    }
    return inside;
  };
  return Blocked{end_towards(first), end_towards(last)};
}

std::optional<Blocked> near_point(const Line& line, const Vec3& m, double radius) {
  const Vec3 w = line.from - m;
  const double a = dot(line.way, line.way), b = dot(w, line.way);
  const double rest = b * b - a * (dot(w, w) - radius * radius);
  if (!(rest > 0)) return std::nullopt;
  return Blocked{(b - std::sqrt(rest)) / a, (b + std::sqrt(rest)) / a};
}

/// How often the triangles wind around a place, by the angles at which they are seen.
double winding(const std::vector<Triangle>& solid, const Vec3& x) {
  double sum = 0;
  for (const Triangle& t : solid) {
    const Vec3 a = t.a - x, b = t.b - x, c = t.c - x;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

void add_inside(const Line& line, const std::vector<Triangle>& solid, std::vector<Blocked>& out) {
  std::vector<double> cuts;
  for (const Triangle& t : solid) {
    const Vec3 normal = cross(t.b - t.a, t.c - t.a);
    const double speed = dot(normal, line.way);
    if (speed != 0) cuts.push_back(dot(normal, line.from - t.a) / speed);
  }
  std::ranges::sort(cuts);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (!(cuts[i + 1] - cuts[i] > 1e-12)) continue;
    const double sum = winding(solid, line.at((cuts[i] + cuts[i + 1]) / 2));
    if (std::abs(sum) > 0.5) out.push_back({cuts[i], cuts[i + 1]});
  }
}

/// What leaves of the shifts at which a point is at the floor or above.
void cut_at_floor(const Line& line, double floor, std::vector<Blocked>& all) {
  for (Blocked& b : all) {
    const double at = (line.from.z - floor) / line.way.z;
    if (line.way.z > 0) b.to = std::min(b.to, at);
    if (line.way.z < 0) b.from = std::max(b.from, at);
    if (line.way.z == 0 && line.from.z < floor) b.to = b.from;
  }
}

/// The triangles of each solid, and those of none at the end.
std::vector<std::vector<Triangle>> solids_of(const Model& model) {
  std::vector<std::vector<Triangle>> out(model.solid_count() + 1);
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const auto& [a, b, c] = model.triangles[t];
    const std::uint32_t solid = model.solid_of.empty() ? kNoSolid : model.solid_of[t];
    (solid == kNoSolid ? out.back() : out[solid])
        .emplace_back(model.vertices[a], model.vertices[b], model.vertices[c]);
  }
  return out;
}

std::optional<double> brute_force(const ShiftScene& scene, std::size_t set, double direction) {
  std::vector<Blocked> all;
  const auto [first, last] = scene.ranges[set];
  const auto add = [&](std::size_t body, const Pose& pose, const Pose& of_path) {
    const Model& model = scene.models[body];
    const Vec3 way = solved(pose.rotation, direction * turned_by(of_path.rotation, scene.left));
    const auto solids = solids_of(model);
    for (const QuantumPoint& q : scene.sets[set]) {
      const Vec3 place = position(scene.steps, q.q[0], q.q[1], q.q[2]);
      const Line line{solved(pose.rotation, place - pose.position()), way};
      std::vector<Blocked> here;
      if (model.triangles.empty()) {
        for (const Vec3& m : model.vertices) {
          if (const auto found = near_point(line, m, scene.radius)) here.push_back(*found);
        }
      }
      for (std::size_t solid = 0; solid < solids.size(); ++solid) {
        for (const Triangle& t : solids[solid]) {
          if (const auto found = near_triangle(line, t, scene.radius)) here.push_back(*found);
        }
        if (solid + 1 < solids.size()) add_inside(line, solids[solid], here);
      }
      if (scene.floor) cut_at_floor(line, *scene.floor, here);
      all.insert(all.end(), here.begin(), here.end());
    }
  };
  for (std::size_t body = 0; body < scene.models.size(); ++body) {
    for (std::uint32_t i = first; i <= last; ++i) {
      const std::vector<Pose>& poses = scene.poses[body];
      add(body, poses[i], scene.path[i]);
      if (!scene.ways || i == last) continue;
      const double way = length(poses[i + 1].position() - poses[i].position());
      const int steps =
          static_cast<int>(std::min(64.0, std::max(1.0, std::ceil(way * 2 / scene.radius))));
      for (int k = 1; k < steps; ++k) {
        const double share = k / static_cast<double>(steps);
        add(body, mixed(poses[i], poses[i + 1], share),
            mixed(scene.path[i], scene.path[i + 1], share));
      }
    }
  }
  // The first candidate, which is 0 or the end of a blocked interval, at which nothing collides
  std::ranges::sort(all, {}, &Blocked::from);
  double shift = 0;
  for (const Blocked& b : all) {
    if (b.from > shift + 1e-9) break;
    if (b.to > b.from) shift = std::max(shift, b.to);
  }
  return shift > scene.most ? std::nullopt : std::optional(shift);
}

void check_against_brute_force(ShiftScene& scene, Random& random) {
  const std::vector<SideShifts> found = scene.shifts(1);
  CHECK(scene.shifts(3) == found);
  REQUIRE(found.size() == scene.sets.size());
  for (std::size_t set = 0; set < found.size(); ++set) {
    for (const double direction : {1.0, -1.0}) {
      CAPTURE(set, direction);
      const std::optional<double>& shift = direction > 0 ? found[set].left : found[set].right;
      const std::optional<double> expected = brute_force(scene, set, direction);
      // A shift that is as long as the longest may be found on either side of it.
      if (expected.value_or(kEndless) > scene.most - 1e-6 &&
          shift.value_or(kEndless) > scene.most - 1e-6) {
        continue;
      }
      REQUIRE(shift.has_value() == expected.has_value());
      if (shift) CHECK(std::abs(*shift - *expected) <= 1e-8);
    }
    std::ranges::shuffle(scene.sets[set], random);
  }
  CHECK(scene.shifts(3) == found);
}

// --- Scenes ---

Model points_on(Random& random, const Box& box, std::size_t count) {
  Model out;
  out.vertices = random_points(random, box, count);
  if (below(random, 2) != 0) return out;
  // On the faces, so that the model is hollow
  for (Vec3& v : out.vertices) {
    const int k = static_cast<int>(below(random, 3));
    v[k] = below(random, 2) == 0 ? box.lo[k] : box.hi[k];
  }
  return out;
}

Model random_model(Random& random) {
  const Vec3 half{uniform(random, 0.2, 1.5), uniform(random, 0.1, 0.8), uniform(random, 0.1, 0.8)};
  const Vec3 middle{uniform(random, -1, 1), uniform(random, -0.3, 0.3), uniform(random, 0, 1)};
  const Box box{middle - half, middle + half};
  const std::uint64_t kind = below(random, 4);
  if (kind == 0) return points_on(random, box, 1 + below(random, 40));
  Bodies bodies;
  const bool solid = kind >= 2;
  bodies.add(box_surface(box), solid);
  if (below(random, 2) == 0) {
    const double radius = uniform(random, 0.1, 0.4);
    bodies.add(mapped(unit_sphere(0),
                      [&](const Vec3& v) {
                        return box.hi + radius * v + Vec3{0, 0.2, 0};
                      }),
               solid && below(random, 2) == 0);
  }
  Model out = bodies.query({translation({})}, 0.1).model;
  if (!solid) out.solid_of.clear();
  return out;
}

Pose times(const Pose& a, const Pose& b) {
  Pose out{};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        out.rotation[3 * k + j] += a.rotation[3 * k + i] * b.rotation[3 * i + j];
      }
      out.translation[k] += a.rotation[3 * k + j] * b.translation[j];
    }
    out.translation[k] += a.translation[k];
  }
  return out;
}

ShiftScene random_scene(Random& random) {
  ShiftScene scene;
  scene.radius = uniform(random, 0.03, 0.4);
  scene.ways = below(random, 3) == 0;
  scene.pairs = below(random, 8) == 0 ? 10'000'000 : 10'000 * below(random, 20);
  if (below(random, 3) == 0) scene.floor = uniform(random, -0.3, 0.6);
  if (below(random, 4) == 0) scene.left = {-1, 0, 0};
  const bool far = below(random, 3) == 0;
  const Vec3 origin = far ? Vec3{4.5e5, 5.4e6, 300} : Vec3{0, 0, 0};
  for (int k = 0; k < 3; ++k) scene.steps.offset[k] = origin[k];
  // A path that turns, leans, and may go back
  const std::uint64_t count = 1 + below(random, scene.ways ? 6 : 14);
  const double turn = uniform(random, -0.2, 0.2), lean = uniform(random, -0.1, 0.1);
  const bool returns = below(random, 4) == 0;
  Vec3 at = origin;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double step = returns && i > count / 2 ? -0.3 : 0.3;
    const double angle = turn * static_cast<double>(i);
    at = at + step * Vec3{std::cos(angle), std::sin(angle), 0.1 * uniform(random, -1, 1)};
    const Pose turned = rotation({0, 0, 1}, angle, at);
    scene.path.push_back(times(turned, rotation({1, 0.3, 0}, lean * uniform(random, 0, 2), {})));
  }
  const std::uint64_t bodies = 1 + (below(random, 3) == 0 ? 1 + below(random, 2) : 0);
  for (std::uint64_t b = 0; b < bodies; ++b) {
    scene.models.push_back(random_model(random));
    std::vector<Pose>& poses = scene.poses.emplace_back();
    // Bodies turn against their path, some of them anyhow.
    const Vec3 behind{-2.0 * static_cast<double>(b), uniform(random, -0.3, 0.3), 0};
    const Pose body = below(random, 8) == 0 ? random_rotation(random, behind)
                      : b == 0              ? translation(behind)
                               : rotation({0.1, 0.1, 1}, uniform(random, -0.6, 0.6), behind);
    for (const Pose& pose : scene.path) {
      const double swing = b == 0 ? 0 : uniform(random, -0.1, 0.1);
      poses.push_back(times(times(pose, body), rotation({0, 0, 1}, swing, {})));
    }
  }
  const std::uint64_t sets = 1 + below(random, 3);
  for (std::uint64_t set = 0; set < sets; ++set) {
    scene.sets.emplace_back();
    const auto first = static_cast<std::uint32_t>(below(random, count));
    const auto last = first + static_cast<std::uint32_t>(below(random, count - first));
    scene.ranges.emplace_back(first, last);
    // Points around one place beside a body, and some anywhere near it
    const std::size_t body = below(random, bodies);
    const Model& model = scene.models[body];
    const Pose& pose = scene.poses[body][first + below(random, last - first + 1)];
    const Vec3 near = model.vertices[below(random, model.vertices.size())];
    const double wide = uniform(random, 0.01, 0.6);
    for (std::uint64_t i = 0, n = 1 + below(random, 70); i < n; ++i) {
      Vec3 place = near;
      const double size = i % 8 == 0 ? 1.0 : wide;
      for (int k = 0; k < 3; ++k) place[k] += uniform(random, -size, size);
      scene.add(transform(pose, place), set);
    }
  }
  return scene;
}

}  // namespace

TEST_CASE("own shifts are those of a brute force over all points, poses and candidates") {
  int with_shift = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    ShiftScene scene = random_scene(random);
    check_against_brute_force(scene, random);
    for (const SideShifts& found : scene.shifts(2)) {
      with_shift += found.left.value_or(0) > 0.01 && found.right.value_or(0) > 0.01 ? 1 : 0;
    }
  }
  CHECK(with_shift > 100);
}

TEST_CASE("own shifts of long and crowded scenes are those of the brute force") {
  Random random(7);
  ShiftScene scene;
  scene.sets.resize(1);
  scene.models = {{}};
  const auto drive = [&](std::size_t count, auto place_of) {
    for (std::size_t i = 0; i < count; ++i) scene.path.push_back(translation(place_of(i)));
    scene.poses = {scene.path};
    scene.ranges = {{0, static_cast<std::uint32_t>(count - 1)}};
  };
  SECTION("a load scrapes a wall along its whole way") {
    Bodies bodies;
    bodies.add(box_surface({{-2, -1, 0}, {2, 1, 2}}));
    scene.models = {bodies.query({}, 0.1).model};
    drive(40, [](std::size_t i) { return Vec3{0.5 * static_cast<double>(i), 0, 0}; });
    for (int i = 0; i < 200; ++i) {
      scene.add({0.1 * i, 1.02 + uniform(random, -0.03, 0.03), uniform(random, 0, 2)});
    }
  }
  SECTION("a flat wall beside a model whose points make a lattice") {
    for (int i = 0; i <= 8; ++i) {
      for (int k = 0; k <= 4; ++k) {
        scene.models[0].vertices.push_back({0.1 * i, 0.5, 0.1 * k});
        scene.models[0].vertices.push_back({0.1 * i, -0.5, 0.1 * k});
      }
    }
    drive(60, [](std::size_t i) { return Vec3{0.05 * static_cast<double>(i), 0, 0}; });
    for (int i = 0; i < 40; ++i) {
      for (int k = 0; k < 8; ++k) scene.add({0.0723 * i, 0.55, 0.0531 * k});
    }
  }
  SECTION("to and fro twenty times") {
    scene.models[0].vertices = random_points(random, {{-1, -0.6, 0}, {1, 0.6, 1}}, 60);
    drive(200, [](std::size_t i) {
      const auto at = static_cast<double>(i % 20 < 10 ? i % 20 : 20 - i % 20);
      return Vec3{0.4 * at, 0.001 * static_cast<double>(i), 0};
    });
    for (int i = 0; i < 100; ++i) {
      scene.add({uniform(random, 0, 4), uniform(random, 0.5, 0.9), uniform(random, 0, 1)});
    }
  }
  SECTION("poses every 2 mm") {
    scene.models[0].vertices = random_points(random, {{-0.3, -0.4, 0}, {0.3, 0.4, 0.5}}, 40);
    drive(1500, [](std::size_t i) {
      const double at = 0.002 * static_cast<double>(i);
      return Vec3{at, 0.05 * std::sin(at), 0};
    });
    for (int i = 0; i < 60; ++i) {
      scene.add({uniform(random, 0, 3), uniform(random, -0.5, -0.3), uniform(random, 0, 0.5)});
    }
  }
  SECTION("a model of one point") {
    scene.models[0].vertices = {{0.3, 0.2, 0.1}};
    drive(300, [](std::size_t i) { return Vec3{0.02 * static_cast<double>(i), 0, 0}; });
    for (int i = 0; i < 200; ++i) {
      scene.add({uniform(random, 0, 6), uniform(random, 0.1, 0.3), uniform(random, 0, 0.2)});
    }
  }
  check_against_brute_force(scene, random);
  const SideShifts found = scene.shifts(2)[0];
  CHECK((found.left.value_or(0) > 0.01 || found.right.value_or(0) > 0.01));
}

TEST_CASE("poses that have no inverse, or that shrink, free what they cannot see") {
  ShiftScene scene;
  scene.models = {{{0, 0, 0}}};
  // Half a turn between two poses: half-way, the matrix of the way has no inverse.
  scene.path = {translation({0, 0, 0}), rotation({0, 0, 1}, std::numbers::pi, {0.1, 0, 0})};
  scene.poses = {scene.path};
  scene.ways = true;
  scene.sets.resize(1);
  scene.ranges = {{0, 1}};
  scene.add({0, 0.05, 0});
  const SideShifts found = scene.shifts(2)[0];
  REQUIRE(found.left);
  CHECK(*found.left >= 0.15);
  CHECK(scene.shifts(1)[0] == found);
}
