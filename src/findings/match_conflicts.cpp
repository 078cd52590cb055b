#include "findings/match_conflicts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "io/result/result.hpp"

namespace clearway {
namespace {

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

/// A point of a result with its conflict; 0 for a point of no listed conflict.
struct NumberedPoint {
  Vec3 xyz;
  std::uint32_t conflict;
};

/// Points in cubes. Two points in one cube are within the gap, but for roundings, and two points
/// within the gap are at most two cubes apart on each axis. So most points find one near them in
/// their own cube.
class Places {
 public:
  explicit Places(double gap)
      : limit_(gap + kRounding), edge_(std::max(kShareOfGap * gap, kShortestEdge)) {}

  void add(const NumberedPoint& point) { cubes_[cube_of(point.xyz)].push_back(point); }

  /// The conflict of a point within the gap: 0 where only points of no listed conflict are near,
  /// and nothing where no point is. Not safe to call from several threads.
  std::optional<std::uint32_t> near(const Vec3& p) {
    bool any = false;
    for (const Points* points : around(cube_of(p))) {
      for (const NumberedPoint& other : *points) {
        const double x = p.x - other.xyz.x, y = p.y - other.xyz.y, z = p.z - other.xyz.z;
        if (x * x + y * y + z * z > limit_ * limit_) continue;
        if (other.conflict > 0) return other.conflict;
        any = true;
      }
    }
    return any ? std::optional<std::uint32_t>(0) : std::nullopt;
  }

 private:
  using Points = std::vector<NumberedPoint>;

  std::int64_t along(double at) const { return static_cast<std::int64_t>(std::floor(at / edge_)); }
  GridCube cube_of(const Vec3& p) const { return {along(p.x), along(p.y), along(p.z)}; }

  /// The points of the cube and of those at most two away, beginning with its own. They are cached
  /// because consecutive points of a result mostly lie in few cubes. Valid until the next call.
  const std::vector<const Points*>& around(const GridCube& own) {
    if (around_.size() >= kMostCached) around_.clear();
    const auto [found, is_new] = around_.try_emplace(own);
    std::vector<const Points*>& out = found->second;
    if (!is_new) return out;
    const auto take = [&](const GridCube& cube) {
      const auto points = cubes_.find(cube);
      if (points != cubes_.end()) out.push_back(&points->second);
    };
    take(own);
    for (int i = 0; i < 125; ++i) {
      const GridCube cube{own.x + i % 5 - 2, own.y + i / 5 % 5 - 2, own.z + i / 25 - 2};
      if (!(cube == own)) take(cube);
    }
    return out;
  }

  static constexpr double kShareOfGap = 0.577;  // below the root of 1/3
  // So that the index of a cube fits its integers.
  static constexpr double kShortestEdge = 1e-3;
  // More than the roundings of coordinates, so that points a whole gap apart are near, and less
  // than the steps of any scan.
  static constexpr double kRounding = 1e-6;
  // Cubes whose neighbours are cached. Each takes at most about 1 KiB.
  static constexpr std::size_t kMostCached = std::size_t{1} << 14;
  double limit_, edge_;
  std::unordered_map<GridCube, Points, GridCubeHash> cubes_;
  std::unordered_map<GridCube, std::vector<const Points*>, GridCubeHash> around_;
};

/// A row of the colliding or the near points of a result.
struct PointRow : NumberedPoint {
  std::uint64_t source;
  std::uint32_t first_pose, last_pose;
};

template <typename Rows, typename Visit>
void for_each_row(const GroupedResult& of, std::span<const std::uint32_t> conflict_of,
                  Visit visit) {
  RowStream<Rows> stream(of.result.reader());
  std::size_t row = 0;
  for (Rows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i, ++row) {
      std::uint32_t last = rows.first_pose[i];
      if constexpr (requires { rows.last_pose; }) last = rows.last_pose[i];
      visit(PointRow{{rows.xyz[i], conflict_of[row]}, rows.source[i], rows.first_pose[i], last});
    }
  }
}

/// Calls visit(row) for each colliding point of a result, and for each near one.
template <typename Visit>
void for_each_point(const GroupedResult& of, Visit visit) {
  for_each_row<Collisions>(of, of.conflict_of, visit);
  for_each_row<Nearby>(of, of.conflict_of_near, visit);
}

Places places_of(const GroupedResult& of, double gap) {
  Places places(gap);
  for_each_point(of, [&](const PointRow& row) { places.add(row); });
  return places;
}

/// Adds points that do not collide, but have a clearance of at most `most`.
void add_just_free(const GroupedResult& of, double most, Places& places) {
  RowStream<Clearances> stream(of.result.reader());
  const double radius = of.result.parameters().radius;
  for (Clearances rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.xyz.size(); ++i) {
      if (rows.distance[i] < radius || rows.distance[i] > most) continue;
      places.add({rows.xyz[i], 0});
    }
  }
}

