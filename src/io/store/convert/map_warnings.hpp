#pragma once

#include <span>

#include "clearway/box.hpp"
#include "core/messages/messages.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/file_boxes.hpp"

namespace clearway {

/// The warning of a map that does not keep lengths; its number "scale" is the greatest one.
inline constexpr const char* kMapScaleCode = "map-scale";

/// Judges each map that the scans are in by its scale at the middle of the points of its files:
/// logs "map-scale", or "map-scale-unknown" where PROJ does not compute it, and throws InputError
/// where lengths are wrong by more than kMostMapScale, unless they are to be ignored. Systems that
/// are no maps pass. Files without a system are in that of the others. boxes: of each file.
void check_map_scales(const EnvironmentSource& environment, std::span<const FileBox> boxes,
                      bool ignore, MessageLog& log);

/// Warns with "like-degrees" where coordinates without a unit are numbers as longitudes and
/// latitudes are.
void warn_of_degrees(const Box& box, MessageLog& log);

}  // namespace clearway
