#include "findings/shift/least_shift.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "core/geometry/chord_pose.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/geometry/triangle_box.hpp"
#include "findings/shift/body_sections.hpp"
#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

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

/// Bounds are wider than computed by this share of the numbers that they are computed from.
constexpr double kShareOfNumbers = 1e-13;

/// Poses, with the steps after them, are taken together until there are at least so many.
constexpr std::size_t kChunk = 64;
/// The greatest number of poses from which a first bound of a shift is found.
constexpr std::uint32_t kFirstPoses = 128;
/// The most units that are open at the same time.
constexpr std::size_t kMostUnits = std::size_t{1} << 18;
/// The most columns of the cross-sections of all bodies together, and the least of one.
constexpr std::size_t kMostColumns = 200'000, kLeastColumns = 4'000;
/// For how many pairs of a point and a pose one column more is worth its time.
constexpr std::uint64_t kPairsOfColumn = 16;

bool all_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool meet(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.lo[k] > b.hi[k] || b.lo[k] > a.hi[k]) return false;
  }
  return true;
}

Box moved_on(const Box& box, const Vec3& way, const Vec3& most_way, double from, double to) {
  Box out = box;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] -= std::max(from * most_way[k], to * most_way[k]);
    out.hi[k] -= std::min(from * way[k], to * way[k]);
  }
  return out;
}

/// Shifts from one to another; none where from > to.
struct Interval {
  double from, to;

  /// Leaves only the shifts t where t * by >= least.
  void keep(double by, double least) {
    if (by > 0) {
      from = std::max(from, least / by);
    } else if (by < 0) {
      to = std::min(to, least / by);
    } else if (least > 0) {
      to = -kEndless;
    }
  }
};

/// A pose of a body, or a place between two, seen from the body.
struct Instant {
  PullBack back;
  Vec3 way;  ///< the motion of the body in its own frame for each metre of the shift
};

/// Points of a body's frame that move by at least `way` and at most `most_way` for each metre that
/// the body is shifted, in the opposite direction.
struct Bounds {
  Box box;
  Vec3 way, most_way;
};

/// The model of a body with its trees, in the body's own frame.
class Shape {
 public:
  Shape(const MovingBody& body, int axis, double radius, std::size_t most_columns, int threads)
      : radius_(radius),
        floor_(body.floor),
        axis_(axis),
        points_(body.model.is_surface() ? std::span<const Vec3>() : std::span(body.model.vertices),
                threads),
        triangles_(triangles_of(body.model), threads),
        solids_(body.model, threads) {
    if (is_empty()) return;
    box_ = (triangles_.size() > 0 ? triangles_.box() : points_.box()).grown(radius);
    sections_.emplace(body.model, axis, radius, most_columns);
  }

  /// The first pose of a chunk of the path, and the box of what the body comes near there.
  struct Chunk {
    std::uint32_t first;
    Box box;
  };
  std::vector<Chunk> chunks;

  bool is_empty() const { return points_.size() == 0 && triangles_.size() == 0; }
  /// All places at which something may collide.
  const Box& box() const { return box_; }

  /// What is known of a point that is free.
  struct Free {
    double shift;  ///< at which it is free
    double until;  ///< to which it surely stays so
  };

  /// The least shift from `shift` on at which the point is free, or a shift above `most` where
  /// there is none.
  Free free_from(const PointWay& point, double shift, double most, std::uint32_t& guess) const {
    while (shift <= most) {
      const Vec3 x = point.at(shift);
      if (!box_.contains(x) || is_below_floor(x)) return {shift, shift};
      const Free next = triangles_.size() > 0 ? next_of(triangles_, point, x, shift, guess)
                                              : next_of(points_, point, x, shift, guess);
      if (next.shift == shift) return next;
      shift = std::max(std::min(next.shift, sinks_below_floor(point)), shift + kStep);
    }
    return {shift, shift};
  }

  /// Between which shifts from `shift` to `most` any of some points may collide; the end may be
  /// beyond `most`.
  Interval may_collide(const Bounds& points, double shift, double most) const {
    Interval out{shift, kEndless};
    for (int k = 0; k < 3; ++k) {
      const double lowest = k == 2 && floor_ ? std::max(box_.lo.z, *floor_) : box_.lo[k];
      out.keep(points.most_way[k], points.box.lo[k] - box_.hi[k]);
      out.keep(-points.way[k], lowest - points.box.hi[k]);
    }
    if (out.from > std::min(out.to, most)) return {kEndless, -kEndless};
    keep_sections(points, most, out);
    return out;
  }

