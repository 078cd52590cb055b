#include "findings/across_body.hpp"

#include <tbb/parallel_for.h>
#include <tbb/spin_mutex.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "core/geometry/axes.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/tsan_annotations.hpp"

namespace clearway {
namespace {

/// Metres, and a share of a length: by so much the boxes that only leave points out are larger than
/// computed, because of roundings.
constexpr double kBoxRounding = 1e-6, kBoxShare = 1e-9;

double squared_distance(const Vec3& x, const Box& box) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double out = std::max({box.lo[k] - x[k], x[k] - box.hi[k], 0.0});
    sum += out * out;
  }
  return sum;
}

/// The least squared distance of a box to the segment from a to b. Between the places where the
/// segment crosses the planes of the box's sides it is a square function of the way, whose least
/// value is known.
double squared_distance(const Vec3& a, const Vec3& b, const Box& box) {
  const Vec3 way = b - a;
  const auto at = [&](double s) { return Vec3{a.x + s * way.x, a.y + s * way.y, a.z + s * way.z}; };
  std::array<double, 8> cuts{0, 1};
  std::size_t count = 2;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {box.lo[k], box.hi[k]}) {
      const double s = (side - a[k]) / way[k];
      if (!(s > 0 && s < 1)) continue;
      std::size_t i = count++;
      for (; cuts[i - 1] > s; --i) cuts[i] = cuts[i - 1];  // the first one is 0
      cuts[i] = s;
    }
  }
  double least = std::min(squared_distance(a, box), squared_distance(b, box));
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const Vec3 middle = at((cuts[i] + cuts[i + 1]) / 2);
    double square = 0, linear = 0;
    for (int k = 0; k < 3; ++k) {
      if (middle[k] >= box.lo[k] && middle[k] <= box.hi[k]) continue;
      const double side = middle[k] < box.lo[k] ? box.lo[k] : box.hi[k];
      square += way[k] * way[k];
      linear += way[k] * (a[k] - side);
    }
    const double s = square > 0 ? std::clamp(-linear / square, cuts[i], cuts[i + 1]) : cuts[i];
    least = std::min(least, squared_distance(at(s), box));
  }
  return least;
}

/// The points of one part in a cell, with a box around them.
struct Bunch {
  std::vector<Vec3> places;
  Vec3 centre{}, half{};
};

/// A box of the body's frame that surely holds all of a bunch.
Box seen_box(const PullBack& back, const Bunch& bunch) {
  const Vec3 centre = back.apply(bunch.centre);
  Box out{};
  for (int k = 0; k < 3; ++k) {
    double half = 0;
    for (int j = 0; j < 3; ++j) half += std::abs(back.rows[k][j]) * bunch.half[j];
    half = half / std::abs(back.determinant) * (1 + kBoxShare) + kBoxShare * std::abs(centre[k]) +
           kBoxRounding;
    out.lo[k] = centre[k] - half;
    out.hi[k] = centre[k] + half;
  }
  return out;
}

/// False where a side is not a number.
bool overlap(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k) {
    if (!(a.lo[k] <= b.hi[k] && b.lo[k] <= a.hi[k])) return false;
  }
  return true;
}

/// How a body turns on the straight ways of its points from one pose to the next. Seen from the
/// body, a point of the environment then moves on a curve beside the line between its two places,
/// and the body is a little smaller than at its poses (docs/design/findings.md, "Between poses").
class Turn {
 public:
  Turn(const Pose& from, const Pose& to, double radius) {
    double square = 0;
    for (int k = 0; k < 9; ++k) {
      const double d = to.rotation[k] - from.rotation[k];
      square += d * d;
    }
    const double sine = std::sqrt(square / 8);  // of half the angle
    const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
    share_ = sine / (2 * cosine);
    shrinks_ = radius / cosine - radius;
  }

  /// How far beyond its two places, `way` apart, a point may be taken to lie on the way between
  /// them; infinity where the body turns by half a turn. Never below 0, nor NaN.
  double beyond(double way) const {
    const double sum = share_ * way + shrinks_;
    return sum >= 0 ? sum : std::numeric_limits<double>::infinity();
  }

 private:
  double share_, shrinks_;
};

