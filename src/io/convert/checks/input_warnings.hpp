#pragma once

#include <cstdint>
#include <optional>

#include "clearway/box.hpp"
#include "core/util/message_log.hpp"
#include "io/convert/checks/file_boxes.hpp"
#include "io/convert/checks/same_place.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Logs what the counting pass noticed: the files' own remarks, points left out, and files that
/// have no points, are far apart, have other sizes or were named twice. Returns the box of all
/// points.
std::optional<Box> warn_of_inputs(const EnvironmentSource& environment, const FileBoxes& boxes,
                                  const StoreMetadata& metadata, MessageLog& log);

/// Warns where many of the `points` points are at one and the same place.
void warn_of_places(const EnvironmentSource& environment, const PlaceCounter& places,
                    std::uint64_t points, MessageLog& log);

}  // namespace clearway