  /// Whether any of some points may collide at any of the shifts.
  bool may_collide_within(const Bounds& points, double from, double to) const {
    Box box = moved_on(points.box, points.way, points.most_way, from, to);
    if (!meet(box, box_)) return false;
    if (floor_) box.lo.z = std::max(box.lo.z, *floor_);
    if (box.lo.z > box.hi.z) return false;
    const bool near =
        triangles_.size() > 0 ? comes_near(triangles_, box) : comes_near(points_, box);
    // What does not come near any surface is inside as a whole, or outside.
    return near || solids_.ref().contains(box.centre());
  }

 private:
  void keep_sections(const Bounds& points, double most, Interval& out) const {
    // What moves to the left is passed by what it passes to the right.
    const double slowest = std::min(std::abs(points.way[axis_]), std::abs(points.most_way[axis_]));
    if (!(slowest > 0.1) || (points.way[axis_] > 0) != (points.most_way[axis_] > 0)) return;
    const Box met =
        moved_on(points.box, points.way, points.most_way, out.from, std::min(out.to, most));
    const BodySections::Column column = sections_->column(met);
    if (column.from > column.to) {
      out = {kEndless, -kEndless};
      return;
    }
    const double lo = points.box.lo[axis_], hi = points.box.hi[axis_];
    out.keep(points.most_way[axis_], lo - column.to);
    out.keep(-points.way[axis_], column.from - hi);
    if (out.from > out.to) return;
    const double first = sections_->first_bin(), bin = sections_->bin();
    const auto bin_of = [&](double at) {
      return static_cast<int>(std::clamp(std::floor((at - first) / bin), -1.0, 64.0));
    };
    constexpr double kShare = 1e-9;  // of a bin, for roundings
    const int lowest = bin_of(lo - out.from * points.most_way[axis_] - kShare * bin);
    const int highest = bin_of(hi - out.from * points.way[axis_] + kShare * bin);
    const auto from = [](int first_of) {
      return first_of >= 64 ? 0 : ~std::uint64_t{0} << std::max(0, first_of);
    };
    if ((column.bins & from(lowest) & ~from(highest + 1)) != 0) return;
    const bool to_left = points.way[axis_] > 0;
    const std::uint64_t rest = column.bins & (to_left ? ~from(lowest) : from(highest + 1));
    if (rest == 0) {
      out = {kEndless, -kEndless};
    } else if (to_left) {
      const double upper = first + (64 - std::countl_zero(rest) + kShare) * bin;
      out.keep(points.most_way[axis_], lo - upper);
    } else {
      const double lower = first + (std::countr_zero(rest) - kShare) * bin;
      out.keep(-points.way[axis_], lower - hi);
    }
  }

  bool is_below_floor(const Vec3& x) const { return floor_ && x.z < *floor_; }

  /// The shift from which on a point that sinks lies below the floor; infinity for others. Only a
  /// body that leans against its path makes points sink.
  double sinks_below_floor(const PointWay& point) const {
    if (!floor_ || !(point.way.z > 0)) return kEndless;
    return (point.from.z - *floor_) / point.way.z;
  }

  template <typename Element>
  Free next_of(const ModelTreeOf<Element>& tree, const PointWay& point, const Vec3& x, double shift,
               std::uint32_t& guess) const {
    const auto nearest = tree.nearest(x, guess);
    guess = nearest.element;
    if (nearest.squared_distance < radius_ * radius_) {
      const double next = leaves(point, tree.element(nearest.element), radius_, shift);
      return {next, next};
    }
    const double speed = std::sqrt(rounded_dot(point.way, point.way));
    const double distance = std::sqrt(nearest.squared_distance);
    // A point inside a solid stays inside until it has moved as far as the nearest surface.
    if (!solids_.ref().contains(x)) {
      return {shift, shift + std::max(0.0, (distance - radius_) / speed - kStep)};
    }
    return {shift + distance / speed, shift};
  }

