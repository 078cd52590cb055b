#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "findings/point_blocks.hpp"

namespace clearway {

/// The most points whose distance to the next one is looked for.
inline constexpr std::size_t kSpacingSample = 65'536;
/// With fewer places than this, nothing is said of how far apart points are.
inline constexpr std::size_t kLeastPlaces = 10;

/// The lower median of the distances from points to the nearest one at another place, in the unit
/// of the scale: of at most kSpacingSample points, taken evenly in their order, to the nearest of
/// all. None with fewer than kLeastPlaces places. Takes at most 12 bytes a point and 30 MB. Runs in
/// the caller's arena of oneTBB. Throws Interrupted.
std::optional<double> colliding_spacing(std::span<const QuantumPoint> points,
                                        const Quantisation& quantisation, Progress& progress);

/// How colliding points are grouped.
struct Grouping {
  double gap = 0;                ///< in the unit of the environment
  std::uint64_t min_points = 0;  ///< smaller groups are not listed
};

/// The grouping where none is asked for: a gap of 0.3 m, or three spacings if these are more, and
/// as many points as lie on a square of 10 cm, at least 1 and at most 10. any: whether any point
/// collides. spacing: as colliding_spacing() has it. metre: the length of the environment's unit.
Grouping usual_grouping(bool any, std::optional<double> spacing, double metre);

}  // namespace clearway
