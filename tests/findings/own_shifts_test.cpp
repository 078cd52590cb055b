// Own shifts of conflicts against a brute force over all points, poses and candidates, which has
// nothing in common with the search but the squared distance.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "core/geometry/triangle.hpp"
#include "core/util/progress.hpp"
#include "findings/shift/least_shift.hpp"
#include "findings/station_oracle.hpp"
#include "io/files/thread_limit.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

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
  std::uint64_t pairs = 0;  ///< as least_shifts() is told

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
    return in_threads(threads, [&] {
      std::deque<PointBlocks> trees;
      std::vector<PointsToFree> to_free;
      for (std::size_t i = 0; i < copy.size(); ++i) {
        const bool any = !copy[i].empty();
        to_free.push_back({any ? &trees.emplace_back(steps, copy[i]) : nullptr, ranges[i].first,
                           ranges[i].second});
      }
      const std::vector<MovingBody> moving = bodies();
      NoProgress progress;
      return least_shifts({moving, path, left, radius, ways, pairs, most, threads}, to_free,
                          progress);
    });
  }
};

// --- The brute force ---

Vec3 solved(const double* m, const Vec3& v) {
  const Vec3 a{m[0], m[3], m[6]}, b{m[1], m[4], m[7]}, c{m[2], m[5], m[8]};
  const double volume = dot(a, cross(b, c));
  return {dot(v, cross(b, c)) / volume, dot(v, cross(c, a)) / volume, dot(v, cross(a, b)) / volume};
}

Pose mixed(const Pose& a, const Pose& b, double share) {
  Pose out{};
  for (int k = 0; k < 9; ++k) out.rotation[k] = (1 - share) * a.rotation[k] + share * b.rotation[k];
  for (int k = 0; k < 3; ++k) {
    out.translation[k] = (1 - share) * a.translation[k] + share * b.translation[k];
  }
  return out;
}

/// Whether a place is inside a convex solid, by the planes of its triangles.
bool is_inside(const std::vector<Triangle>& solid, const Vec3& x) {
  const auto is_outside_of = [&](const Triangle& t) {
    return dot(cross(t.b - t.a, t.c - t.a), x - t.a) > 0;
  };
  return std::ranges::none_of(solid, is_outside_of);
}

/// A model with the triangles of each solid, and those of none at the end.
struct ShiftedModel {
  const Model* model;
  Box box;
  std::vector<std::vector<Triangle>> solids;

  explicit ShiftedModel(const Model& of)
      : model(&of), box(box_around(of.vertices)), solids(of.solid_count() + 1) {
    for (std::size_t t = 0; t < of.triangles.size(); ++t) {
      const auto& [a, b, c] = of.triangles[t];
      const std::uint32_t solid = of.solid_of.empty() ? kNoSolid : of.solid_of[t];
      (solid == kNoSolid ? solids.back() : solids[solid])
          .emplace_back(of.vertices[a], of.vertices[b], of.vertices[c]);
    }
  }

  bool is_hit(const Vec3& x, double radius) const {
    if (!box.grown(radius).contains(x)) return false;
    if (model->triangles.empty()) {
      return std::ranges::any_of(model->vertices,
                                 [&](const Vec3& m) { return length(m - x) < radius; });
    }
    for (std::size_t i = 0; i < solids.size(); ++i) {
      const bool is_near = std::ranges::any_of(
          solids[i], [&](const Triangle& t) { return squared_distance(x, t) < radius * radius; });
      if (is_near || (i + 1 < solids.size() && is_inside(solids[i], x))) return true;
    }
    return false;
  }
};

/// The points of a set as they move through the bodies' frames when the path is shifted.
class Shifted {
 public:
  Shifted(const ShiftScene& scene, std::size_t set, double direction) : scene_(scene) {
    const auto [first, last] = scene.ranges[set];
    for (std::size_t body = 0; body < scene.models.size(); ++body) {
      obstacles_.emplace_back(scene.models[body]);
      const auto add = [&](const Pose& pose, const Pose& of_path) {
        const Vec3 way = solved(pose.rotation, direction * of_path.rotated(scene.left));
        for (const QuantumPoint& q : scene.sets[set]) {
          const Vec3 place = position(scene.steps, q.q[0], q.q[1], q.q[2]);
          lines_.push_back({solved(pose.rotation, place - pose.position()), way, body});
        }
      };
      const std::vector<Pose>& poses = scene.poses[body];
      for (std::uint32_t i = first; i <= last; ++i) {
        add(poses[i], scene.path[i]);
        if (!scene.ways || i == last) continue;
        const double way = length(poses[i + 1].position() - poses[i].position());
        const int steps = static_cast<int>(std::clamp(std::ceil(way * 2 / scene.radius), 1., 64.));
        for (int k = 1; k < steps; ++k) {
          const double share = k / static_cast<double>(steps);
          add(mixed(poses[i], poses[i + 1], share), mixed(scene.path[i], scene.path[i + 1], share));
        }
      }
    }
  }

  bool collides(double shift) {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      const Vec3 x = line.from - shift * line.way;
      if (scene_.floor && x.z < *scene_.floor) continue;
      if (!obstacles_[line.body].is_hit(x, scene_.radius)) continue;
      if (i > 0) std::swap(lines_[i], lines_[i / 2]);  // probably hit at the next shift, too
      return true;
    }
    return false;
  }

 private:
  struct Line {
    Vec3 from, way;
    std::size_t body;
  };

  const ShiftScene& scene_;
  std::vector<ShiftedModel> obstacles_;
  std::vector<Line> lines_;
};

/// Checks that shifts free their sets, and that no shorter ones do.
void check_least(const ShiftScene& scene, const std::vector<SideShifts>& found, Random& random) {
  constexpr double kClose = 2e-8;
  REQUIRE(found.size() == scene.sets.size());
  for (std::size_t set = 0; set < found.size(); ++set) {
    for (const double direction : {1.0, -1.0}) {
      CAPTURE(set, direction);
      const std::optional<double>& shift = direction > 0 ? found[set].left : found[set].right;
      Shifted shifted(scene, set, direction);
      if (shift) CHECK_FALSE(shifted.collides(*shift + kClose));
      const double end = shift.value_or(scene.most) - kClose;
      for (int i = 0; i < 100 && end > 0; ++i) {
        // At both ends, near the far one, and anywhere
        const double part = i < 2        ? i
                            : i % 4 == 0 ? 1 - std::pow(10, -uniform(random, 0, 7))
                                         : uniform(random, 0, 1);
        if (!shifted.collides(part * end)) FAIL("it is free at " << part * end << " already");
      }
    }
  }
}

void check_against_brute_force(ShiftScene& scene, Random& random) {
  const std::vector<SideShifts> found = scene.shifts(1);
  CHECK(scene.shifts(3) == found);
  check_least(scene, found, random);
  for (auto& set : scene.sets) std::ranges::shuffle(set, random);
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
