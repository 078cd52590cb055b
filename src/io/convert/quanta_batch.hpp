#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/formats/point_reader.hpp"

namespace clearway {

/// Consecutive records of an input, on their way to a QuantaBatch.
struct RecordBatch {
  std::size_t file = 0;
  std::uint64_t first_source = 0;       ///< source index of the first record
  std::shared_ptr<PointReader> reader;  ///< they are a piece of it, still to be read; or null:
  std::size_t piece = 0;
  PointBatch points;  ///< read already
};

/// Consecutive finite points of the environment in the store's integers.
struct QuantaBatch {
  std::size_t file = 0;            ///< number of the input, which all points are of
  std::uint64_t first_source = 0;  ///< source index of the batch's first input point
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<std::uint32_t> offsets;  ///< source - first_source, empty where it is the position
  std::vector<std::uint8_t> classes;   ///< of the points; empty where all have class 0

  std::uint64_t records = 0;  ///< input points
  std::uint64_t non_finite_points = 0;
  std::uint64_t first_non_finite = 0;  ///< source index, where there is one
  std::uint64_t absent_points = 0;
  double largest_change = 0;  ///< |stored - read| of any coordinate, metres
  PieceBytes bytes;           ///< what a piece was read from, where they are asked for

  std::uint64_t source(std::size_t i) const {
    return first_source + (offsets.empty() ? i : offsets[i]);
  }
};

}  // namespace clearway
