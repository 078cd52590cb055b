#pragma once

#include <optional>

#include "search/checks/facts/scan_points.hpp"

namespace clearway {

/// How high a box of the model's frame stands at a pose above the highest point below it, along the
/// model's z axis; 0 where a point is in the box, and nothing where no point is below it. Throws
/// InputError where a cell is damaged.
std::optional<double> height_above_ground(const ScanPoints& points, const Box& body,
                                          const Pose& pose);

}  // namespace clearway
