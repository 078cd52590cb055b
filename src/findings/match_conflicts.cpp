#include "findings/match_conflicts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "io/result/result.hpp"

namespace clearway {
namespace {

struct NumberedPoint {
  Vec3 xyz;
  std::uint32_t conflict;  ///< 0 for a point of a small group
};

/// A cube of a regular grid.
struct GridCube {
  std::int64_t x, y, z;
  friend bool operator==(const GridCube&, const GridCube&) = default;
};

struct GridCubeHash {
  std::size_t operator()(const GridCube& c) const {
    std::uint64_t hash = 0;
    for (const std::int64_t one : {c.x, c.y, c.z}) {
      hash = (hash ^ static_cast<std::uint64_t>(one)) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// Points in cubes at least as long as the gap, so that every point within the gap is in the same
/// cube or in one beside it.
class Places {
 public:
  explicit Places(double gap) : gap_(gap), edge_(std::max(gap, kShortestEdge)) {}

  GridCube cube_of(const Vec3& p) const { return {along(p.x), along(p.y), along(p.z)}; }

  /// Marks the cubes around a place of b, so that the points of a there are kept.
  void want(const Vec3& p) {
    each_beside(p, [&](const GridCube& cube) { points_.try_emplace(cube); });
  }
  void add(const NumberedPoint& point) {
    const auto cube = points_.find(cube_of(point.xyz));
    if (cube != points_.end()) cube->second.push_back(point);
  }
  /// The conflict of a point of a within the gap: 0 where only points of small groups are near, and
  /// nothing where no point is.
  std::optional<std::uint32_t> near(const Vec3& p) const {
    std::optional<std::uint32_t> found;
    each_beside(p, [&](const GridCube& cube) {
      const auto there = points_.find(cube);
      if (there == points_.end()) return;
      for (const NumberedPoint& other : there->second) {
        const double x = p.x - other.xyz.x, y = p.y - other.xyz.y, z = p.z - other.xyz.z;
        if (x * x + y * y + z * z > gap_ * gap_) continue;
        found = std::max(found.value_or(0), other.conflict);
      }
    });
    return found;
  }

 private:
  std::int64_t along(double at) const { return static_cast<std::int64_t>(std::floor(at / edge_)); }
  template <typename Visit>
  void each_beside(const Vec3& p, Visit visit) const {
    const GridCube own = cube_of(p);
    for (int i = 0; i < 27; ++i) {
      visit(GridCube{own.x + i % 3 - 1, own.y + i / 3 % 3 - 1, own.z + i / 9 - 1});
    }
  }

  static constexpr double kShortestEdge = 1e-3;  // so that the index of a cube fits its integers
  double gap_, edge_;
  std::unordered_map<GridCube, std::vector<NumberedPoint>, GridCubeHash> points_;
};

/// Calls visit(point) for each row of a result.
template <typename Visit>
void for_each_point(const GroupedResult& of, Visit visit) {
  RowStream<Collisions> stream(of.result.reader());
  std::size_t row = 0;
  for (Collisions rows; stream.read(rows);) {
    for (const Vec3& p : rows.xyz) visit(NumberedPoint{p, of.conflict_of[row++]});
  }
}

/// The small groups of a result, found by place.
class SmallPlaces {
 public:
  explicit SmallPlaces(const std::vector<SmallGroup>& groups) : groups_(groups) {
    for (std::size_t i = 0; i < groups.size(); ++i) {
      order_.push_back(i);
      longest_ = std::max(longest_, groups[i].box.hi.x - groups[i].box.lo.x);
    }
    std::ranges::sort(order_, {}, [this](std::size_t i) { return groups_[i].box.lo.x; });
  }

  /// Marks the small groups whose boxes contain the place.
  void mark(const Vec3& p, std::vector<bool>& marks) const {
    auto next = std::ranges::lower_bound(order_, p.x - longest_ - kSlack, {},
                                         [this](std::size_t i) { return groups_[i].box.lo.x; });
    for (; next != order_.end() && groups_[*next].box.lo.x <= p.x; ++next) {
      if (groups_[*next].box.contains(p)) marks[*next] = true;
    }
  }

 private:
  const std::vector<SmallGroup>& groups_;
  std::vector<std::size_t> order_;
  static constexpr double kSlack = 1e-3;  // more than the rounding of a difference of coordinates
  double longest_ = 0;
};

/// How the points of a conflict of b lie with respect to the conflicts of a.
struct Neighbours {
  bool all = true;                              ///< whether each point is near a conflict of a
  std::map<std::uint32_t, std::uint64_t> near;  ///< number of points near each conflict of a
};

}  // namespace

std::vector<std::size_t> match_points(const GroupedResult& a, const GroupedResult& b, double gap,
                                      ConflictMatch& match) {
  std::vector<NumberedPoint> open;
  std::vector<bool> added(b.conflicts.listed.size() + 1);
  for (const std::uint32_t id : match.added) added[id] = true;
  added[0] = true;  // points of small groups count too
  Places places(gap);
  for_each_point(b, [&](const NumberedPoint& point) {
    if (!added[point.conflict]) return;
    open.push_back(point);
    places.want(point.xyz);
  });
  if (open.empty()) return {};
  for_each_point(a, [&](const NumberedPoint& point) { places.add(point); });
  std::map<std::uint32_t, Neighbours> of_added;
  const SmallPlaces small(b.conflicts.small);
  std::vector<bool> is_new(b.conflicts.small.size());
  for (const NumberedPoint& point : open) {
    const std::optional<std::uint32_t> near = places.near(point.xyz);
    if (point.conflict > 0) {
      Neighbours& all = of_added[point.conflict];
      all.all = all.all && near.value_or(0) > 0;
      ++all.near[near.value_or(0)];
    } else if (!near) {
      small.mark(point.xyz, is_new);
    }
  }
  for (const auto& [id, neighbours] : of_added) {
    if (!neighbours.all) continue;
    const auto most =
        std::ranges::max_element(neighbours.near, {}, [](const auto& one) { return one.second; });
    match.same.emplace_back(most->first, id);
    std::erase(match.added, id);
  }
  std::ranges::sort(match.same);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < is_new.size(); ++i) {
    if (is_new[i]) out.push_back(i);
  }
  return out;
}

namespace {

struct Candidate {
  /// Volume that the grown boxes have in common.
  double volume;
  /// Where the volume is 0, the sum of the sides that the boxes themselves have in common.
  double sides;
  /// Ids of the two conflicts.
  std::uint32_t a, b;

