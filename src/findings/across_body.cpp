#include "findings/across_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/axes.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "findings/row_pieces.hpp"

namespace clearway {
namespace {

/// Metres, and a share of a length: by so much the boxes that only leave points out are larger than
/// computed, because of roundings.
constexpr double kBoxRounding = 1e-6, kBoxShare = 1e-9;

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
  double least = std::min(least_squared_distance(box, a), least_squared_distance(box, b));
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
    least = std::min(least, least_squared_distance(box, at(s)));
  }
  return least;
}

/// A node of a tree of points, as a box around its middle.
struct Bunch {
  Vec3 centre, half;

  Bunch(const PointBlocks& points, std::uint32_t node) {
    const Box box = points.box(node);
    centre = box.centre();
    half = 0.5 * box.size();
  }
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

/// Keeps the greater of two numbers, of which `greatest` is none below 0; infinity for NaN.
void keep_greatest(double value, double& greatest) {
  if (value <= greatest) return;
  greatest = std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
}

/// How a body turns on the straight ways of its points from one pose to the next. Seen from the
/// body, a point of the environment then moves on a curve beside the line between its two places,
/// and the body is a little smaller than at its poses (docs/design/findings.md, "Between poses").
class Turn {
 public:
  /// No turn.
  Turn() = default;
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

  /// Makes beyond() not less than that of another turn.
  void keep_greatest(const Turn& other) {
    clearway::keep_greatest(other.share_, share_);
    clearway::keep_greatest(other.shrinks_, shrinks_);
  }

 private:
  double share_ = 0, shrinks_ = 0;
};

/// Bounds of how places move, seen from a body, while it goes through ranges of its poses. Most
/// ranges are of no account to most points, and a bound dismisses all of their poses at once.
class BodyMotion {
 public:
  /// The numbers of poses in ranges of level 0 and of the last level; those between double.
  static constexpr std::size_t kLeastPoses = 8, kMostPoses = 1024;

  /// Which of the ranges.
  struct Place {
    std::size_t level, i;

    std::size_t first() const { return i * (kLeastPoses << level); }
    std::size_t end() const { return (i + 1) * (kLeastPoses << level); }
    Place half(std::size_t number) const { return {level - 1, 2 * i + number}; }
  };

  BodyMotion(const MovingBody& body, double radius, bool ways)
      : poses_(body.poses), radius_(radius), ways_(ways) {
    for (std::size_t size = kLeastPoses; size <= kMostPoses; size *= 2) {
      auto& ranges = levels_.emplace_back((poses_.size() + size - 1) / size);
      for_each_parallel(ranges.size(), [&](std::size_t i) { ranges[i] = range_of(i, size); });
    }
  }

  std::size_t last_level() const { return levels_.size() - 1; }
  static std::size_t size_of(std::size_t level) { return kLeastPoses << level; }
  const Pose& middle(const Place& at) const { return middle_of(at.i, size_of(at.level)); }

  /// How far places at most `distance` from the middle pose of a range move along each axis of the
  /// body, from where they are then to where they are at any other pose of the range.
  Vec3 most_moves(const Place& at, double distance) const {
    const Range& range = levels_[at.level][at.i];
    Vec3 out{};
    for (int k = 0; k < 3; ++k) {
      out[k] = (range.shift[k] + range.turn[k] * distance) * (1 + kBoxShare) + kBoxRounding;
    }
    return out;
  }

  /// The greatest turn of any way that begins in a range.
  const Turn& most_turn(const Place& at) const { return levels_[at.level][at.i].most; }

 private:
  /// Seen from the body, no place is farther along an axis from where it is at the middle pose than
  /// `shift`, plus `turn` times its distance from that pose.
  struct Range {
    Vec3 shift{}, turn{};
    Turn most;  ///< the greatest turn of any way
  };

  const Pose& middle_of(std::size_t i, std::size_t size) const {
    return poses_[i * size + std::min(size, poses_.size() - i * size) / 2];
  }

