#pragma once

#include "clearway/trajectory.hpp"
#include "python/values.hpp"

namespace clearway::python {

/// The options for the arguments that are described fields. Throws UsageError for an unknown name.
TrajectoryOptions trajectory_options(const py::kwargs& given,
                                     const EnvironmentUnitArgument& environment_unit);

}  // namespace clearway::python
