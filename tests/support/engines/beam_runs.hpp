#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/seen/beams.hpp"

namespace clearway {

/// What is left of a map's words after beams, and the beams that were left out.
struct BeamRun {
  std::vector<std::uint64_t> words;
  BeamCounts left_out;
};

/// Takes all points of a cloud in pages of a few cells through the body of the kernel on the host,
/// or through what follow_pages_with() has set. The map of `beams` stays as it is.
BeamRun follow_pages(const PackedCloud& cloud, const Beams& beams);

/// Sets what follow_pages() does from now on.
void follow_pages_with(BeamRun (*run)(const PackedCloud& cloud, const Beams& beams));

/// The greatest number of cells of a page in these runs.
inline constexpr std::uint32_t kBeamPageCells = 3;

}  // namespace clearway