  template <typename Element>
  bool comes_near(const ModelTreeOf<Element>& tree, const Box& box) const {
    const double square = radius_ * radius_ * (1 + kShareOfNumbers);
    return tree.ref().any(
        [&](const Box& part) {
          return least_squared_distance(part, box) < square ? ModelStep::kEnter : ModelStep::kSkip;
        },
        [&](const Element& element) { return least_squared_distance(box, element) < square; });
  }

  double radius_;
  std::optional<double> floor_;
  int axis_;
  ModelTreeOf<Vec3> points_;
  ModelTreeOf<Triangle> triangles_;
  SolidParts solids_;
  Box box_{};
  std::optional<BodySections> sections_;
};

/// A chunk of a body's poses, from which the shifts of a set of points are found.
struct Unit {
  std::uint32_t set, body, first, last;
  /// For each side, the shift up to which its points are known to be free.
  std::array<double, 2> until{-1, -1};
};

/// Finds the least shift at which no point of a set collides at some instants.
class UnitSearch {
 public:
  UnitSearch(const Shape& shape, const PointBlocks& blocks, std::vector<Instant> instants,
             const ShiftQuestion& asked, const Progress& progress)
      : shape_(shape),
        blocks_(blocks),
        instants_(std::move(instants)),
        radius_(asked.radius),
        most_(asked.most),
        progress_(progress) {}

  /// The least shift from `shift` on that frees the points at all instants, or any above `most`.
  double run(double shift) {
    shift_ = shift;
    if (instants_.empty()) return shift_;
    ranges_.push_back(range_of(0, static_cast<std::uint32_t>(instants_.size())));
    push(0, 0);
    for (std::uint64_t steps = 1; shift_ <= most_; ++steps) {
      if (steps % 256 == 0 && progress_.stop_requested()) break;
      if (open_.empty() || open_.front().last <= shift_ + kStep) break;
      std::ranges::pop_heap(open_, {}, &Item::key);
      const Item item = open_.back();
      open_.pop_back();
      const double before = shift_;
      look_at(item);
      if (shift_ > before) reopen();
    }
    return shift_;
  }

  /// The shift up to which the points stay free.
  double until() const { return later_.empty() ? kEndless : later_.front().first; }

 private:
  /// Some instants, seen from the one in the middle: a place that is c away from `centre` in the
  /// world is seen at turn c + [from, to], up to `change` times the lengths |c| on each axis.
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t children = 0;  ///< the first of up to four; 0 where they are not made
    Vec3 centre;
    double turn[3][3], change[3][3];
    Vec3 from, to, way, most_way;
    double deviation = 0;  ///< how far a place of the body moves at most, about

