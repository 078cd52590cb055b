#pragma once

#include <filesystem>
#include <memory>

#include "io/scans/point_reader.hpp"

namespace clearway {

/// Makes a stream of integer points (LAS from standard input) readable more than once: the first
/// reading spools 14 bytes per point into temporary files in `folder`, which later ones read.
std::unique_ptr<PointReader> spool(std::unique_ptr<PointReader> stream,
                                   const std::filesystem::path& folder);

}  // namespace clearway
