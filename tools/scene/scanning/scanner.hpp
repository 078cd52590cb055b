#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "scene/path.hpp"
#include "scene/random.hpp"
#include "scene/sites/world.hpp"

namespace clearway::scene {

/// A fan of rays in an upright plane through the scanner. Angles in radians, in the plane, from
/// straight down (0) over the plane's direction (pi / 2) and straight up (pi) around to 2 pi.
struct Sweep {
  PathPoint scanner;
  SineCosine azimuth;  ///< the angle from the path's direction to the plane's, positive to the left
  double begin_angle, end_angle;
};

/// A scanner's motion over time: sweeps of equally many rays, the last one cut short.
struct ScanPlan {
  std::uint64_t points;
  std::uint64_t rays_a_sweep;
  double reach;           ///< no ray goes farther along the path than this
  double noise;           ///< standard deviation of a measured distance
  double open_reach = 0;  ///< where a room has no roof: rays that hit nothing up to here turn down
  /// Sweep `number`, which is at `share` of the time, 0 to 1.
  std::function<Sweep(double share, std::uint64_t number)> sweep;

  std::uint64_t sweeps() const { return (points + rays_a_sweep - 1) / rays_a_sweep; }
  Sweep sweep_of(std::uint64_t number) const {
    return sweep((static_cast<double>(number) + 0.5) / static_cast<double>(sweeps()), number);
  }
};

/// The number of rays in a sweep for which `points` rays in all lie `aspect` times as far apart
/// between sweeps as within one (in steps of sweep and ray, at one ray and one sweep).
std::uint64_t rays_a_sweep(std::uint64_t points, double aspect);

class Fan;

/// Points as a scanner measures them: in the order of time, with occlusion and noise, as stored
/// integers. Each sweep is a function of the seed and its number alone, so that threads may share
/// the work. A point lies inside bounds() because it is moved there where it does not.
class Scanner {
 public:
  Scanner(const Path& path, const World& world, ScanPlan plan, std::uint64_t seed);

  static constexpr Quantisation kQuantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};

  const ScanPlan& plan() const { return plan_; }
  const QuantumBox& bounds() const { return bounds_; }

  using Points = std::vector<std::array<std::int32_t, 3>>;
  /// Appends the points of one sweep to `out`.
  void scan(std::uint64_t sweep, Points& out) const;

 private:
  std::array<std::int32_t, 3> point(const Sweep& sweep, const Fan& fan, std::size_t k,
                                    std::uint64_t counter) const;

  const Path& path_;
  const World& world_;
  ScanPlan plan_;
  Random jitter_, range_noise_;
  std::uint64_t rough_key_;
  QuantumBox bounds_;
};

}  // namespace clearway::scene
