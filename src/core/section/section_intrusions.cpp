#include "core/section/section_intrusions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/section/section_lattice.hpp"

namespace clearway {
namespace {

constexpr std::array kSides{Side::kLeft, Side::kRight, Side::kAbove, Side::kBelow};
constexpr std::size_t kSideCount = kSides.size();

struct Extent {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();

  void add(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
};

/// From where to where an outline reaches across, in the strip where `along` is from .. to.
Extent extent_in(std::span<const OutlinePoint> outline, double OutlinePoint::*along,
                 double OutlinePoint::*across, double from, double to) {
  Extent extent;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    OutlinePoint a = outline[i], b = outline[(i + 1) % outline.size()];
    if (a.*along > b.*along) std::swap(a, b);
    if (b.*along < from || a.*along > to) continue;
    const auto at = [&](double place) {
      const double way = b.*along - a.*along;
      const double share = way > 0 ? std::clamp((place - a.*along) / way, 0.0, 1.0) : 0;
      return a.*across + share * (b.*across - a.*across);
    };
    extent.add(at(std::max(from, a.*along)));
    extent.add(at(std::min(to, b.*along)));
    if (a.*along == b.*along) extent.add(b.*across);
  }
  return extent;
}

/// How much a load has to give way for cells, on each side.
class GivingWay {
 public:
  GivingWay(std::span<const OutlinePoint> outline, const SectionLattice& lattice, double reach)
      : cell_(lattice.cell),
        reach_(reach),
        j_from_(static_cast<std::int64_t>(lattice.j_from)),
        k_from_(static_cast<std::int64_t>(lattice.k_from)),
        across_(lattice.rows),
        up_(lattice.columns) {
    const auto fill = [&](std::vector<Extent>& extents, double first, double OutlinePoint::*along,
                          double OutlinePoint::*across) {
      for (std::size_t i = 0; i < extents.size(); ++i) {
        const double at = first + static_cast<double>(i);
        extents[i] =
            extent_in(outline, along, across, at * cell_ - reach, (at + 1) * cell_ + reach);
      }
    };
    fill(across_, lattice.k_from, &OutlinePoint::z, &OutlinePoint::y);
    fill(up_, lattice.j_from, &OutlinePoint::y, &OutlinePoint::z);
  }

  /// In the order of kSides, for a cell of the window that stops the load.
  std::array<double, kSideCount> depths(double j, double k) const {
    const Extent& across =
        across_[static_cast<std::size_t>(static_cast<std::int64_t>(k) - k_from_)];
    const Extent& up = up_[static_cast<std::size_t>(static_cast<std::int64_t>(j) - j_from_)];
    return {across.to - (j * cell_ - reach_), (j + 1) * cell_ + reach_ - across.from,
            up.to - (k * cell_ - reach_), (k + 1) * cell_ + reach_ - up.from};
  }

