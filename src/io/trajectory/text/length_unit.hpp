#pragma once

#include <span>
#include <string>

#include "clearway/trajectory.hpp"

namespace clearway {

/// Metres of the unit of positions: what the options say, or the header, or metres.
/// texts: the units in the header, lower case, or empty. Throws InputError where they are not
/// known, differ, or contradict the options.
double metres_per_unit(std::span<const std::string> texts, const TrajectoryOptions& options,
                       const std::string& name);

}  // namespace clearway