    bool is_one() const { return end - begin == 1; }
  };

  struct Item {
    double last;   ///< the greatest shift at which it may collide
    double first;  ///< the least one, where it waits for it
    std::uint32_t range, node;

    std::tuple<double, std::uint32_t, std::uint32_t> key() const { return {last, range, node}; }
  };

  static void set_turn(const PullBack& back, double (&turn)[3][3]) {
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) turn[k][j] = back.rows[k][j] / back.determinant;
    }
  }

  static Vec3 turned_by(const double (&turn)[3][3], const Vec3& v) {
    Vec3 out{};
    for (int k = 0; k < 3; ++k) out[k] = turn[k][0] * v.x + turn[k][1] * v.y + turn[k][2] * v.z;
    return out;
  }

  void push(std::uint32_t range, std::uint32_t node) {
    const Bounds bounds = seen(ranges_[range], blocks_.box(node));
    const Interval found = shape_.may_collide(bounds, shift_, most_);
    if (found.from > std::min(most_, found.to) || found.to <= shift_ + kStep) return;
    put({found.to, found.from, range, node});
  }

  void put(const Item& item) {
    if (item.first > shift_) {
      later_.push_back({item.first, item});
      std::ranges::push_heap(later_, std::greater{}, &Later::key);
    } else {
      open_.push_back(item);
      std::ranges::push_heap(open_, {}, &Item::key);
    }
  }

  /// Takes up what may collide now that the shift has grown.
  void reopen() {
    while (!later_.empty() && later_.front().first <= shift_) {
      std::ranges::pop_heap(later_, std::greater{}, &Later::key);
      const Item item = later_.back().item;
      later_.pop_back();
      push(item.range, item.node);
    }
  }

  Range range_of(std::uint32_t begin, std::uint32_t end) const {
    Range out{};
    out.begin = begin;
    out.end = end;
    const Instant& middle = instants_[begin + (end - begin) / 2];
    set_turn(middle.back, out.turn);
    // The middle of the body in the world. Any place near it would do.
    const Vec3 at = shape_.box().centre();
    double inverse[3][3];
    const auto& t = out.turn;
    const double determinant = t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) -
                               t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
                               t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0]);
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        const int a = (j + 1) % 3, b = (j + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
        inverse[k][j] = (t[a][c] * t[b][d] - t[a][d] * t[b][c]) / determinant;
      }
    }
    out.centre = middle.back.position + turned_by(inverse, at);
    if (!all_finite(out.centre)) out.centre = middle.back.position;
    out.from = out.way = {kEndless, kEndless, kEndless};
    out.to = out.most_way = {-kEndless, -kEndless, -kEndless};
    for (std::uint32_t i = begin; i < end; ++i) {
      const Instant& instant = instants_[i];
      double turn[3][3];
      set_turn(instant.back, turn);
      const Vec3 offset = turned_by(turn, difference(out.centre, instant.back.position));
      for (int k = 0; k < 3; ++k) {
        out.from[k] = std::min(out.from[k], offset[k]);
        out.to[k] = std::max(out.to[k], offset[k]);
        out.way[k] = std::min(out.way[k], instant.way[k]);
        out.most_way[k] = std::max(out.most_way[k], instant.way[k]);
        for (int j = 0; j < 3; ++j) {
          out.change[k][j] = std::max(out.change[k][j], std::abs(turn[k][j] - out.turn[k][j]));
        }
      }
    }
    const Vec3 half = 0.5 * shape_.box().size();
    for (int k = 0; k < 3; ++k) {
      double deviation = (out.to[k] - out.from[k]) / 2;
      for (int j = 0; j < 3; ++j) deviation += out.change[k][j] * half[j];
      out.deviation = std::max(out.deviation, deviation);
    }
    return out;
  }

  void make_children(std::uint32_t range) {
    if (ranges_[range].children != 0) return;
    const std::uint32_t begin = ranges_[range].begin, count = ranges_[range].end - begin;
    const std::uint32_t parts = std::min(4U, count);
    ranges_[range].children = static_cast<std::uint32_t>(ranges_.size());
    for (std::uint32_t part = 0; part < parts; ++part) {
      ranges_.push_back(range_of(begin + count * part / parts, begin + count * (part + 1) / parts));
    }
  }

  Bounds seen(const Range& range, const Box& box) const {
    const Vec3 lo = difference(box.lo, range.centre), hi = difference(box.hi, range.centre);
    const Vec3 centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
    Bounds out{{}, range.way, range.most_way};
    for (int k = 0; k < 3; ++k) {
      const double* turn = range.turn[k];
      double middle = 0, extent = 0, numbers = 0, change = 0;
      for (int j = 0; j < 3; ++j) {
        const double far = std::abs(centre[j]) + half[j];
        middle += turn[j] * centre[j];
        extent += std::abs(turn[j]) * half[j];
        numbers += std::abs(turn[j]) * far;
        change += range.change[k][j] * far;
      }
      const double slack = change + kShareOfNumbers * (numbers + change + std::abs(range.from[k]) +
                                                       std::abs(range.to[k]));
      out.box.lo[k] = middle - extent + range.from[k] - slack;
      out.box.hi[k] = middle + extent + range.to[k] + slack;
    }
    return out;
  }

  void look_at(const Item& item) {
    const PointBlocks::Node& node = blocks_.node(item.node);
    const Bounds bounds = seen(ranges_[item.range], blocks_.box(item.node));
    const Vec3 half = 0.5 * bounds.box.size();
    const double size = std::max({half.x, half.y, half.z});
    if (size <= 8 * radius_) {
      const double until = shift_ + std::max(radius_, size);
      if (!shape_.may_collide_within(bounds, shift_, until)) {
        return put({item.last, until, item.range, item.node});
      }
    }
    const bool is_block = blocks_.is_block(item.node);
    const Range& range = ranges_[item.range];
    const bool is_short = range.is_one() || range.deviation <= size / 4;
    if (!is_block && is_short) {
      push(item.range, 2 * item.node + 1);
      push(item.range, 2 * item.node + 2);
      return;
    }
    if (is_short || (is_block && range.end - range.begin <= 4)) {
      const double before = shift_, until = look_at_points(range, node);
      if (until <= shift_ && shift_ > before) {
        // A point that was free may be blocked now, because another one has made the shift grow.
        push(item.range, item.node);
      } else if (until < kEndless) {
        put({item.last, std::max(until, std::nextafter(shift_, kEndless)), item.range, item.node});
      }
      return;
    }
    make_children(item.range);
    const std::uint32_t children = ranges_[item.range].children;
    const std::uint32_t count = std::min(4U, ranges_[item.range].end - ranges_[item.range].begin);
    for (std::uint32_t i = 0; i < count; ++i) push(children + i, item.node);
  }

  /// Makes the shift grow until each point was free at all instants. Returns the shift up to which
  /// all of them surely stay free.
  double look_at_points(const Range& range, const PointBlocks::Node& node) {
    double until = kEndless;
    for (std::uint32_t p = node.begin; p < node.end && shift_ <= most_; ++p) {
      const Vec3 place = blocks_.place(p);
      if (!range.is_one()) {
        const Interval found = shape_.may_collide(seen(range, {place, place}), shift_, most_);
        if (found.from > std::min(most_, found.to) || found.to <= shift_ + kStep) continue;
        if (found.from > shift_) {
          until = std::min(until, found.from);
          continue;
        }
      }
      for (std::uint32_t i = range.begin; i < range.end && shift_ <= most_; ++i) {
        look_at_pair(instants_[i], place, until);
      }
    }
    return until;
  }

  void look_at_pair(const Instant& instant, const Vec3& place, double& until) {
    const Vec3 x = instant.back.apply(place);
    const Interval found = shape_.may_collide({{x, x}, instant.way, instant.way}, shift_, most_);
    if (found.from > std::min(most_, found.to) || found.to <= shift_ + kStep) return;
    if (found.from > shift_) {
      until = std::min(until, found.from);
      return;
    }
    const Shape::Free free = shape_.free_from({x, instant.way}, shift_, most_, guess_);
    shift_ = free.shift;
    until = std::min(until, free.until);
  }

  struct Later {
    double first;
    Item item;
    std::tuple<double, std::uint32_t, std::uint32_t> key() const {
      return {first, item.range, item.node};
    }
  };

  const Shape& shape_;
  const PointBlocks& blocks_;
  const std::vector<Instant> instants_;
  const double radius_, most_;
  const Progress& progress_;
  double shift_ = 0;
  std::uint32_t guess_ = 0;
  std::vector<Range> ranges_;
  std::vector<Item> open_;    ///< a heap, the one with the greatest shift first
  std::vector<Later> later_;  ///< a heap, the one with the least shift first
};

