#include "core/trajectory/line/ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cloud/scan_points.hpp"

namespace clearway {
namespace {

constexpr double kReach = 1;     ///< metres up and down
constexpr double kWindow = 0.1;  ///< metres of height
constexpr double kShareOfFullest = 0.2;
/// A rise between two grounds is believed up to kRise and this share of the way between them.
constexpr double kRise = 0.1, kSlope = 0.15;

/// Heights of points near a place of the line, in metres.
class Strips {
 public:
  Strips(const PackedCloud& cloud, double left, double metre)
      : cloud_(cloud),
        points_(cloud, std::numeric_limits<std::uint32_t>::max()),
        left_(left),
        metre_(metre) {}

  /// Fills `heights` with those in the strip at a place, within kReach of `about` where it is
  /// given.
  void collect(const PlanPlace& place, const std::optional<double>& about,
               std::vector<double>& heights) const {
    heights.clear();
    if (cloud_.tree().empty()) return;
    const double c = std::cos(place.heading), s = std::sin(place.heading);
    const double base = about.value_or(0) * metre_;
    const Pose pose{{c, -s, 0, s, c, 0, 0, 0, 1},
                    {place.at.real() * metre_, place.at.imag() * metre_, base}};
    const double along = kGroundStripLength / 2 * metre_, across = kGroundStripWidth / 2 * metre_;
    Box strip{{-along, left_ * metre_ - across, -kReach * metre_},
              {along, left_ * metre_ + across, kReach * metre_}};
    if (!about) {
      const Box all = position_box(cloud_.quantisation(), cloud_.tree()[0].box);
      strip.lo.z = all.lo.z;
      strip.hi.z = all.hi.z;
    }
    points_.visit(strip, pose, [&](const Vec3& point, auto...) {
      heights.push_back((point.z + base) / metre_);
      return true;
    });
  }

 private:
  const PackedCloud& cloud_;
  ScanPoints points_;
  double left_, metre_;
};

}  // namespace

std::optional<double> ground_among(std::vector<double>& heights) {
  std::ranges::sort(heights);
  // For each height, the points of the window that starts with it.
  std::vector<std::size_t> counts(heights.size());
  std::size_t end = 0, fullest = 0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    while (end < heights.size() && heights[end] <= heights[i] + kWindow) ++end;
    counts[i] = end - i;
    fullest = std::max(fullest, counts[i]);
  }
  const double enough = std::max(static_cast<double>(kFewestGroundPoints),
                                 kShareOfFullest * static_cast<double>(fullest));
  const auto is_enough = [&](std::size_t count) { return static_cast<double>(count) >= enough; };
  const auto lowest =
      static_cast<std::size_t>(std::ranges::find_if(counts, is_enough) - counts.begin());
  if (lowest == counts.size()) return std::nullopt;
  std::size_t best = lowest;
  for (std::size_t i = lowest; i < counts.size() && heights[i] <= heights[lowest] + kWindow; ++i) {
    if (counts[i] > counts[best]) best = i;
  }
  const std::size_t middle = best + counts[best] / 2;
  if (counts[best] % 2 != 0) return heights[middle];
  return heights[middle - 1] + (heights[middle] - heights[middle - 1]) / 2;
}

std::vector<double> GroundSide::bridged(std::span<const GroundPlace> all, std::size_t from,
                                        std::size_t to) const {
  std::vector<double> out;
  std::size_t next = 0;
  for (std::size_t place = from; place <= to; ++place) {
    while (places[next] < place) ++next;
    if (places[next] == place) {
      out.push_back(heights[next]);
      continue;
    }
    const double begin = all[places[next - 1]].station, end = all[places[next]].station;
    const double share = (all[place].station - begin) / (end - begin);
    out.push_back(heights[next - 1] + share * (heights[next] - heights[next - 1]));
  }
  return out;
}

GroundSide find_ground(const PackedCloud& cloud, std::span<const GroundPlace> places,
                       const GroundSearch& search) {
  const Strips strips(cloud, search.left, search.metre);
  GroundSide side;
  std::vector<double> heights;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GroundPlace& place = places[i];
    const bool known = !side.places.empty();
    std::optional<double> about = place.height;
    if (!about) about = known ? std::optional(side.heights.back()) : search.begin;
    strips.collect(place.plan, about, heights);
    const std::optional<double> ground = ground_among(heights);
    if (!ground) {
      if (!heights.empty()) ++side.sparse;
      continue;
    }
    if (known) {
      const double way = place.station - places[side.places.back()].station;
      if (*ground - side.heights.back() > kRise + kSlope * way) {
        ++side.risen;
        continue;
      }
    }
    side.places.push_back(i);
    side.heights.push_back(*ground);
  }
  return side;
}

}  // namespace clearway
