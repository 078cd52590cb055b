#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/section.hpp"
#include "core/section/section_map.hpp"
#include "core/section/section_poses.hpp"
#include "core/seen/beams.hpp"
#include "core/seen/cubes.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// The cubes of seen space around a load, and the cells of its section under those that no beam
/// crossed (docs/design/section.md, "Seen space").
class SectionSeen {
 public:
  /// Lists the bricks of cubes around the load, with up to memory_bytes of memory. All arguments
  /// must outlive this object. Throws as check_seen_space() does, InputError where a cube is beyond
  /// 32-bit integers, and ResourceError where the bricks take more memory.
  SectionSeen(const StoreReader& store, const SectionParameters& asked, std::span<const Pose> load,
              const SectionPoses& poses, const SectionLattice& lattice, double rounding,
              std::uint64_t memory_bytes);

  /// Bytes that finding the cells takes beside the maps.
  std::uint64_t needed_bytes() const;

  /// Blocks cells of the maps by the cubes that no beam of the store crossed, and returns how many
  /// beams were left out. Throws InputError for a damaged cell, Interrupted.
  BeamCounts block(int threads, SectionMaps& maps, Progress& progress) const;

 private:
  const StoreReader& store_;
  const SectionPoses& poses_;
  const SectionLattice& lattice_;
  const double rounding_;
  const CubeLattice cubes_;
  std::vector<Brick> bricks_;
};

}  // namespace clearway
