#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/laz/chunk_decoder.hpp"

/// The octree of a COPC file, a LAZ file whose chunks are the nodes of it.
/// Source: COPC 1.0 (Hobu, Inc.), "COPC File Design".
namespace clearway::laz {

/// The cube of each chunk's node, in the order of the chunks. info: the payload of the record of
/// user `copc` with the number 1. Throws InputError where the hierarchy is damaged or is not that
/// of these chunks.
std::vector<Box> read_copc_cubes(const InputBuffer& input, std::span<const std::byte> info,
                                 std::span<const Chunk> chunks);

}  // namespace clearway::laz
