#pragma once

#include <filesystem>

#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// Writes a GeoPackage 1.3 with three layers in the coordinate reference system of the scans:
/// `conflicts` (their centroids), `footprints` (of their boxes) and `stretches` (of the path).
/// Equal contents give equal bytes with the same SQLite. Source: OGC 12-128r17.
void write_geopackage(const ConflictFile& conflicts, const std::filesystem::path& path);

}  // namespace clearway
