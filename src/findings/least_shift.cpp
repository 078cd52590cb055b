#include "findings/least_shift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/inside.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle_box.hpp"

namespace clearway {
namespace {

/// The least amount in metres by which a shift grows, so that roundings cannot keep it from
/// growing.
constexpr double kStep = 1e-9;

/// The motion of a point in a body's frame while the body is shifted: it starts at `from` and moves
/// by -`way` for each metre of the shift.
struct PointWay {
  Vec3 from, way;

  Vec3 at(double shift) const {
    return {from.x - shift * way.x, from.y - shift * way.y, from.z - shift * way.z};
  }
};

/// The shift at which the point leaves the reach of a model point that it is within at `shift`.
double leaves(const PointWay& point, const Vec3& m, double radius, double /*shift*/) {
  const Vec3 w = difference(point.from, m);
  const double along = rounded_dot(w, point.way), square = rounded_dot(point.way, point.way);
  const double rest = along * along - square * (rounded_dot(w, w) - radius * radius);
  return (along + std::sqrt(std::max(0.0, rest))) / square;
}

/// The shift at which the point leaves the reach of a triangle that it is within at `shift`. The
/// distance to a triangle is convex along the motion, so its reach is left only once.
double leaves(const PointWay& point, const Triangle& t, double radius, double shift) {
  const auto within = [&](double at) {
    return squared_distance(point.at(at), t) < radius * radius;
  };
  double inside = shift, outside = shift + radius;
  while (within(outside)) {
    inside = outside;
    outside = shift + 2 * (outside - shift);
  }
  while (outside - inside > kStep / 4) {
    const double middle = inside + (outside - inside) / 2;
    (within(middle) ? inside : outside) = middle;
  }
  return outside;
}

bool overlap(double a, double b, double lo, double hi) {
  return std::min(a, b) <= hi && std::max(a, b) >= lo;
}

/// Into how many parts the way between two poses is divided: each is at most half the radius long,
/// but there are at most 64.
int steps_between(const Pose& a, const Pose& b, double radius) {
  constexpr double kMostSteps = 64;
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = b.translation[k] - a.translation[k];
    square += d * d;
  }
  return static_cast<int>(std::clamp(std::ceil(2 * std::sqrt(square) / radius), 1.0, kMostSteps));
}

/// A pose between a and b at which model points are that move on straight segments. Where the poses
/// turn, its matrix is not a rotation but one that also shrinks. Seen from it, places are farther
/// away than they are, so a shift that is computed from it is never too long.
Pose between(const Pose& a, const Pose& b, double part) {
  Pose out{};
  for (int k = 0; k < 9; ++k) {
    out.rotation[k] = a.rotation[k] + part * (b.rotation[k] - a.rotation[k]);
  }
  for (int k = 0; k < 3; ++k) {
    out.translation[k] = a.translation[k] + part * (b.translation[k] - a.translation[k]);
  }
  return out;
}

}  // namespace

/// The model of a body with its trees, in the body's own frame.
class LeastShift::Shape {
 public:
  Shape(const MovingBody& body, double radius, int threads)
      : Shape(body.model, body.floor, radius, threads) {}

  Shape(const Model& model, std::optional<double> floor, double radius, int threads)
      : radius_(radius),
        floor_(floor),
        points_(model.is_surface() ? std::span<const Vec3>() : std::span(model.vertices), threads),
        triangles_(triangles_of(model), threads),
        solids_(model, threads),
        box_(grown(model.is_surface() ? triangles_.box() : points_.box())) {}

  bool is_empty() const { return points_.size() == 0 && triangles_.size() == 0; }

  /// Whether the point comes within reach of the body's box at any shift between 0 and `most`.
  bool may_reach(const PointWay& point, double most) const {
    const Vec3 end = point.at(most);
    return overlap(point.from.x, end.x, box_.lo.x, box_.hi.x) &&
           overlap(point.from.y, end.y, box_.lo.y, box_.hi.y) &&
           overlap(point.from.z, end.z, box_.lo.z, box_.hi.z);
  }

  /// The least shift from `shift` on at which the point is free, or a shift above `most` where
  /// there is none.
  double free_from(const PointWay& point, double shift, double most) const {
    while (shift <= most) {
      const Vec3 x = point.at(shift);
      if (!may_reach({x, {0, 0, 0}}, 0) || is_below_floor(x)) return shift;
      const double next = triangles_.size() > 0 ? next_of(triangles_, point, x, shift)
                                                : next_of(points_, point, x, shift);
      if (next == shift) return shift;
      shift = std::max(std::min(next, sinks_below_floor(point)), shift + kStep);
    }
    return shift;
  }

 private:
  bool is_below_floor(const Vec3& x) const { return floor_ && x.z < *floor_; }