  bool before(const Candidate& other) const {
    return std::tuple(-volume, -sides, a, b) <
           std::tuple(-other.volume, -other.sides, other.a, other.b);
  }
};

double common_volume(const Box& a, const Box& b) {
  double volume = 1;
  for (int k = 0; k < 3; ++k) {
    const double side = std::min(a.hi[k], b.hi[k]) - std::max(a.lo[k], b.lo[k]);
    if (!(side > 0)) return 0;
    volume *= side;
  }
  return volume;
}

/// The sum of the sides that two boxes share, 0 where they touch in a point; nothing where they do
/// not touch. Beside large coordinates a small gap is rounded away, and flat boxes share no volume.
std::optional<double> common_sides(const Box& a, const Box& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double side = std::min(a.hi[k], b.hi[k]) - std::max(a.lo[k], b.lo[k]);
    if (!(side >= 0)) return std::nullopt;
    sum += side;
  }
  return sum;
}

/// Indices of the conflicts in the order of their boxes along x.
std::vector<std::uint32_t> along_x(const Conflicts& conflicts) {
  std::vector<std::uint32_t> order(conflicts.listed.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {},
                           [&](std::uint32_t i) { return conflicts.listed[i].box.lo.x; });
  return order;
}

/// All pairs that overlap, found by a sweep along x: for each conflict of a, those of b are looked
/// at that begin before its box ends, and not farther before its box than the longest box of b
/// reaches.
std::vector<Candidate> candidates(const Conflicts& a, const Conflicts& b, double gap) {
  const std::vector<std::uint32_t> order = along_x(b);
  double longest = 0;
  for (const Conflict& c : b.listed) longest = std::max(longest, c.box.hi.x - c.box.lo.x);
  std::vector<Candidate> out;
  for (const Conflict& in_a : a.listed) {
    const Box box = in_a.box.grown(gap);
    const double from = box.lo.x - longest - 2 * gap;
    auto next = std::ranges::lower_bound(order, from, {},
                                         [&](std::uint32_t i) { return b.listed[i].box.lo.x; });
    for (; next != order.end(); ++next) {
      const Conflict& in_b = b.listed[*next];
      const Box other = in_b.box.grown(gap);
      if (other.lo.x > box.hi.x) break;
      const double volume = common_volume(box, other);
      const std::optional<double> sides = volume > 0 ? 0 : common_sides(in_a.box, in_b.box);
      if (sides) out.push_back({volume, *sides, in_a.id, in_b.id});
    }
  }
  std::ranges::sort(out, [](const Candidate& x, const Candidate& y) { return x.before(y); });
  return out;
}

std::vector<std::uint32_t> unmatched(const std::vector<bool>& matched) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 1; id < matched.size(); ++id) {
    if (!matched[id]) ids.push_back(id);
  }
  return ids;
}

}  // namespace

ConflictMatch match_conflicts(const Conflicts& a, const Conflicts& b, double gap) {
  std::vector<bool> in_a(a.listed.size() + 1), in_b(b.listed.size() + 1);
  ConflictMatch out;
  for (const Candidate& candidate : candidates(a, b, gap)) {
    if (in_a[candidate.a] || in_b[candidate.b]) continue;
    in_a[candidate.a] = in_b[candidate.b] = true;
    out.same.emplace_back(candidate.a, candidate.b);
  }
  std::ranges::sort(out.same);
  out.gone = unmatched(in_a);
  out.added = unmatched(in_b);
  return out;
}

}  // namespace clearway
