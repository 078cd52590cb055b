#pragma once

#include <span>
#include <string>

#include "clearway/file_unit.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

/// The unit of positions that the header names, or the options; not known where neither does. A
/// header in "ft" does not contradict options that say which foot it is. texts: the units in the
/// header, in lower case, or empty. Throws InputError where they are not known, differ, exist only
/// for some positions, or contradict the options.
FileUnit unit_of_positions(std::span<const std::string> texts, const TrajectoryOptions& options,
                           const std::string& name);

}  // namespace clearway
