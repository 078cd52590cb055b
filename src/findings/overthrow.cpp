#include "findings/overthrow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "clearway/vec3.hpp"
#include "core/geometry/predicate.hpp"
#include "findings/row_pieces.hpp"
#include "findings/touched_first.hpp"

namespace clearway {
namespace {

/// Metres along the path by which a cross-section may miss a place that lies in it.
constexpr double kInSection = 1e-6;
/// Radians: a path that turns less than this below a body is straight, and has no outside.
constexpr double kStraight = 1e-6;
constexpr int kMostStepsOfOverthrow = 100;

/// The place of the path whose cross-section a place of a body lies in.
struct Foot {
  PathStations::Place at;
  Vec3 along;      ///< direction of the path, of unit length
  Vec3 up;         ///< up at the path, at a right angle to `along`, of unit length
  double lateral;  ///< metres from the path to the place, to the left of `along`
};

/// Finds the feet of one place of a body, pose after pose. Each search begins where the last one
/// ended, because a path may come back to where it was.
class FootFinder {
 public:
  FootFinder(const PathStations& path, std::span<const Vec3> directions, Axis up)
      : path_(path), directions_(directions), up_(up) {}

  /// The way of the path on which the next place may have its foot.
  std::size_t next_way(const Vec3& place) {
    if (!way_) way_ = nearest(place);
    std::size_t way = *way_;
    const std::size_t last = directions_.size() - 1;
    while (way < last && ahead(place, way + 1) >= 0) ++way;
    while (way > 0 && ahead(place, way) < 0) --way;
    way_ = way;
    return way;
  }

  /// The foot of a place on the way that next_way() gave for it. Thread safe.
  std::optional<Foot> foot_on(const Vec3& place, std::size_t way) const {
    const double here = ahead(place, way);
    if (way + 1 == directions_.size() || here < 0) {
      return std::abs(here) <= kInSection ? foot(place, {way, 0}) : std::nullopt;
    }
    return foot(place, {way, root(place, way)});
  }

 private:
  std::size_t nearest(const Vec3& place) const {
    std::size_t out = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < path_.poses().size(); ++i) {
      const double distance = length(place - path_.poses()[i].position());
      if (!(distance < least)) continue;
      least = distance;
      out = i;
    }
    return out;
  }

  /// Metres by which a place lies ahead of the cross-section at pose i.
  double ahead(const Vec3& place, std::size_t i) const {
    return dot(place - path_.poses()[i].position(), directions_[i]);
  }

  double ahead_of(const Vec3& place, const PathStations::Place& at) const {
    return dot(place - path_.position_at(at), unit(path_.direction_at(at)));
  }

  static Vec3 unit(const Vec3& v) { return (1 / length(v)) * v; }

  /// The parameter of a way at which the place lies in the cross-section, by false position with
  /// halved values (the Illinois algorithm), and by bisection where that is slow.
  double root(const Vec3& place, std::size_t way) const {
    double from = 0, to = 1, at_from = ahead(place, way), at_to = ahead(place, way + 1);
    for (int step = 0; step < kMostStepsOfOverthrow && at_from > 0; ++step) {
      double t =
          step % 3 == 2 ? from + (to - from) / 2 : from + (to - from) * at_from / (at_from - at_to);
      if (!(t > from && t < to)) t = from + (to - from) / 2;
      if (!(t > from && t < to)) break;
      const double here = ahead_of(place, {way, t});
      if (here >= 0) {
        from = t;
        at_from = here;
        at_to /= 2;
      } else {
        to = t;
        at_to = here;
        at_from /= 2;
      }
      if (std::abs(here) < 1e-12) return t;
    }
    return from;
  }

  std::optional<Foot> foot(const Vec3& place, const PathStations::Place& at) const {
    Foot out{at, unit(path_.direction_at(at)), {}, 0};
    const Vec3 from = place - path_.position_at(at);
    if (!(std::abs(dot(from, out.along)) <= kInSection)) return std::nullopt;  // it turns back here
    const Vec3 up = direction_ahead(path_.pose_at(at), up_);
    const Vec3 level = up - dot(up, out.along) * out.along;
    if (!(length(level) > 0)) return std::nullopt;
    out.up = unit(level);
    out.lateral = dot(from, cross(out.up, out.along));
    return out;
  }

  const PathStations& path_;
  std::span<const Vec3> directions_;
  Axis up_;
  std::optional<std::size_t> way_;
};

bool is_before(const PathStations::Place& a, const PathStations::Place& b) {
  return a.way != b.way ? a.way < b.way : a.t < b.t;
}

/// The angle in radians by which the path turns to the left from the first to the last of the feet;
/// none where there are fewer than two.
std::optional<double> turn_between(std::span<const std::optional<Foot>> feet) {
  const Foot* first = nullptr;
  const Foot* last = nullptr;
  for (const std::optional<Foot>& foot : feet) {
    if (!foot) continue;
    if (first == nullptr || is_before(foot->at, first->at)) first = &*foot;
    if (last == nullptr || is_before(last->at, foot->at)) last = &*foot;
  }
  if (first == last) return std::nullopt;
  return std::atan2(dot(cross(first->along, last->along), first->up),
                    dot(first->along, last->along));
}

/// The greater of two values, of which either may be missing.
void keep_greatest(double value, std::optional<double>& greatest) {
  if (!greatest || value > *greatest) greatest = value;
}

std::vector<Vec3> directions_of(const PathStations& path) {
  std::vector<Vec3> out;
  out.reserve(path.poses().size());
  for (std::size_t i = 0; i < path.poses().size(); ++i) {
    const Vec3 direction = path.direction_at({i, 0});
    out.push_back((1 / length(direction)) * direction);
  }
  return out;
}

}  // namespace

std::vector<Overthrow> overthrow_of(const PathStations& path, const MovingBody& body,
                                    const Box& box, Axis forward, Axis up) {
  std::vector<Overthrow> out(body.poses.size());
  if (!(path.length() > 0)) return out;
  const std::vector<Vec3> directions = directions_of(path);
  const Box seen = turned(box, forward, up);
  const std::array<double, 3> places{seen.lo.x, seen.lo.x + (seen.hi.x - seen.lo.x) / 2, seen.hi.x};
  std::array<FootFinder, 3> finders{FootFinder(path, directions, up),
                                    FootFinder(path, directions, up),
                                    FootFinder(path, directions, up)};
  const auto place_at = [&](std::size_t i, std::size_t k) {
    return body.poses[i].position() + places[k] * direction_ahead(body.poses[i], forward);
  };
  std::vector<std::array<std::size_t, 3>> ways(out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) ways[i][k] = finders[k].next_way(place_at(i, k));
  }
  const auto measure = [&](std::size_t i) {
    std::array<std::optional<Foot>, 3> feet;
    for (std::size_t k = 0; k < 3; ++k) feet[k] = finders[k].foot_on(place_at(i, k), ways[i][k]);
    const std::optional<double> turn = turn_between(feet);
    if (!turn) return;
    const bool straight = std::abs(*turn) <= kStraight;
    const auto inwards = [&](const Foot& foot) { return *turn > 0 ? foot.lateral : -foot.lateral; };
    for (const std::size_t end : {std::size_t{0}, std::size_t{2}}) {
      if (!feet[end]) continue;
      keep_greatest(straight ? std::abs(feet[end]->lateral) : -inwards(*feet[end]), out[i].end);
    }
    if (!feet[1]) return;
    out[i].middle = straight ? std::abs(feet[1]->lateral) : inwards(*feet[1]);
  };
  in_pieces(out.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) measure(i);
  });
  return out;
}

}  // namespace clearway