/// All bodies, and where they are along the path.
class MovingShapes {
 public:
  explicit MovingShapes(const ShiftQuestion& asked) : asked_(asked) {
    const auto& [bodies, path, left, radius, ways, pairs, most, threads] = asked;
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(left[k]) > std::abs(left[axis])) axis = k;
    }
    const std::size_t all_columns = std::min<std::uint64_t>(kMostColumns, pairs / kPairsOfColumn);
    const std::size_t most_columns =
        std::max(kLeastColumns, all_columns / std::max<std::size_t>(1, bodies.size()));
    for (const Pose& pose : path) {
      Pose turn = pose;
      for (double& t : turn.translation) t = 0;
      longest_left_ = std::max(longest_left_, length(transform(turn, left)));
    }
    for (const MovingBody& body : bodies) {
      shapes_.push_back(std::make_unique<Shape>(body, axis, radius, most_columns, threads));
      Shape& shape = *shapes_.back();
      if (shape.is_empty()) continue;
      std::size_t instants = kChunk;
      for (std::uint32_t i = 0; i < path.size(); ++i) {
        const Pose* pose = body.pose_at(i);
        if (pose == nullptr) continue;
        const Pose* next = ways && i + 1 < path.size() ? body.pose_at(i + 1) : nullptr;
        const Box box = moved(shape.box(), *pose);
        if (instants >= kChunk) {
          shape.chunks.push_back({i, box});
          instants = 0;
        }
        Box& all = shape.chunks.back().box;
        all = all.united(box);
        ++instants;
        if (next == nullptr) continue;
        all = all.united(moved(shape.box(), *next));
        instants += static_cast<std::size_t>(steps_between(*pose, *next, radius)) - 1;
      }
    }
  }

  const ShiftQuestion& asked() const { return asked_; }
  const Shape& operator[](std::size_t body) const { return *shapes_[body]; }

  /// Adds the units of one set of points: the chunks at whose poses a body may come near it.
  void add_units(std::uint32_t number, const PointsToFree& set, std::vector<Unit>& units) const {
    if (set.points == nullptr) return;
    const Box box = set.points->box(0);
    const Vec3 reach = reach_of(box);
    const double most_move = asked_.most * longest_left_;
    // More than roundings can move a place
    const double margin =
        (most_move + asked_.radius + std::max({reach.x, reach.y, reach.z})) * 1e-12 + most_move;
    for (std::uint32_t body = 0; body < shapes_.size(); ++body) {
      const auto& chunks = shapes_[body]->chunks;
      auto chunk = std::ranges::upper_bound(chunks, set.first, {}, &Shape::Chunk::first);
      if (chunk != chunks.begin()) --chunk;
      for (; chunk != chunks.end() && chunk->first <= set.last; ++chunk) {
        if (!meet(chunk->box.grown(margin), box)) continue;
        const bool is_last = chunk + 1 == chunks.end();
        const std::uint32_t last = is_last ? set.last : std::min(set.last, (chunk + 1)->first - 1);
        const std::uint32_t first = std::max(set.first, chunk->first);
        if (first <= last) units.push_back({number, body, first, last});
      }
    }
  }

  /// Adds the instants of a pose, and of the way to the next one.
  void add_instants(std::size_t body, std::uint32_t i, bool with_way, double direction,
                    std::vector<Instant>& out) const {
    const Pose* pose = asked_.bodies[body].pose_at(i);
    if (pose == nullptr) return;
    add_instant(*pose, asked_.path[i], direction, out);
    const Pose* next = with_way ? asked_.bodies[body].pose_at(i + 1) : nullptr;
    if (next == nullptr) return;
    const int steps = steps_between(*pose, *next, asked_.radius);
    for (int step = 1; step < steps; ++step) {
      const double part = static_cast<double>(step) / steps;
      // Seen from a pose that also shrinks, places are farther away than they are, so a shift that
      // is computed from it is never too long.
      add_instant(pose_on_chords(*pose, *next, part),
                  pose_on_chords(asked_.path[i], asked_.path[i + 1], part), direction, out);
    }
  }

 private:
  void add_instant(const Pose& pose, const Pose& of_path, double direction,
                   std::vector<Instant>& out) const {
    const double* r = of_path.rotation;
    const Vec3& l = asked_.left;
    const Vec3 left{r[0] * l.x + r[1] * l.y + r[2] * l.z, r[3] * l.x + r[4] * l.y + r[5] * l.z,
                    r[6] * l.x + r[7] * l.y + r[8] * l.z};
    Pose turn = pose;
    for (double& t : turn.translation) t = 0;
    const Vec3 way = pulled_back(turn, left);
    // Otherwise the matrix of the pose is not a rotation.
    if (!(rounded_dot(way, way) > 0) || !all_finite(way)) return;
    out.push_back({PullBack(pose), direction * way});
  }

  const ShiftQuestion& asked_;
  double longest_left_ = 0;                     ///< the greatest length of the left axis of a pose
  std::vector<std::unique_ptr<Shape>> shapes_;  ///< one for each body
};