void add_to(ConflictPart& part, const PointRow& row) {
  if (part.points == 0) {
    part = {row.conflict, 0, row.source, {row.xyz, row.xyz}, row.first_pose, row.last_pose};
  }
  ++part.points;
  part.source = std::min(part.source, row.source);
  part.box = part.box.united({row.xyz, row.xyz});
  part.first_pose = std::min(part.first_pose, row.first_pose);
  part.last_pose = std::max(part.last_pose, row.last_pose);
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

/// How the points of one conflict lie with respect to the other result.
struct Neighbours {
  std::uint64_t points = 0;
  std::map<std::uint32_t, std::uint64_t> near;  ///< number of points near each of its conflicts
  ConflictPart alone;                           ///< the points that it has none near
  std::set<std::string> reasons;                ///< why it has not searched them

  /// The conflict that most points are near, the first one of several; 0 where none is.
  std::uint32_t partner() const {
    const auto most =
        std::ranges::max_element(near, {}, [](const auto& one) { return one.second; });
    return most == near.end() ? 0 : most->first;
  }
};

/// The neighbours of each conflict of `of`, by its id. alone(row): called for each point of a
/// listed conflict or of none that has no point of the places near.
template <typename Alone>
std::vector<Neighbours> neighbours_of(const GroupedResult& of, Places& places, Alone alone) {
  std::vector<Neighbours> all(of.conflicts.listed.size() + 1);
  for_each_point(of, [&](const PointRow& row) {
    Neighbours& own = all[row.conflict];
    ++own.points;
    const std::optional<std::uint32_t> near = places.near(row.xyz);
    if (near.value_or(0) > 0) ++own.near[*near];
    if (near) return;
    add_to(own.alone, row);
    alone(row, own);
  });
  return all;
}

/// Sets what became of the conflicts of a.
void judge_a(const std::vector<Neighbours>& of_a, ConflictMatch& out) {
  for (std::uint32_t id = 1; id < of_a.size(); ++id) {
    const Neighbours& own = of_a[id];
    const std::uint32_t partner = own.partner();
    if (partner > 0) out.same.emplace_back(id, partner);
    if (!own.reasons.empty()) {
      out.not_searched.push_back({own.alone, {own.reasons.begin(), own.reasons.end()}});
    } else if (own.alone.points == own.points) {
      out.gone.push_back(id);
    } else if (partner == 0) {
      out.shrunk.push_back(id);
    }
  }
}

/// Sets where the conflicts of b come from.
void judge_b(const std::vector<Neighbours>& of_b, ConflictMatch& out) {
  for (std::uint32_t id = 1; id < of_b.size(); ++id) {
    const Neighbours& own = of_b[id];
    const std::uint32_t partner = own.partner();
    if (partner == 0) {
      out.added.push_back(id);
      continue;
    }
    out.same.emplace_back(partner, id);
    if (own.alone.points > 0) out.grown.push_back(own.alone);
  }
}

}  // namespace

ConflictMatch match_conflicts(const GroupedResult& a, const GroupedResult& b, double gap,
                              double tolerance) {
  ConflictMatch out;
  {
    Places places = places_of(b, gap);
    const SearchedPlaces searched(a.result, a.poses, b.result, b.poses);
    judge_a(neighbours_of(a, places,
                          [&](const PointRow& row, Neighbours& own) {
                            searched.add_reasons(row.xyz, row.first_pose, row.last_pose,
                                                 own.reasons);
                          }),
            out);
  }
  Places places = places_of(a, gap);
  add_just_free(a, a.result.parameters().radius + tolerance, places);
  const SmallPlaces small(b.conflicts.small);
  std::vector<bool> is_new(b.conflicts.small.size());
  judge_b(neighbours_of(b, places,
                        [&](const PointRow& row, Neighbours&) {
                          if (row.conflict == 0) small.mark(row.xyz, is_new);
                        }),
          out);
  std::ranges::sort(out.same);
  out.same.erase(std::unique(out.same.begin(), out.same.end()), out.same.end());
  for (std::size_t i = 0; i < is_new.size(); ++i) {
    if (is_new[i]) out.small.push_back(i);
  }
  return out;
}

}  // namespace clearway