/// A body as points are seen from it.
class Viewer {
 public:
  Viewer(const BodiesAcross& how, std::uint32_t body)
      : body_(how.bodies[body]),
        box_(how.boxes[body]),
        grown_(box_.grown(how.radius)),
        axes_(how.axes),
        left_(direction_to_left(axes_.forward, axes_.up)),
        up_(direction_of(axes_.up)),
        radius_(how.radius),
        ways_(how.ways) {
    const Box from_floor = how.box_from_floor(body);
    middle_ = from_floor.centre();
    quarter_ = {0, (from_floor.hi.y - from_floor.lo.y) / 4,
                (from_floor.hi.z - from_floor.lo.z) / 4};
  }

  /// Adds where a bunch lies at the poses of a range. Of a bunch that lies within what is found
  /// already, no point is looked at.
  void add(const Bunch& bunch, const PartAcross& part, AcrossBody& found) const {
    const bool ways = ways_ && part.first_pose < part.last_pose;
    const Pose* before = nullptr;
    for (std::uint32_t i = part.first_pose; i <= part.last_pose; ++i) {
      const Pose* pose = body_.pose_at(i);
      if (ways && pose != nullptr && before != nullptr) add_way(bunch, *before, *pose, found);
      if (!ways && pose != nullptr) add_pose(bunch, *pose, found);
      before = pose;
    }
  }

 private:
  void add_pose(const Bunch& bunch, const Pose& pose, AcrossBody& found) const {
    const PullBack back(pose);
    if (!may_add(seen_box(back, bunch), found)) return;
    for (const Vec3& place : bunch.places) {
      const Vec3 x = back.apply(place);
      if (is_at_floor(x) && squared_distance(x, box_) < radius_ * radius_) add_place(x, 0, found);
    }
  }

  void add_way(const Bunch& bunch, const Pose& from, const Pose& to, AcrossBody& found) const {
    const PullBack first(from), second(to);
    const Box a = seen_box(first, bunch), b = seen_box(second, bunch);
    Box both = a;
    both.extend(b.lo);
    both.extend(b.hi);
    const Turn turn(from, to, radius_);
    if (!may_add(both.grown(turn.beyond(length(both.size()))), found)) return;
    for (const Vec3& place : bunch.places) {
      const Vec3 x = first.apply(place), y = second.apply(place);
      if (!is_at_floor(x) && !is_at_floor(y)) continue;
      const double beyond = turn.beyond(length(y - x)), reach = radius_ + beyond;
      if (!(squared_distance(x, y, box_) < reach * reach)) continue;
      add_place(x, beyond, found);
      add_place(y, beyond, found);
    }
  }

  bool is_at_floor(const Vec3& x) const { return !body_.floor || x.z >= *body_.floor; }

  /// Whether places in a box may change what is found.
  bool may_add(const Box& seen, const AcrossBody& found) const {
    if (!overlap(seen, grown_)) return false;
    if (body_.floor && seen.hi.z < *body_.floor) return false;
    const Box across = turned(seen, axes_.forward, axes_.up);
    if (!found.in_middle && across.lo.y < middle_.y + quarter_.y &&
        across.hi.y > middle_.y - quarter_.y && across.lo.z < middle_.z + quarter_.z &&
        across.hi.z > middle_.z - quarter_.z) {
      return true;
    }
    return across.lo.y < found.left_from || across.hi.y > found.left_to ||
           across.lo.z < found.up_from || across.hi.z > found.up_to;
  }

  /// beyond: how far to all sides the point may lie as well.
  void add_place(const Vec3& x, double beyond, AcrossBody& found) const {
    const double left = dot(x, left_), up = dot(x, up_);
    found.left_from = std::min(found.left_from, left - beyond);
    found.left_to = std::max(found.left_to, left + beyond);
    found.up_from = std::min(found.up_from, up - beyond);
    found.up_to = std::max(found.up_to, up + beyond);
    found.in_middle = found.in_middle || (std::abs(left - middle_.y) < quarter_.y &&
                                          std::abs(up - middle_.z) < quarter_.z);
  }

  const MovingBody& body_;
  Box box_, grown_;
  AheadLeftUp axes_;
  Vec3 left_, up_;
  Vec3 middle_{}, quarter_{};
  double radius_;
  bool ways_;
};

/// The points of a cell that belong to parts, with the part of each, part by part.
std::vector<std::pair<std::uint32_t, Vec3>> points_of_parts(
    std::span<const GroupedPoint> points, std::span<const std::uint32_t> part_of_row,
    const Quantisation& quantisation) {
  std::vector<std::pair<std::uint32_t, Vec3>> out;
  for (const GroupedPoint& p : points) {
    const std::uint32_t part = part_of_row[p.row];
    if (part != 0) out.emplace_back(part - 1, position(quantisation, p.q[0], p.q[1], p.q[2]));
  }
  std::ranges::sort(out, {}, &std::pair<std::uint32_t, Vec3>::first);
  return out;
}

}  // namespace

