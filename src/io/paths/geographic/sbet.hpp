#pragma once

#include <cstddef>
#include <span>

#include "io/paths/trajectory_file.hpp"
#include "io/scans/input_buffer.hpp"

namespace clearway {

inline constexpr std::size_t kSbetRecordBytes = 17 * sizeof(double);

/// Whether bytes can be the first record of an SBET.
bool may_be_sbet(std::span<const std::byte> record);

/// Reads Applanix' "smoothed best estimate of trajectory" to its end: records of 17 little-endian
/// doubles without a header. Throws InputError and UsageError.
/// Source: Applanix, POSPac user's guide (record and wander angle); docs/design/trajectory.md.
void read_sbet(InputBuffer& input, const TrajectoryOptions& options, TrajectoryFile& out);

}  // namespace clearway
