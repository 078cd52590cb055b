#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/scans/point_reader.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Consecutive records of an input, before they become a QuantaBatch.
struct RecordBatch {
  std::size_t file = 0;
  std::uint64_t first_source = 0;  ///< source index of the first record
  /// Reads the records as `piece`; null where `points` holds them already.
  std::shared_ptr<PointReader> reader;
  std::size_t piece = 0;
  PointBatch points;  ///< the records, where they have been read
};

/// Consecutive points of the environment in the store's integers, without those that are not finite
/// or withheld.
struct QuantaBatch {
  std::size_t file = 0;            ///< number of the input that all points belong to
  std::uint64_t first_source = 0;  ///< source index of the batch's first input point
  std::vector<std::array<std::int32_t, 3>> quanta;
  /// Source index of each point minus first_source; empty where that is its index in `quanta`.
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint8_t> classes;  ///< classes of the points; empty where all have class 0

  /// The GPS time of each record, with or without a point; empty where they are not wanted.
  std::vector<double> times;

  std::uint64_t records = 0;  ///< number of input points
  std::uint64_t non_finite_points = 0;
  /// Source index of the first non-finite point, where there is one.
  std::uint64_t first_non_finite = 0;
  std::uint64_t absent_points = 0;
  /// Records with the flag `withheld`, and where they are left out the cubes in which they lie,
  /// each once.
  std::uint64_t withheld_points = 0;
  std::uint64_t first_withheld = 0;  ///< source index of the first of them, where there is one
  std::vector<MetreCube> withheld_cubes;
  double largest_change = 0;  ///< largest |stored - read| of any coordinate, metres
  PieceBytes bytes;           ///< the bytes from which a piece was read, where requested

  std::uint64_t source(std::size_t i) const {
    return first_source + (offsets.empty() ? i : offsets[i]);
  }
};

}  // namespace clearway
