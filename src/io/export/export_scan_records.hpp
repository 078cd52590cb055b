#pragma once

#include <filesystem>
#include <vector>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Copies the records of the colliding points out of the scans that the environment was made of
/// into a LAS file, in the order of the result, in constant memory. Each keeps its bytes, and has
/// first_pose (uint32) and distance (double, metres; -1: none) behind them as extra bytes, as far
/// as the result has them. Where a scan has another scale or offset than the result, the
/// coordinates become the result's integers. scans: files and folders, as the conversion got them.
/// Throws UsageError for an output that is not .las; InputError where the scans are not those of
/// the result, as their number of points or a copied point's place shows; also where points to copy
/// are not in LAS files, all of one point format, without waveforms. Otherwise like export_result.
void export_scan_records(const ResultReader& result,
                         const std::vector<std::filesystem::path>& scans,
                         const std::filesystem::path& output, bool overwrite, Progress& progress);

}  // namespace clearway
