#pragma once

#include <optional>

#include "search/checks/facts/scan_points.hpp"

namespace clearway {

/// What was scanned below a body.
class Ground {
 public:
  explicit Ground(const PackedCloud& cloud) : points_(cloud) {}

  /// How high a box of the model's frame stands at a pose above the highest point below it, along
  /// the model's z axis; 0 where a point is in it, none where no point is below it. Throws
  /// InputError where a cell is damaged.
  std::optional<double> height_of(const Box& body, const Pose& pose) const;

 private:
  ScanPoints points_;
};

}  // namespace clearway