  /// The shift from which on a point that sinks lies below the floor; infinity for others. Only a
  /// body that leans against its path makes points sink.
  double sinks_below_floor(const PointWay& point) const {
    if (!floor_ || !(point.way.z > 0)) return std::numeric_limits<double>::infinity();
    return (point.from.z - *floor_) / point.way.z;
  }

  template <typename Element>
  double next_of(const ModelTreeOf<Element>& tree, const PointWay& point, const Vec3& x,
                 double shift) const {
    const auto nearest = tree.nearest(x);
    if (nearest.squared_distance < radius_ * radius_) {
      return leaves(point, tree.element(nearest.element), radius_, shift);
    }
    // A point inside a solid stays inside until it has moved as far as the nearest surface.
    if (!solids_.ref().contains(x)) return shift;
    return shift +
           std::sqrt(nearest.squared_distance) / std::sqrt(rounded_dot(point.way, point.way));
  }

  Box grown(const Box& box) const { return box.grown(radius_); }

  double radius_;
  std::optional<double> floor_;
  ModelTreeOf<Vec3> points_;
  ModelTreeOf<Triangle> triangles_;
  SolidParts solids_;
  Box box_;
};

LeastShift::LeastShift(std::span<const MovingBody> bodies, const std::vector<Pose>& path,
                       const Vec3& left, double radius, bool ways, int threads)
    : bodies_(bodies), path_(path), left_(left), radius_(radius), ways_(ways) {
  for (const MovingBody& body : bodies) {
    shapes_.push_back(std::make_unique<Shape>(body, radius, threads));
  }
}

LeastShift::~LeastShift() = default;

/// A run of points, seen in the frame of a body at a pose.
struct LeastShift::Run {
  const Shape* shape;
  /// The motion of the body in its own frame for each metre of a shift to the left.
  Vec3 left;
  std::size_t begin, end;

  PointWay way(const Vec3& point, double direction) const {
    return {point, {direction * left.x, direction * left.y, direction * left.z}};
  }
};

void LeastShift::add_runs(std::size_t body, const Pose& pose, const Pose& of_path,
                          std::span<const Vec3> points, double most, std::vector<Run>& runs,
                          std::vector<Vec3>& seen) const {
  const double* r = of_path.rotation;
  const Vec3 left{r[0] * left_.x + r[1] * left_.y + r[2] * left_.z,
                  r[3] * left_.x + r[4] * left_.y + r[5] * left_.z,
                  r[6] * left_.x + r[7] * left_.y + r[8] * left_.z};
  Pose turn = pose;
  for (double& t : turn.translation) t = 0;
  Run run{shapes_[body].get(), pulled_back(turn, left), seen.size(), 0};
  if (!(rounded_dot(run.left, run.left) > 0)) return;  // the matrix of the pose is not a rotation
  for (const Vec3& e : points) {
    const Vec3 x = pulled_back(pose, e);
    const PointWay from_right = run.way(PointWay{x, run.left}.at(-most), 1);
    if (run.shape->may_reach(from_right, 2 * most)) seen.push_back(x);
  }
  run.end = seen.size();
  runs.push_back(run);
}

SideShifts LeastShift::least(std::span<const Vec3> points, std::uint32_t first, std::uint32_t last,
                             double most) const {
  std::vector<Run> runs;
  std::vector<Vec3> seen;  // for all runs, the points that some shift brings within reach
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    if (shapes_[body]->is_empty()) continue;
    for (std::uint32_t i = first; i <= last; ++i) {
      const Pose* pose = bodies_[body].pose_at(i);
      if (pose == nullptr) continue;
      add_runs(body, *pose, path_[i], points, most, runs, seen);
      const Pose* next = ways_ && i < last ? bodies_[body].pose_at(i + 1) : nullptr;
      if (next == nullptr) continue;
      const int steps = steps_between(*pose, *next, radius_);
      for (int step = 1; step < steps; ++step) {
        const double part = static_cast<double>(step) / steps;
        add_runs(body, between(*pose, *next, part), between(path_[i], path_[i + 1], part), points,
                 most, runs, seen);
      }
    }
  }
  const auto to_side = [&](double direction) -> std::optional<double> {
    double shift = 0;
    // A point that was free may be blocked farther on, so all points are tested again until
    // the shift no longer grows.
    for (bool moved = true; moved;) {
      moved = false;
      for (const Run& run : runs) {
        for (std::size_t i = run.begin; i < run.end; ++i) {
          const double next = run.shape->free_from(run.way(seen[i], direction), shift, most);
          if (next > most) return std::nullopt;
          moved = moved || next > shift;
          shift = next;
        }
      }
    }
    return shift;
  };
  return {to_side(1), to_side(-1)};
}

}  // namespace clearway
