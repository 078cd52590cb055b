#pragma once

#include <array>
#include <string>

#include "clearway/trajectory.hpp"
#include "python/values.hpp"

namespace clearway::python {

/// The options for the values that Python has for them. Throws UsageError for an unknown name.
TrajectoryOptions trajectory_options(const std::string& format, bool allow_non_rigid,
                                     const std::string& angle_unit, const std::string& angle_frame,
                                     const std::string& crs, const std::string& default_crs,
                                     const std::string& datum, const UnitArgument& metres_per_unit,
                                     const EnvironmentUnitArgument& environment_unit,
                                     const std::array<double, 3>& lever_arm);

}  // namespace clearway::python