void AcrossBody::add(const AcrossBody& other) {
  left_from = std::min(left_from, other.left_from);
  left_to = std::max(left_to, other.left_to);
  up_from = std::min(up_from, other.up_from);
  up_to = std::max(up_to, other.up_to);
  in_middle = in_middle || other.in_middle;
}

Box BodiesAcross::whole_box(std::uint32_t body) const {
  return turned(boxes[body], axes.forward, axes.up);
}

Box BodiesAcross::box_from_floor(std::uint32_t body) const {
  Box box = boxes[body];
  if (const auto floor = bodies[body].floor) box.lo.z = std::clamp(*floor, box.lo.z, box.hi.z);
  return turned(box, axes.forward, axes.up);
}

void find_across_bodies(const CellGrid& grid, const PointGroups& groups,
                        std::span<const std::uint32_t> part_of_row,
                        const Quantisation& quantisation, const BodiesAcross& how,
                        std::vector<PartAcross>& parts, Progress& progress) {
  using Range = tbb::blocked_range<std::uint32_t>;
  std::vector<Viewer> viewers;
  for (std::uint32_t b = 0; b < how.bodies.size(); ++b) viewers.emplace_back(how, b);
  std::array<tbb::spin_mutex, 64> locks;
  const auto exchange = [&](std::uint32_t number, AcrossBody& found) {
    tbb::spin_mutex& lock = locks[number % locks.size()];
    const tbb::spin_mutex::scoped_lock held(lock);
    acquire(&lock);
    parts[number].found.add(found);
    found = parts[number].found;
    release(&lock);
  };
  const auto add = [&](std::uint32_t number, const Bunch& bunch) {
    const PartAcross part{parts[number].body, parts[number].first_pose, parts[number].last_pose};
    AcrossBody found;
    exchange(number, found);
    viewers[part.body].add(bunch, part, found);
    exchange(number, found);
  };
  const ParallelScope scope;
  const auto add_cells = piece_of(scope, [&](const Range& range) {
    Bunch bunch;
    for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
      if (progress.stop_requested()) return;
      if (PointGroups::is_small(groups.of_cell[cell])) continue;
      const auto points = points_of_parts(grid.points(cell), part_of_row, quantisation);
      for (std::size_t i = 0; i < points.size();) {
        const std::uint32_t number = points[i].first;
        bunch.places.clear();
        for (; i < points.size() && points[i].first == number; ++i) {
          bunch.places.push_back(points[i].second);
        }
        const Box box = box_of(bunch.places);
        bunch.centre = box.centre();
        bunch.half = 0.5 * box.size();
        add(number, bunch);
      }
    }
  });
  scope.begin();
  tbb::parallel_for(Range(0, grid.cells(), 16), add_cells);
  throw_if_stopped(progress);
}

void set_trims(const AcrossBody& found, const Box& body, const Box& whole, double radius,
               Conflict& conflict) {
  conflict.side = conflict.first_touch;
  if (found.is_empty()) return;
  const double width = body.hi.y - body.lo.y, height = body.hi.z - body.lo.z;
  const auto trim = [](double length, double extent) {
    return length > 0 && length <= extent / 2 ? std::optional(length) : std::nullopt;
  };
  conflict.trim_left = trim(body.hi.y - found.left_from + radius, width);
  conflict.trim_right = trim(found.left_to - body.lo.y + radius, width);
  conflict.trim_above = trim(body.hi.z - found.up_from + radius, height);
  // What is below the floor comes near points above it too.
  conflict.trim_below = trim(found.up_to - whole.lo.z + radius, whole.hi.z - whole.lo.z);
  const std::pair<Side, std::optional<double>> trims[] = {{Side::kLeft, conflict.trim_left},
                                                          {Side::kRight, conflict.trim_right},
                                                          {Side::kAbove, conflict.trim_above},
                                                          {Side::kBelow, conflict.trim_below}};
  std::optional<double> least;
  for (const auto& [side, length] : trims) {
    if (!length || (least && *length >= *least)) continue;
    least = length;
    conflict.side = side;
  }
  const double middle = body.centre().y;
  const bool on_both_sides = found.left_from < middle && found.left_to > middle;
  if (!least && on_both_sides && !found.in_middle) conflict.side = Side::kAround;
}

}  // namespace clearway
