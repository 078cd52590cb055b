#include "findings/match_conflicts.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "findings/grouped_points.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

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
