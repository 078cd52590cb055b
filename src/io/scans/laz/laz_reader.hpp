#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "io/scans/input_buffer.hpp"
#include "io/scans/laz/chunk_table.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads the points of a LAZ file whose header has been read into `info`. The input must be able to
/// seek. Several chunks are decoded at once, on the threads of the caller's oneTBB arena; memory is
/// bounded by their number, not by what the file declares. copc: the record about the octree of
/// COPC, or empty; where the octree is damaged, points are read without it, with a remark. Throws
/// InputError with the chunk.
std::unique_ptr<PointReader> read_laz_points(InputBuffer input, const laz::Scheme& scheme,
                                             const laz::PointBytes& bytes,
                                             std::span<const std::byte> copc, CloudInfo info);

}  // namespace clearway
