#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// A point of the inputs, with its file and its number in it.
struct InputPoint {
  Vec3 at;
  std::size_t file = 0;
  std::uint64_t point = 0;
};

/// The range of the points' coordinates, and which points lie far from the others. Found in one
/// pass and in constant memory; depends only on the points in their order.
class CoordinateRange {
 public:
  /// The points that are farther than `reach` from the median on some axis.
  struct Far {
    std::vector<InputPoint> points;  ///< in the order of the inputs; incomplete where `more`
    bool more = false;  ///< there may be more far points, and `lo` and `hi` are not known
    Vec3 lo{}, hi{};    ///< box of the other points
  };

  /// Adds a point, which must be finite.
  void add(const Vec3& p, std::size_t file, std::uint64_t point);

  bool empty() const { return count_ == 0; }
  double lo(int axis) const { return extreme(axis, false).at[axis]; }
  double hi(int axis) const { return extreme(axis, true).at[axis]; }
  /// The point with the least or greatest coordinate.
  const InputPoint& extreme(int axis, bool greatest) const {
    return extremes_[2 * static_cast<std::size_t>(axis) + (greatest ? 1 : 0)].front();
  }

  Far far_points(double reach) const;

 private:
  static constexpr std::size_t kKept = 16;  // points kept on each side of each axis
  static constexpr std::size_t kMostSamples = std::size_t{1} << 14;

  void keep(std::size_t side, const InputPoint& p);
  double median(int axis) const;

  // The points with the least and greatest x, y and z, in this order, the most extreme ones first.
  std::array<std::vector<InputPoint>, 6> extremes_;
  std::vector<Vec3> samples_;  // a sample of the points: every (mask + 1)-th one
  std::uint64_t sample_mask_ = 0;
  std::uint64_t count_ = 0;
};

/// The coarsest step in metres that a conversion chooses by itself.
inline constexpr double kCoarsestOwnScale = 1e-3;

/// Offset and scale for positions of this range: the requested scale, otherwise the finest power of
/// ten from 1e-6 that fits. Throws InputError where the range does not fit 32-bit integers, or
/// needs steps coarser than kCoarsestOwnScale that were not requested. The message names the points
/// that lie far from all others, with their lines where the files have lines.
Quantisation choose_scale(const CoordinateRange& range, std::optional<double> scale,
                          std::span<const std::filesystem::path> files,
                          const PointReadOptions& how_to_read);

}  // namespace clearway
