#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "io/files/mapped_file.hpp"
#include "io/store/convert/count.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/same_scans.hpp"
#include "io/store/convert/split_tree.hpp"
#include "io/store/convert/stage_clocks.hpp"

namespace clearway {

class OriginTable;
class WithheldCubes;

/// A point to be distributed to its unit, 20 bytes. As no input has as many as 2^56 points, the
/// highest byte of the source index holds the point's class.
struct DistributedPoint {
  std::int32_t q[3];
  std::uint32_t source[2];  ///< low half of the source index, and its high half with the class

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
class UnitPoints {
 public:
  UnitPoints() = default;
  /// Room for points in memory.
  explicit UnitPoints(std::size_t count)
      : memory_(std::make_unique_for_overwrite<DistributedPoint[]>(count)),
        points_(memory_.get(), count) {}
  /// Points as they are in a file.
  explicit UnitPoints(std::unique_ptr<MappedFile> map)
      : map_(std::move(map)),
        points_(reinterpret_cast<const DistributedPoint*>(map_->bytes().data()),
                map_->bytes().size() / sizeof(DistributedPoint)) {}

  std::span<const DistributedPoint> span() const { return points_; }
  /// The room, to be filled.
  std::span<DistributedPoint> room() const { return {memory_.get(), points_.size()}; }

 private:
  std::unique_ptr<DistributedPoint[]> memory_;
  std::unique_ptr<MappedFile> map_;
  std::span<const DistributedPoint> points_;
};

/// The points of each unit of the tree, in memory or in files.
class Distribution {
 public:
  /// files: several, because each takes the bytes of one thread at a time; none keeps the points in
  /// memory. first_byte: where points begin in each file. Throws ResourceError where the disk is
  /// too small.
  Distribution(const SplitTree& tree, std::vector<File> files, std::uint64_t first_byte = 0);

  std::size_t units() const { return counts_.size(); }
  std::uint64_t points(std::size_t unit) const { return counts_[unit]; }
  /// Size of the temporary files in bytes.
  std::uint64_t temporary_bytes() const { return temporary_bytes_; }

  /// Stores points of a unit from index `first` on. Several threads may store at different places
  /// at once.
  void put(std::size_t unit, std::uint64_t first, std::span<const DistributedPoint> points);
  /// For each unit whose points are in files, a sum by which these are known again.
  const std::vector<std::uint64_t>& sums() const { return sums_; }
  /// Takes over the points that an earlier process stored in the files. Returns false where these
  /// do not have its sums.
  bool take_over(std::vector<std::uint64_t> sums);
  /// Takes the points of a unit, once all of them are stored. To be called once per unit; several
  /// threads may call it at once. Throws ResourceError where its file does not hold them.
  UnitPoints take(std::size_t unit);
  /// Closes the files, in parallel, because the system frees the memory of those whose names are
  /// gone, a gigabyte in some 0.12 s. No points are left.
  void close_files();

 private:
  struct Place {
    std::size_t file;
    std::uint64_t byte;
  };

  std::optional<UnitPoints> points_in_file(std::size_t unit, std::uint64_t sum) const;

  std::vector<std::uint64_t> counts_;
  std::vector<std::uint64_t> sums_;
  std::vector<UnitPoints> memory_;  // points by unit, where they are in memory
  std::vector<File> files_;
  std::vector<Place> places_;  // places of the units in the files
  std::uint64_t temporary_bytes_ = 0;
};

/// Performs the distribution pass, which puts every point to those of its unit, in source order.
/// Throws InputError when the input is not what was counted, ResourceError when the disk is full.
/// places: counts the points at its places. origins: counts the points of each basis, or is null.
/// withheld: collects the cubes of points that are left out as withheld, or is null.
void distribute(EnvironmentSource& environment, const CountedEnvironment& counted,
                const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                Distribution& distribution, int threads, StageClocks& clocks, Progress& progress,
                OriginTable* origins = nullptr, WithheldCubes* withheld = nullptr);

}  // namespace clearway
