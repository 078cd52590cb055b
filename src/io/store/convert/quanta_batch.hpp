#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/scans/cut_off.hpp"
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
  /// Number of records that are not read, because `bounds` of them are too far from a path.
  std::uint64_t unread = 0;
  std::uint64_t unread_bytes = 0;
  Box bounds{};
};

/// Number and box of points of an input, in the store's integers.
struct FileBox {
  std::uint64_t points = 0;
  std::uint64_t beyond = 0;       ///< points out of reach of the declared box, see reach_of()
  std::int32_t lo[3]{}, hi[3]{};  ///< defined where there is a point
  CutOff cut_off{};               ///< of the points that are stored, where the input has integers

  void add(const FileBox& other) {
    cut_off.add(other.cut_off);
    if (other.points == 0) return;
    for (int k = 0; k < 3; ++k) {
      lo[k] = points == 0 ? other.lo[k] : std::min(lo[k], other.lo[k]);
      hi[k] = points == 0 ? other.hi[k] : std::max(hi[k], other.hi[k]);
    }
    points += other.points;
    beyond += other.beyond;
  }

  static FileBox of(std::span<const std::array<std::int32_t, 3>> quanta) {
    if (quanta.empty()) return {};
    FileBox box{.points = quanta.size()};
    for (std::size_t k = 0; k < 3; ++k) {
      std::int32_t lo = quanta[0][k], hi = lo;
      for (const auto& q : quanta) {
        lo = std::min(lo, q[k]);
        hi = std::max(hi, q[k]);
      }
      box.lo[k] = lo;
      box.hi[k] = hi;
    }
    return box;
  }
};

/// Sums over records of the inputs.
struct ReadCounts {
  std::uint64_t input_points = 0;
  std::uint64_t non_finite_points = 0;
  std::uint64_t first_non_finite = 0;  ///< source index of the first one, where there is one
  std::uint64_t absent_points = 0;     ///< records that hold no point, by the rules of their format
  std::uint64_t withheld_points = 0;   ///< with the flag `withheld`
  std::uint64_t first_withheld = 0;    ///< source index of the first one, where there is one
  /// Points left out because they are too far from a path; of these, points that were not read, and
  /// the bytes that hold them
  std::uint64_t far_points = 0, unread_points = 0, unread_bytes = 0;
  double largest_change = 0;  ///< largest |stored - read| of any coordinate, metres

  /// Adds what was read next.
  void add(const ReadCounts& next) {
    if (non_finite_points == 0) first_non_finite = next.first_non_finite;
    if (withheld_points == 0) first_withheld = next.first_withheld;
    input_points += next.input_points;
    non_finite_points += next.non_finite_points;
    absent_points += next.absent_points;
    withheld_points += next.withheld_points;
    far_points += next.far_points;
    unread_points += next.unread_points;
    unread_bytes += next.unread_bytes;
    largest_change = std::max(largest_change, next.largest_change);
  }
};

/// Consecutive points of the environment in the store's integers, without those that are not
/// finite, withheld, or too far from a path.
struct QuantaBatch {
  std::size_t file = 0;            ///< number of the input that all points belong to
  std::uint64_t first_source = 0;  ///< source index of the batch's first input point
  std::vector<std::array<std::int32_t, 3>> quanta;
  /// Source index of each point minus first_source; empty where that is its index in `quanta`.
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint8_t> classes;  ///< classes of the points; empty where all have class 0

  /// The GPS time of each record, with or without a point; empty where they are not wanted.
  std::vector<double> times;

  std::optional<Pose> turn{};  ///< PointBatch::turn

  ReadCounts counts;
  /// Where records with the flag `withheld` are left out, the cubes in which they lie, each once.
  std::vector<MetreCube> withheld_cubes;
  FileBox whole;     ///< of the finite points, those too far from a path included
  PieceBytes bytes;  ///< the bytes from which a piece was read, where requested

  std::uint64_t source(std::size_t i) const {
    return first_source + (offsets.empty() ? i : offsets[i]);
  }
};

}  // namespace clearway
