#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "clearway/pose.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/quantisation.hpp"

namespace clearway {

/// The surroundings of a box, up to a distance, in the steps of a cell's block boxes. Dismisses
/// most blocks before they are decoded, and none that is within the distance.
class StepRange {
 public:
  StepRange(const Box& cell, const Box& box, double distance) {
    for (int k = 0; k < 3; ++k) {
      const double extent = cell.hi[k] - cell.lo[k];
      const double steps = extent > 0 ? static_cast<double>(kBlockBoxSteps) / extent : 0;
      lo_[k] = step((box.lo[k] - distance - cell.lo[k]) * steps - kSlack);
      hi_[k] = step((box.hi[k] + distance - cell.lo[k]) * steps + kSlack);
    }
  }

  bool meets(const BlockBox& block) const {
    bool meets = true;
    for (int k = 0; k < 3; ++k) meets = meets & (block.lo[k] <= hi_[k]) & (block.hi[k] >= lo_[k]);
    return meets;
  }

 private:
  static constexpr double kSlack = 2;  // block boxes are rounded by a step

  static std::int32_t step(double steps) {
    return static_cast<std::int32_t>(std::clamp(steps, -1e9, 1e9));
  }

  std::int32_t lo_[3], hi_[3];
};

/// The points of a scan in a box of a frame, such as that of the model at a pose. Reads only the
/// blocks that lie there. Not thread-safe.
class ScanPoints {
 public:
  using Chunks = std::array<PackedChunk<std::int32_t>, 3>;
  /// Takes a point by its place in the frame, its cell and its index there, and returns whether to
  /// go on. The place is that of PullBack::apply().
  using Look = std::function<bool(const Vec3& place, std::uint32_t cell, std::uint32_t index)>;

  /// How many blocks are read for one box if nothing else is said: a quarter of a million points.
  static constexpr std::uint32_t kMostBlocks = 4096;

  /// cloud: has at least one point and outlives this object.
  explicit ScanPoints(const PackedCloud& cloud, std::uint32_t most_blocks = kMostBlocks)
      : cloud_(cloud), most_blocks_(most_blocks) {}

  /// Hands every point in a box of the model's frame, in that frame, to `look` until that returns
  /// false; the box includes its faces. Returns false where there are more blocks than are read for
  /// one box. Throws InputError where a cell is damaged.
  bool visit(const Box& region, const Pose& pose, const Look& look) const;

  /// Whether at least `least` points are in the box; also true where too many blocks lie there.
  bool has(const Box& region, const Pose& pose, std::uint64_t least) const;

  /// A z coordinate of the model's frame below which the scan has no points, for a model that is
  /// not tilted by more than 45 degrees.
  double bottom_of_scan(const Box& body, const Pose& pose) const;

 private:
  const PackedCloud& cloud_;
  std::uint32_t most_blocks_;
  /// Packed chunks of the cells read so far, by cell.
  mutable std::unordered_map<std::uint32_t, Chunks> chunks_;
};

}  // namespace clearway