  Range range_of(std::size_t i, std::size_t size) const {
    Range out;
    const PullBack middle(middle_of(i, size));
    const std::size_t first = i * size;
    const std::size_t end = std::min(first + size + (ways_ ? 1 : 0), poses_.size());
    for (std::size_t k = first; k < end; ++k) {
      const PullBack back(poses_[k]);
      const Vec3 moved = back.position - middle.position;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 row = (1 / back.determinant) * back.rows[axis];
        const Vec3 row_of_middle = (1 / middle.determinant) * middle.rows[axis];
        keep_greatest(std::abs(dot(row, moved)), out.shift[axis]);
        keep_greatest(length(row - row_of_middle), out.turn[axis]);
      }
      if (ways_ && k > first) out.most.keep_greatest(Turn(poses_[k - 1], poses_[k], radius_));
    }
    return out;
  }

  std::span<const Pose> poses_;
  double radius_;
  bool ways_;
  std::vector<std::vector<Range>> levels_;
};

/// A body as points are seen from it.
class Viewer {
 public:
  Viewer(const BodiesAcross& how, std::uint32_t body)
      : body_(how.bodies[body]),
        motion_(body_, how.radius, how.ways),
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

  /// Adds where the points of a node lie at the poses of a conflict's range. Points that surely lie
  /// within what is found already are not looked at one by one.
  void add(const PointsBeside& of, std::uint32_t node, AcrossBody& found) const {
    const bool ways = ways_ && of.first_pose < of.last_pose;
    const std::size_t first = index_of(of.first_pose);
    const std::size_t end = index_of(std::uint64_t{of.last_pose} + 1);
    // A way is numbered by the pose at which it begins.
    const Moments moments{first, ways && end > first ? end - 1 : end, ways};
    const std::size_t level = motion_.last_level(), size = BodyMotion::size_of(level);
    for (std::size_t i = first / size; i * size < moments.end; ++i) {
      add_range(of.points, node, {level, i}, moments, found);
    }
  }

 private:
  /// Poses or ways of the body from `first` to `end`, which is not included.
  struct Moments {
    std::size_t first, end;
    bool are_ways;
  };

  /// The index of the body's first pose that is not before a pose of the path.
  std::size_t index_of(std::uint64_t path_pose) const {
    const auto& all = body_.path_pose;
    if (all.empty()) return std::min<std::uint64_t>(path_pose, body_.poses.size());
    return static_cast<std::size_t>(std::ranges::lower_bound(all, path_pose) - all.begin());
  }

  /// Whether the body has a pose at both ends of a way.
  bool is_way(std::size_t i) const {
    return body_.path_pose.empty() || body_.path_pose[i] + 1 == body_.path_pose[i + 1];
  }

  /// Adds a node at those of the moments that lie in a range of the body's motion. Of node and
  /// range, the one that makes the place of the points less certain is divided first.
  void add_range(const PointBlocks& points, std::uint32_t node, const BodyMotion::Place& at,
                 const Moments& moments, AcrossBody& found) const {
    const std::size_t first = std::max(at.first(), moments.first);
    const std::size_t end = std::min(at.end(), moments.end);
    if (first >= end) return;
    const Bunch bunch(points, node);
    const PullBack middle(motion_.middle(at));
    const double distance = length(bunch.centre - middle.position) + length(bunch.half);
    const Vec3 moves = motion_.most_moves(at, distance);
    if (!may_add_in(seen_box(middle, bunch), moves, motion_.most_turn(at), moments, found)) return;
    const bool is_block = points.is_block(node);
    if (at.level > 0 && (is_block || longest(moves) >= longest(bunch.half))) {
      add_range(points, node, at.half(0), moments, found);
      add_range(points, node, at.half(1), moments, found);
    } else if (!is_block) {
      add_range(points, 2 * node + 1, at, moments, found);
      add_range(points, 2 * node + 2, at, moments, found);
    } else {
      const PointBlocks::Node& block = points.node(node);
      std::vector<Vec3> places;
      for (std::uint32_t p = block.begin; p < block.end; ++p) places.push_back(points.place(p));
      for (std::size_t k = first; k < end; ++k) add_moment(bunch, places, k, moments, found);
    }
  }

