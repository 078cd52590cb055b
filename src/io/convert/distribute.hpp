#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/checks/same_place.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/split_tree.hpp"
#include "io/convert/stage_clocks.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// A point as the temporary file holds it, 20 bytes.
struct DistributedPoint {
  std::int32_t q[3];
  std::uint32_t source[2];  ///< low and high half of the source index

  std::uint64_t source_index() const { return source[0] | std::uint64_t{source[1]} << 32; }
};
static_assert(sizeof(DistributedPoint) == 20);

/// The points by unit of the tree, each unit's in source order, in a file without a name.
struct Distribution {
  File file;
  std::vector<std::uint64_t> first;  ///< of each unit, in points; one more entry for the end
};

/// The distribution pass. Throws InputError when the input is not what was counted, ResourceError
/// when the disk is full. points_hash: of what was counted. places: counts the points it was made
/// for. buffer_bytes: memory for the units' write buffers.
Distribution distribute(EnvironmentSource& environment, std::uint64_t points_hash,
                        const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                        const std::filesystem::path& temporary_folder, std::uint64_t buffer_bytes,
                        int threads, StageClocks& clocks, Progress& progress);

}  // namespace clearway
