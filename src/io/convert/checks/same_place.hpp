#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "io/convert/quanta_batch.hpp"

namespace clearway {

/// A warning is due where more than this share of the points are at one place ...
inline constexpr double kSamePlaceShare = 0.01;
/// ... and at least as many as this.
inline constexpr std::uint64_t kSamePlacePoints = 10;

/// Points in the store's integers.
using PlaceQuanta = std::array<std::int32_t, 3>;

/// A sample of the points, one of each 2^k consecutive ones, chosen by a hash; all of them up to
/// 65,536. It tells which places may hold a share of all points (docs/design/conversion.md).
/// Constant memory; a function of the points in their order.
class PlaceSample {
 public:
  /// The next points, in order.
  void add(const QuantaBatch& batch);
  /// The places that may hold more than kSamePlaceShare of the points; at most 200.
  std::vector<PlaceQuanta> suspects() const;

 private:
  static constexpr std::size_t kMostSamples = std::size_t{1} << 16;

  void thin();
  void choose_next();

  std::vector<PlaceQuanta> samples_;
  unsigned level_ = 0;       ///< k
  std::uint64_t group_ = 0;  ///< of 2^k points, whose sample is the next
  std::uint64_t next_ = 0;   ///< the number of that point
  std::uint64_t seen_ = 0;
};

/// Counts the points at given places. add() may be called from several threads.
class PlaceCounter {
 public:
  struct Place {
    PlaceQuanta at{};
    std::uint64_t count = 0;
    std::uint64_t first = 0, last = 0;  ///< source indices
  };

  /// places: at most 200.
  explicit PlaceCounter(const std::vector<PlaceQuanta>& places);

  void add(const QuantaBatch& batch);
  /// Those with a due warning among `points` points, the fullest first.
  std::vector<Place> crowded(std::uint64_t points) const;

 private:
  std::vector<Place> places_;
  std::vector<std::uint16_t> table_;  // of hashes: 1 + the place's index, 0 for none
  std::mutex mutex_;
};

}  // namespace clearway
