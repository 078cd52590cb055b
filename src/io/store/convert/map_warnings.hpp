#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "clearway/box.hpp"
#include "core/util/messages.hpp"
#include "io/store/convert/input_agreement.hpp"

namespace clearway {

/// The warning of a map that does not keep lengths; its number "scale" is the greatest one.
inline constexpr const char* kMapScaleCode = "map-scale";

/// Judges the map of a scan by its scale at the middle of `box`, in the unit of `crs`: logs
/// "map-scale", or "map-scale-unknown" where PROJ does not compute it, and throws InputError where
/// lengths are wrong by more than kMostMapScale, unless they are to be ignored. Systems that are
/// no maps pass. source: the input that the error names.
void check_map_scale(const CommonCrs& crs, const Box& box, const std::filesystem::path& source,
                     bool ignore, MessageLog& log);

/// Warns with "degrees" where coordinates without a unit are numbers as longitudes and latitudes
/// are.
void warn_of_degrees(const Box& box, MessageLog& log);

}  // namespace clearway
