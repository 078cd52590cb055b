#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "clearway/pose.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// The points of a scan in a box that moves with the model. Reads only the few blocks that lie
/// there. Not thread-safe.
class ScanPoints {
 public:
  using Chunks = std::array<PackedChunk<std::int32_t>, 3>;

  explicit ScanPoints(const PackedCloud& cloud) : cloud_(cloud) {}

  /// Hands every point in a box of the model's frame, in that frame, to `look` until that returns
  /// false; the box includes its faces. Returns false where there are more blocks than are read for
  /// one box. Throws InputError where a cell is damaged.
  bool visit(const Box& region, const Pose& pose,
             const std::function<bool(const Vec3&)>& look) const;

  /// Whether at least `least` points are in the box; also true where too many blocks lie there.
  bool has(const Box& region, const Pose& pose, std::uint64_t least) const;

  /// A z coordinate of the model's frame below which the scan has no points, for a model that is
  /// not tilted by more than 45 degrees.
  double bottom_of_scan(const Box& body, const Pose& pose) const;

 private:
  const PackedCloud& cloud_;
  /// Packed chunks of the cells read so far, by cell.
  mutable std::unordered_map<std::uint32_t, Chunks> chunks_;
};

}  // namespace clearway
