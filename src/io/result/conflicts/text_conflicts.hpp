#pragma once

#include "io/files/file.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// Writes CSV: a header and a row for each conflict, where absent values are empty.
void write_csv(const ConflictFile& conflicts, const File& file);

/// Writes JSON: one object with the summary and the member `conflicts`.
void write_json(const ConflictFile& conflicts, const File& file);

/// Writes GeoJSON: a FeatureCollection with two features for each conflict, its centroid and its
/// footprint, in the coordinate reference system of the scans, which the member "crs" names.
void write_geojson(const ConflictFile& conflicts, const File& file);

}  // namespace clearway
