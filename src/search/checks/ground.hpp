#pragma once

#include <optional>

#include "clearway/pose.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// What was scanned below a body. Reads the points of the few blocks that lie there.
class Ground {
 public:
  explicit Ground(const PackedCloud& cloud) : cloud_(cloud) {}

  /// How high a box of the model's frame stands at a pose above the highest point below it, along
  /// the model's z axis; 0 where a point is in it, none where no point is below it. Throws
  /// InputError where a cell is damaged.
  std::optional<double> height_of(const Box& body, const Pose& pose) const;

 private:
  const PackedCloud& cloud_;
};

}  // namespace clearway