/// The shifts of some sets of points, round by round. Each unit of a round begins at the shift of
/// the round before and passes only blocked shifts, so the greatest of their shifts passes only
/// blocked shifts too, and it depends neither on threads nor on the order of units.
class Round {
 public:
  Round(const MovingShapes& shapes, std::span<const PointsToFree> sets, std::vector<Unit> units,
        Progress& progress)
      : shapes_(shapes),
        asked_(shapes.asked()),
        sets_(sets),
        progress_(progress),
        units_(std::move(units)),
        shift_(2 * sets.size()) {}

  std::vector<SideShifts> run() {
    find_first_bounds();
    std::vector<std::size_t> open;  // twice the unit, and one more for the right
    while (!progress_.stop_requested()) {
      open.clear();
      for (std::size_t i = 0; i < 2 * units_.size(); ++i) {
        const Unit& unit = units_[i / 2];
        const double shift = shift_[2 * unit.set + i % 2];
        if (shift <= asked_.most && unit.until[i % 2] <= shift) open.push_back(i);
      }
      if (open.empty()) break;
      run_units(open);
    }
    std::vector<SideShifts> out(sets_.size());
    const auto found = [&](std::size_t side) {
      return shift_[side] <= asked_.most ? std::optional(shift_[side]) : std::nullopt;
    };
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {found(2 * i), found(2 * i + 1)};
    return out;
  }

