#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/trajectory/alignment/plan.hpp"

namespace clearway {

/// Metres from one place to the next at which the ground is looked for.
inline constexpr double kGroundStep = 0.5;
/// The longest gap between two places with ground that is bridged, in metres.
inline constexpr double kLongestGroundGap = 5;

/// Length along the line and width across it of the strip in which the ground is looked for at a
/// place, in metres.
inline constexpr double kGroundStripLength = 0.5, kGroundStripWidth = 0.4;
/// Number of points of a strip that make ground at least.
inline constexpr std::size_t kFewestGroundPoints = 12;

/// The ground among the heights of points in a strip, in metres: the median of a window of 0.1 m
/// height. The lowest window counts that has at least 12 points and a fifth of those of the fullest
/// one; from it the fullest that starts at most 0.1 m higher is taken, the lower of two that are as
/// full. Nothing where no window has enough points. heights: in any order; they are sorted.
std::optional<double> ground_among(std::vector<double>& heights);

/// A place at which the ground is looked for.
struct GroundPlace {
  double station = 0;  ///< metres along the line
  PlanPlace plan;      ///< metres
  /// The height of the line in metres, if it has one. None: the last ground that was found on the
  /// same side counts.
  std::optional<double> height = {};
};

/// The ground under one side of a vehicle that drives along a line.
struct GroundSide {
  std::vector<std::size_t> places;  ///< at which it was found, ascending
  std::vector<double> heights;      ///< of each of them, metres
  std::size_t risen = 0;   ///< places where what was found had risen too much, so it was dropped
  std::size_t sparse = 0;  ///< places with points that are too few at one height to be ground

  /// The heights at the places `from` to `to`, which are not before the first and after the last
  /// one that was found; between two of them they change evenly.
  std::vector<double> bridged(std::span<const GroundPlace> places, std::size_t from,
                              std::size_t to) const;
};

/// Where the ground is looked for.
struct GroundSearch {
  double left = 0;   ///< metres from the line to the middle of the strip; negative: to the right
  double metre = 1;  ///< length of a metre in the cloud's unit
  /// About which height in metres it is looked for where there is no ground yet, and the line has
  /// no heights. None: at any height.
  std::optional<double> begin = {};
};

/// Finds the ground beside a line: at each place in a strip that is 0.5 m long and 0.4 m wide,
/// within 1 m of the height of the place. One that lies above the last one by more than 0.1 m and
/// 15 % of the way from there is dropped. Reads only cells that a strip meets. Throws InputError
/// where a cell is damaged.
GroundSide find_ground(const PackedCloud& cloud, std::span<const GroundPlace> places,
                       const GroundSearch& search);

}  // namespace clearway
