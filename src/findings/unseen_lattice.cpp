#include "findings/unseen_lattice.hpp"

#include <cmath>

namespace clearway {

CubeLattice lattice_of_unseen(const ResultHeader& header, const SeenSummary& seen) {
  constexpr double kUsualSides[] = {0.2, 0.2 / 0.3048, 0.2 * 3937 / 1200};
  const double* scale = header.quantisation.scale;
  const std::int64_t along_x = std::llround(seen.cube / scale[0]);
  double asked = header.seen_cube;
  for (const double usual : kUsualSides) {
    if (!(asked > 0) && std::llround(usual / scale[0]) == along_x) asked = usual;
  }
  if (!(asked > 0)) asked = seen.cube;
  CubeLattice lattice{};
  for (int k = 0; k < 3; ++k) {
    lattice.side[k] = std::llround(asked / scale[k]);
    lattice.inset[k] = lattice.side[k] / 4;
  }
  return lattice;
}

Vec3 middle_of_cube(const CubeLattice& lattice, const Quantisation& quantisation,
                    const std::array<std::int32_t, 3>& cube) {
  return middle_of(lattice, quantisation, Cube{{cube[0], cube[1], cube[2]}});
}

}  // namespace clearway
