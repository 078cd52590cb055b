#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clearway/convert.hpp"
#include "clearway/progress.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/corridor.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

/// How the trajectories of a conversion are read, in the unit and the system of the environment.
/// crs: as CommonCrs has it.
TrajectoryOptions reading_of_paths(const ConvertOptions& options, const std::string& crs,
                                   LengthUnit unit);

/// Whether a doubt about a trajectory concerns only how it turns.
bool is_about_rotation(const Message& remark);

/// The corridor around ConvertOptions::near, in the unit of the environment. Throws InputError
/// where the path cannot be read or has no pose.
Corridor corridor_of(const ConvertOptions& options, const std::string& crs, LengthUnit unit,
                     MessageLog& log);

/// Throws InputError where the corridor holds none of the points that were read, as where the path
/// and the scans are in different frames. whole: the box around all points.
void refuse_empty_corridor(const ConvertOptions& options, const Corridor& corridor,
                           const std::optional<Box>& whole, std::uint64_t far_points);

}  // namespace clearway
