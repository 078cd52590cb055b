#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/convert/split_tree.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// A point on its way to its unit, 20 bytes. No input has as many as 2^56 points: the highest byte
/// of the source index is the point's class.
struct DistributedPoint {
  std::int32_t q[3];
  std::uint32_t source[2];  ///< low and high half of the source index, with the class

  static DistributedPoint of(const std::array<std::int32_t, 3>& q, std::uint64_t source,
                             std::uint8_t point_class) {
    const auto high = static_cast<std::uint32_t>(source >> 32);
    return {{q[0], q[1], q[2]},
            {static_cast<std::uint32_t>(source), high | std::uint32_t{point_class} << 24}};
  }
  std::uint64_t source_index() const {
    return source[0] | std::uint64_t{source[1] & 0x00FFFFFFU} << 32;
  }
  std::uint8_t point_class() const { return static_cast<std::uint8_t>(source[1] >> 24); }
};
static_assert(sizeof(DistributedPoint) == 20);

/// All points of a unit, in source order.
struct UnitPoints {
  std::unique_ptr<DistributedPoint[]> points;
  std::size_t count = 0;

  std::span<const DistributedPoint> span() const { return {points.get(), count}; }
};

/// The points by unit of the tree: in memory, or in files without names.
class Distribution {
 public:
  /// folder: of the files; none: in memory. files: how many, as one takes the bytes of one thread
  /// at a time. Throws ResourceError where the disk is too small.
  Distribution(const SplitTree& tree, const std::optional<std::filesystem::path>& folder,
               std::size_t files);

  std::size_t units() const { return counts_.size(); }
  std::uint64_t points(std::size_t unit) const { return counts_[unit]; }
  /// Of the files.
  std::uint64_t temporary_bytes() const { return temporary_bytes_; }

  /// Puts points at `first` of a unit's. Several threads at once, at different places.
  void put(std::size_t unit, std::uint64_t first, std::span<const DistributedPoint> points);
  /// Once for each unit, when all its points are there; several threads at once.
  UnitPoints take(std::size_t unit);

 private:
  struct Place {
    std::size_t file;
    std::uint64_t byte;
  };

  std::vector<std::uint64_t> counts_;
  std::vector<UnitPoints> memory_;  // by unit, or:
  std::vector<File> files_;
  std::vector<Place> places_;  // of the units in the files
  std::uint64_t temporary_bytes_ = 0;
};

}  // namespace clearway