 private:
  double cell_, reach_;
  std::int64_t j_from_, k_from_;
  std::vector<Extent> across_, up_;  ///< of the strip of each row, and of each column
};

using Depths = std::array<double, kSideCount>;

/// Sides as bits, in the order of kSides.
using SideSet = unsigned;
constexpr SideSet kAllSides = (1U << kSideCount) - 1;

/// The side of a set where a cell reaches in least.
std::size_t least_side(const Depths& depths, SideSet sides) {
  std::size_t least = kSideCount;
  for (std::size_t s = 0; s < kSideCount; ++s) {
    if ((sides >> s & 1) == 0) continue;
    if (least == kSideCount || depths[s] < depths[least]) least = s;
  }
  return least;
}

/// The size of an outline across and up.
struct Size {
  double across, up;
};

Size size_of(std::span<const OutlinePoint> outline) {
  const auto [right, left] = std::ranges::minmax(outline, {}, &OutlinePoint::y);
  const auto [low, high] = std::ranges::minmax(outline, {}, &OutlinePoint::z);
  return {left.y - right.y, high.z - low.z};
}

/// The sides on which a load has to give way least, in sum, so that something of it is left; of
/// equal ones the fewest. Left and right where nothing would be left on any sides.
SideSet sides_for(std::span<const Depths> cells, const Size& load) {
  constexpr SideSet kLeftAndRight = 3;
  std::array<Depths, kAllSides + 1> deepest{};
  std::array<std::size_t, kAllSides + 1> nearest{};
  for (const Depths& depths : cells) {
    for (SideSet sides = 1; sides <= kAllSides; ++sides) {
      // The set without its last side has been looked at already.
      const auto last = static_cast<std::size_t>(std::bit_width(sides) - 1);
      const SideSet others = sides ^ 1U << last;
      const bool is_last = others == 0 || depths[last] < depths[nearest[others]];
      nearest[sides] = is_last ? last : nearest[others];
      double& most = deepest[sides][nearest[sides]];
      most = std::max(most, depths[nearest[sides]]);
    }
  }
  SideSet best = kLeftAndRight;
  double least = std::numeric_limits<double>::infinity();
  for (SideSet sides = 1; sides <= kAllSides; ++sides) {
    const Depths& of = deepest[sides];
    const double across = of[0] + of[1], up = of[2] + of[3];
    if (across >= load.across || up >= load.up) continue;
    const double sum = across + up;
    if (sum > least || (sum == least && std::popcount(sides) >= std::popcount(best))) continue;
    least = sum;
    best = sides;
  }
  return best;
}

/// Takes a cell, given by its index, into the intrusion of a side.
void add_cell(const SectionData& section, std::size_t i, double depth, SectionIntrusion& side) {
  const SectionCells& all = section.bin_cells;
  const double g = section.parameters.cell, y = all.j[i] * g, z = all.k[i] * g;
  const double y_to = (all.j[i] + 1.0) * g, z_to = (all.k[i] + 1.0) * g;
  if (side.cells == 0) {
    side.y_from = y;
    side.y_to = y_to;
    side.z_from = z;
    side.z_to = z_to;
  }
  side.y_from = std::min(side.y_from, y);
  side.y_to = std::max(side.y_to, y_to);
  side.z_from = std::min(side.z_from, z);
  side.z_to = std::max(side.z_to, z_to);
  if (side.cells++ > 0 && depth <= side.depth) return;
  side.depth = depth;
  side.first_pose = all.first_pose[i];
  side.chainage = section.chainage[side.first_pose];
  side.cell = {all.j[i], all.k[i]};
}

/// The intrusions of cells of one bin, which are given by their indices.
std::vector<SectionIntrusion> intrusions_of(const SectionData& section,
                                            std::span<const std::size_t> cells, const Size& load,
                                            const GivingWay& way) {
  std::vector<Depths> depths;
  for (const std::size_t i : cells) {
    depths.push_back(way.depths(section.bin_cells.j[i], section.bin_cells.k[i]));
  }
  const SideSet sides = sides_for(depths, load);
  std::array<SectionIntrusion, kSideCount> found;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const std::size_t side = least_side(depths[n], sides);
    add_cell(section, cells[n], depths[n][side], found[side]);
  }
  std::vector<SectionIntrusion> out;
  for (std::size_t s = 0; s < kSideCount; ++s) {
    found[s].side = kSides[s];
    if (found[s].cells > 0) out.push_back(found[s]);
  }
  return out;
}

}  // namespace

void find_intrusions(const Section& section, std::span<const OutlinePoint> outline, double reach,
                     const std::vector<bool>& stops_load, std::vector<SectionStop>& stops) {
  const SectionCells& all = section.data().bin_cells;
  const GivingWay way(outline, lattice_of(section.data()), reach);
  std::vector<std::size_t> cells;
  if (stops.empty()) return;
  auto i = static_cast<std::size_t>(std::ranges::lower_bound(all.bin, stops.front().bin) -
                                    all.bin.begin());
  for (SectionStop& stop : stops) {
    cells.clear();
    while (i < all.size() && all.bin[i] < stop.bin) ++i;
    for (; i < all.size() && all.bin[i] == stop.bin; ++i) {
      if (stops_load[index_of_cell(section.cells(), all.j[i], all.k[i])]) cells.push_back(i);
    }
    stop.intrusions = intrusions_of(section.data(), cells, size_of(outline), way);
  }
}

}  // namespace clearway
