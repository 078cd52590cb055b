#pragma once

#include <optional>
#include <span>
#include <string>

#include "clearway/trajectory.hpp"

namespace clearway {

/// Metres of the unit of positions: what the header says, or the options; none where neither does.
/// texts: the units in the header, lower case, or empty. Throws InputError where they are not
/// known, differ, are there for some positions only, or contradict the options.
std::optional<double> unit_of_positions(std::span<const std::string> texts,
                                        const TrajectoryOptions& options, const std::string& name);

}  // namespace clearway
