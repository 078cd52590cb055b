#pragma once

#include "io/conflicts/conflict_file.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// A header and a row for each conflict; what there is not is left empty.
void write_csv(const ConflictFile& conflicts, const File& file);

/// One object: the summary, and `conflicts`.
void write_json(const ConflictFile& conflicts, const File& file);

/// A FeatureCollection with two features for each conflict: its centroid and its footprint, in the
/// coordinate reference system of the scans, which the member "crs" names.
void write_geojson(const ConflictFile& conflicts, const File& file);

}  // namespace clearway
