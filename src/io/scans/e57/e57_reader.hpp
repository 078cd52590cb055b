#pragma once

#include <memory>

#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads E57 1.0 from a regular file: the points of all scans that have coordinates, in the order
/// of the file, with their poses applied. Images and other fields are skipped. Source: ASTM
/// E2807-11; docs/design/inputs.md.
std::unique_ptr<PointReader> read_e57(File file);

}  // namespace clearway