  static double longest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

  void add_moment(const Bunch& bunch, std::span<const Vec3> places, std::size_t k,
                  const Moments& moments, AcrossBody& found) const {
    if (!moments.are_ways) return add_pose(places, body_.poses[k], found);
    if (is_way(k)) add_way(bunch, places, body_.poses[k], body_.poses[k + 1], found);
  }

  /// Whether places in a box at one of some poses, or that move from there as far as `moves`, may
  /// change what is found at any of the poses or on any of the ways between them.
  bool may_add_in(Box seen, const Vec3& moves, const Turn& turn, const Moments& moments,
                  const AcrossBody& found) const {
    for (int k = 0; k < 3; ++k) {
      seen.lo[k] -= moves[k];
      seen.hi[k] += moves[k];
      if (!std::isfinite(seen.lo[k]) || !std::isfinite(seen.hi[k])) return true;
    }
    if (!moments.are_ways) return may_add(seen, found);
    const double beyond = turn.beyond(length(seen.size()));
    return !std::isfinite(beyond) || may_add(seen.grown(beyond), found);
  }

  void add_pose(std::span<const Vec3> places, const Pose& pose, AcrossBody& found) const {
    const PullBack back(pose);
    for (const Vec3& place : places) {
      const Vec3 x = back.apply(place);
      if (is_at_floor(x) && least_squared_distance(box_, x) < radius_ * radius_)
        add_place(x, 0, found);
    }
  }

  void add_way(const Bunch& bunch, std::span<const Vec3> places, const Pose& from, const Pose& to,
               AcrossBody& found) const {
    const PullBack first(from), second(to);
    const Box a = seen_box(first, bunch), b = seen_box(second, bunch);
    Box both = a;
    both.extend(b.lo);
    both.extend(b.hi);
    const Turn turn(from, to, radius_);
    // After half a turn a point may lie anywhere, and its places are looked at one by one.
    const double most = turn.beyond(length(both.size()));
    if (std::isfinite(most) && !may_add(both.grown(most), found)) return;
    for (const Vec3& place : places) {
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
    if (!seen.meets(grown_)) return false;
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
  BodyMotion motion_;
  Box box_, grown_;
  AheadLeftUp axes_;
  Vec3 left_, up_;
  Vec3 middle_{}, quarter_{};
  double radius_;
  bool ways_;
};

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

std::vector<AcrossBody> find_across_bodies(const BodiesAcross& how,
                                           std::span<const PointsBeside> conflicts,
                                           Progress& progress) {
  std::vector<Viewer> viewers;
  for (std::uint32_t b = 0; b < how.bodies.size(); ++b) viewers.emplace_back(how, b);
  std::vector<AcrossBody> out(conflicts.size());
  SharedLocks locks;
  // Takes over what others have found of a conflict, and gives them what was found here.
  const auto exchange = [&](std::size_t i, AcrossBody& found) {
    locks.hold(i, [&] {
      out[i].add(found);
      found = out[i];
    });
  };
  for_each_parallel(conflicts.size(), [&](std::size_t i) {
    const PointBlocks& points = conflicts[i].points;
    constexpr std::uint32_t kPointsOfTask = 1024;
    // The nodes of a level follow one another, and the tree is balanced.
    std::uint32_t first = 0;
    while (!points.is_block(first) && points.node(first).end > kPointsOfTask) first = 2 * first + 1;
    for_each_parallel(first + 1, [&](std::uint32_t k) {
      if (progress.stop_requested()) return;
      AcrossBody found;
      exchange(i, found);
      viewers[conflicts[i].body].add(conflicts[i], first + k, found);
      exchange(i, found);
    });
  });
  throw_if_stopped(progress);
  return out;
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