 private:
  static double direction_of(std::size_t side) { return side % 2 == 0 ? 1 : -1; }

  void run_units(const std::vector<std::size_t>& open) {
    std::vector<std::atomic<bool>> blocked(shift_.size());
    std::vector<double> found(open.size());
    for_each_parallel(open.size(), [&](std::size_t i) {
      Unit& unit = units_[open[i] / 2];
      const std::size_t side = 2 * unit.set + open[i] % 2;
      found[i] = shift_[side];
      if (progress_.stop_requested() || blocked[side].load(std::memory_order_relaxed)) return;
      std::vector<Instant> instants;
      const std::uint32_t last = sets_[unit.set].last;
      for (std::uint32_t pose = unit.first; pose <= unit.last; ++pose) {
        shapes_.add_instants(unit.body, pose, asked_.ways && pose < last, direction_of(side),
                             instants);
      }
      UnitSearch search(shapes_[unit.body], *sets_[unit.set].points, std::move(instants), asked_,
                        progress_);
      found[i] = search.run(shift_[side]);
      unit.until[side % 2] = search.until();
      // Whatever the other units find, the longest shift is not enough.
      if (found[i] > asked_.most) blocked[side].store(true, std::memory_order_relaxed);
    });
    for (std::size_t i = 0; i < open.size(); ++i) {
      double& shift = shift_[2 * units_[open[i] / 2].set + open[i] % 2];
      shift = std::max(shift, found[i]);
    }
  }

  /// Finds shifts to begin with from a few poses of each long range.
  void find_first_bounds() {
    for_each_parallel(shift_.size(), [&](std::size_t side) {
      const PointsToFree& set = sets_[side / 2];
      if (set.points == nullptr) return;
      const std::uint64_t poses = std::uint64_t{set.last} - set.first + 1;
      if (poses <= kChunk) return;
      for (std::size_t body = 0; body < asked_.bodies.size(); ++body) {
        if (shapes_[body].is_empty()) continue;
        std::vector<Instant> instants;
        const std::uint64_t count = std::min<std::uint64_t>(kFirstPoses, poses / 4);
        for (std::uint64_t i = 0; i < count; ++i) {
          const auto pose =
              static_cast<std::uint32_t>(set.first + (2 * i + 1) * poses / (2 * count));
          shapes_.add_instants(body, pose, false, direction_of(side), instants);
        }
        UnitSearch search(shapes_[body], *set.points, std::move(instants), asked_, progress_);
        shift_[side] = search.run(shift_[side]);
      }
    });
  }

  const MovingShapes& shapes_;
  const ShiftQuestion& asked_;
  std::span<const PointsToFree> sets_;
  Progress& progress_;
  std::vector<Unit> units_;
  std::vector<double> shift_;  ///< of each set to the left and to the right
};

}  // namespace

std::vector<SideShifts> least_shifts(const ShiftQuestion& asked, std::span<const PointsToFree> sets,
                                     Progress& progress) {
  const MovingShapes shapes(asked);
  std::vector<SideShifts> out;
  for (std::size_t begin = 0, end = 0; begin < sets.size(); begin = end) {
    std::vector<Unit> units;
    for (; end < sets.size() && units.size() < kMostUnits; ++end) {
      shapes.add_units(static_cast<std::uint32_t>(end - begin), sets[end], units);
    }
    Round round(shapes, sets.subspan(begin, end - begin), std::move(units), progress);
    std::ranges::copy(round.run(), std::back_inserter(out));
    throw_if_stopped(progress);
    progress.advance(end - begin);
  }
  return out;
}

}  // namespace clearway
