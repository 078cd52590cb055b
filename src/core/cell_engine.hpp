#pragma once

#include <cstdint>
#include <vector>

#include "core/clearance_set.hpp"

namespace clearway {

/// A cell within reach of the trajectory, and the nodes of the motion tree that may touch it.
struct PlannedCell {
  std::uint32_t cell;
  std::vector<std::uint32_t> nodes;
};

/// What an engine found in one cell.
struct CellAnswer {
  std::uint32_t cell = 0;
  std::vector<std::uint64_t> hits;  ///< a word a block
  std::vector<std::uint32_t>
      first_poses;                    ///< a pose a slot (HitSet::kNever: none), where asked for
  std::vector<Clearance> clearances;  ///< one a slot, where asked for
};

/// The one interface by which the pipeline knows an engine that works cell by cell. Thread safe.
class CellEngine {
 public:
  virtual ~CellEngine() = default;
  /// Throws InputError for a damaged cell.
  virtual CellAnswer search(const PlannedCell& planned) = 0;
};

}  // namespace clearway
