#include "core/section/section_intrusions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

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
  GivingWay(std::span<const OutlinePoint> outline, double cell, double reach)
      : outline_(outline), cell_(cell), reach_(reach) {}

  /// In the order of kSides.
  std::array<double, kSideCount> depths(std::int32_t j, std::int32_t k) {
    const auto across = remembered(rows_, k, &OutlinePoint::z, &OutlinePoint::y);
    const auto up = remembered(columns_, j, &OutlinePoint::y, &OutlinePoint::z);
    return {across.to - (j * cell_ - reach_), (j + 1) * cell_ + reach_ - across.from,
            up.to - (k * cell_ - reach_), (k + 1) * cell_ + reach_ - up.from};
  }

 private:
  Extent remembered(std::map<std::int32_t, Extent>& known, std::int32_t number,
                    double OutlinePoint::*along, double OutlinePoint::*across) const {
    const auto found = known.find(number);
    if (found != known.end()) return found->second;
    return known[number] = extent_in(outline_, along, across, number * cell_ - reach_,
                                     (number + 1.0) * cell_ + reach_);
  }

  std::span<const OutlinePoint> outline_;
  double cell_, reach_;
  std::map<std::int32_t, Extent> rows_, columns_;
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
  SideSet best = kLeftAndRight;
  double least = std::numeric_limits<double>::infinity();
  for (SideSet sides = 1; sides <= kAllSides; ++sides) {
    Depths deepest{};
    for (const Depths& depths : cells) {
      const std::size_t side = least_side(depths, sides);
      deepest[side] = std::max(deepest[side], depths[side]);
    }
    const double across = deepest[0] + deepest[1], up = deepest[2] + deepest[3];
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
  const double y_to = (all.j[i] + 1) * g, z_to = (all.k[i] + 1) * g;
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
                                            GivingWay& way) {
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
  GivingWay way(outline, section.data().parameters.cell, reach);
  std::vector<std::size_t> cells;
  std::size_t i = 0;
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
