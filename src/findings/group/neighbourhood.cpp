#include "findings/group/neighbourhood.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

using Wide = unsigned __int128;

/// More than the diagonal of all stored integers.
constexpr double kAllSteps = 0x1p33;
/// The longest edge of a grid cell, which holds all stored integers.
constexpr double kLongestEdge = 0x1p32;
constexpr double kWholeWithin = 1e-9;
/// Up to this reach, the squares of three differences that are not above it sum up within 64 bits.
constexpr std::uint64_t kNarrowReach = std::uint64_t{1} << 31;

/// floor(steps^2); a number that is nearly whole is taken as whole.
Wide squared_steps(double steps) {
  const double whole = std::nearbyint(steps);
  if (std::abs(steps - whole) > kWholeWithin) return static_cast<Wide>(steps * steps);
  const auto n = static_cast<std::uint64_t>(whole);
  return Wide{n} * n;
}

std::uint64_t floor_of_root(Wide squared) {
  auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(squared)));
  while (Wide{root} * root > squared) --root;
  while (Wide{root + 1} * (root + 1) <= squared) ++root;
  return root;
}

}  // namespace

Neighbourhood::Neighbourhood(const Quantisation& quantisation, double gap)
    : exact_(quantisation.scale[0] == quantisation.scale[1] &&
             quantisation.scale[1] == quantisation.scale[2]),
      squared_gap_(gap * gap) {
  for (int k = 0; k < 3; ++k) step_[static_cast<std::size_t>(k)] = quantisation.scale[k];
  if (exact_) {
    squared_ = squared_steps(std::min(gap / quantisation.scale[0], kAllSteps));
    reach_ = floor_of_root(squared_);
    wide_ = reach_ > kNarrowReach;
  }
  choose_cell(gap);
}

void Neighbourhood::choose_cell(double gap) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double most = std::min(std::floor(gap / (std::sqrt(3.0) * step_[k])), kLongestEdge);
    cell_[k] = static_cast<std::uint64_t>(most) + 1;
  }
  while (!within(cell_[0] - 1, cell_[1] - 1, cell_[2] - 1)) {
    for (std::uint64_t& edge : cell_) edge = std::max<std::uint64_t>(1, edge - 1);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t& away = cells_away_[k];
    const auto reached = [&](std::uint32_t cells) {
      const std::uint64_t d = least(cells, k);
      return d <= (std::uint64_t{1} << 32) &&
             within(k == 0 ? d : 0, k == 1 ? d : 0, k == 2 ? d : 0);
    };
    while (reached(away + 1)) ++away;
  }
}

bool Neighbourhood::within_wide(std::uint64_t dx, std::uint64_t dy, std::uint64_t dz) const {
  return Wide{dx} * dx + Wide{dy} * dy + Wide{dz} * dz <= Wide{squared_};
}

}  // namespace clearway
