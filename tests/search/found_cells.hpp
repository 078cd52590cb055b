#pragma once

#include <tuple>
#include <vector>

#include "search/section.hpp"
#include "support/catch.hpp"
#include "support/section_scene.hpp"

namespace clearway::test {

/// The blocked cells of maps, which are written in ascending order.
inline Blocked found_cells(const SectionLattice& lattice, const std::vector<SectionBin>& bins,
                           const SectionMaps& maps) {
  SectionCells cells;
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    add_cells_of_bin(lattice, maps.firsts(bin), static_cast<std::uint32_t>(bins[bin].number),
                     cells);
  }
  Blocked blocked;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto at = std::tuple(cells.bin[i], cells.k[i], cells.j[i]);
    CHECK((blocked.empty() || blocked.rbegin()->first < at));
    blocked.emplace(at, cells.first_pose[i]);
  }
  return blocked;
}

}  // namespace clearway::test
