#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "clearway/pose.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// The points of a scan in a box that moves with the model. Reads the few blocks that lie there.
/// Of one thread.
class ScanPoints {
 public:
  using Chunks = std::array<PackedChunk<std::int32_t>, 3>;

  explicit ScanPoints(const PackedCloud& cloud) : cloud_(cloud) {}

  /// Hands every point in a box of the model's frame, in that frame, to `look` until that returns
  /// false; the box includes its faces. False: there are more blocks than are read for one box.
  /// Throws InputError where a cell is damaged.
  bool visit(const Box& region, const Pose& pose,
             const std::function<bool(const Vec3&)>& look) const;

  /// Whether `least` points or more are in the box; true too where too many blocks lie there.
  bool has(const Box& region, const Pose& pose, std::uint64_t least) const;

  /// Down to the lowest point of the scan, in the model's frame, for a model that is not tilted by
  /// more than 45 degrees.
  double bottom_of_scan(const Box& body, const Pose& pose) const;

 private:
  const PackedCloud& cloud_;
  mutable std::unordered_map<std::uint32_t, Chunks> chunks_;  ///< of the cells read so far
};

}  // namespace clearway
