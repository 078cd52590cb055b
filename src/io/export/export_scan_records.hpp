#pragma once

#include <filesystem>
#include <vector>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Copies the records of the colliding points from the scans of the environment into a LAS file, in
/// the order of the result and in constant memory. Each record keeps its bytes, followed by extra
/// bytes first_pose (uint32) and distance (double, metres; -1 for none) as far as the result has
/// them. Where a scan has another scale or offset than the result, the coordinates become the
/// result's integers. scans: files and folders, as given to the conversion. Throws UsageError for
/// an output that is not .las. Throws InputError where the scans are not those of the result,
/// judged by their number of points or the place of a copied point, and where points to copy are
/// not in LAS files, all of one point format, without waveforms. Otherwise like export_result().
void export_scan_records(const ResultReader& result,
                         const std::vector<std::filesystem::path>& scans,
                         const std::filesystem::path& output, bool overwrite, Progress& progress);

}  // namespace clearway
