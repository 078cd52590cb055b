#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "core/messages/messages.hpp"
#include "core/util/progress.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/file_boxes.hpp"
#include "io/store/convert/same_scans.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Logs what the counting pass noticed: the files' own remarks, points left out, and files that
/// have no points, are far apart, have other sizes or were named twice. Returns the box of all
/// points.
std::optional<Box> warn_of_inputs(const EnvironmentSource& environment, const FileBoxes& boxes,
                                  const StoreMetadata& metadata, MessageLog& log);

/// Warns where many of the `points` points are at the same place.
void warn_of_places(const EnvironmentSource& environment, const PlaceCounter& places,
                    std::uint64_t points, MessageLog& log);

}  // namespace clearway
