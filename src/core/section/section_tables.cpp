#include "core/section/section_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "clearway/error.hpp"
#include "core/section/section_intrusions.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_map.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// Shares of a cell below which the border of a band counts as that of a cell, because sums of
/// heights are rounded.
constexpr double kSameBorder = 1e-6;

/// A band, and the rows of cells that it touches.
struct Rows {
  double z_from, z_to;
  double k_from, k_to;  ///< k_from <= k < k_to
};

double base_of(const SectionLattice& lattice, const SectionHeights& heights) {
  const double bottom = lattice.k_from * lattice.cell, top = lattice.k_to * lattice.cell;
  if (!heights.base) return bottom <= 0 && top > 0 ? 0 : bottom;
  const double base = *heights.base;
  if (base >= bottom - kSameBorder * lattice.cell) return base;
  throw UsageError(
      "the base z = " + format_number(base) +
      " is below the window of the section, which begins at z = " + format_number(bottom) +
      ", so that nothing is known in between; expected a base in the window");
}

std::vector<Rows> rows_of_bands(const Section& section, const SectionHeights& heights) {
  const std::string doubt = doubt_about(section.data());
  if (!doubt.empty()) throw UsageError("the section has no widths, because " + doubt);
  const SectionLattice lattice = lattice_of(section.data());
  const double g = lattice.cell;
  double band = heights.band;
  if (band == 0) band = section.data().length_unit.ends_with("foot") ? 0.1 / 0.3048 : 0.1;
  if (!(std::isfinite(band) && band > 0 && std::isfinite(heights.base.value_or(0)))) {
    throw UsageError("bands of height " + format_number(band) + " from " +
                     format_number(heights.base.value_or(0)) +
                     "; expected a height above 0, and a base");
  }
  const double base = base_of(lattice, heights);
  if (lattice.j_from >= 0 || lattice.j_to <= 0) {
    throw UsageError(
        "the window of the section lacks the middle, y = 0, so that it has no widths "
        "to the left and to the right; expected a window on both sides of it");
  }
  constexpr double kMostBands = 1e6;
  const double end = std::floor((lattice.k_to * g - base) / band + kSameBorder);
  const UnitFactor times(band);  // of ten bands of 0.1 the sum is 1
  std::vector<Rows> rows;
  if (end > kMostBands) {
    throw UsageError("bands of height " + format_number(band) + "; expected at most a million");
  }
  for (double i = 0; i < end; ++i) {
    const double from = base + times(i), to = base + times(i + 1);
    rows.push_back({from, to, std::floor(from / g + kSameBorder), std::ceil(to / g - kSameBorder)});
  }
  if (rows.empty()) {
    throw UsageError(
        "no band of height " + format_number(band) + " from " + format_number(base) +
        " upwards lies in the window, which ends at z = " + format_number(lattice.k_to * g));
  }
  return rows;
}

/// Narrows a side to a cell.
void narrow(std::optional<HalfWidth>& side, const HalfWidth& by) {
  if (!side || by.width < side->width) {
    side = by;
  } else if (by.width == side->width) {
    side->first_pose = std::min(side->first_pose, by.first_pose);
    side->is_blocked = side->is_blocked || by.is_blocked;
  }
}

/// Narrows bands by cells first .. end - 1, which are ascending by k. is_blocked: whether the cells
/// are blocked, and not unknown.
void narrow(const SectionCells& cells, std::size_t first, std::size_t end, bool is_blocked,
            const std::vector<Rows>& rows, double g, std::vector<SectionBand>& bands) {
  const auto at = [&](double k) {
    const auto begin = cells.k.begin() + static_cast<std::ptrdiff_t>(first);
    const auto last = cells.k.begin() + static_cast<std::ptrdiff_t>(end);
    return static_cast<std::size_t>(
        std::lower_bound(begin, last, k, [](std::int32_t a, double b) { return a < b; }) -
        cells.k.begin());
  };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t stop = at(rows[r].k_to);
    for (std::size_t i = at(rows[r].k_from); i < stop; ++i) {
      const double j = cells.j[i];
      if (j >= 0) {
        narrow(bands[r].left, {g * j, cells.first_pose[i], is_blocked});
      } else {
        narrow(bands[r].right, {g * (-j - 1), cells.first_pose[i], is_blocked});
      }
    }
  }
}

/// Bands that nothing narrows.
std::vector<SectionBand> open_bands(const std::vector<Rows>& rows) {
  std::vector<SectionBand> bands;
  for (const Rows& row : rows) bands.push_back({row.z_from, row.z_to, {}, {}});
  return bands;
}

}  // namespace

double section_base(const Section& section, const SectionHeights& heights) {
  return base_of(lattice_of(section.data()), heights);
}

double kept_beside(const SectionFacts& section) {
  return section.rounding + (section.motion ? (*section.motion)[1] / 2 : 0);
}

namespace {

/// What the largest load keeps from the borders of blocked cells on each side.
double inset_of(const SectionFacts& section) { return section.rounding + kept_beside(section); }

/// The room to the left and to the right; an open side ends at the border of the window.
std::array<double, 2> room_beside(const SectionFacts& section, const SectionBand& band) {
  const SectionLattice lattice = lattice_of(section);
  return {band.left ? band.left->width : lattice.j_to * lattice.cell,
          band.right ? band.right->width : -lattice.j_from * lattice.cell};
}

bool has_room(const SectionFacts& section, const SectionBand& band) {
  const auto [left, right] = room_beside(section, band);
  return std::min(left, right) > 2 * inset_of(section);
}

}  // namespace

std::optional<double> symmetric_width(const SectionFacts& section, const SectionBand& band) {
  if (!band.left && !band.right) return std::nullopt;
  const auto [left, right] = room_beside(section, band);
  return std::max(0.0, 2 * std::min(left, right) - 2 * kept_beside(section));
}

std::vector<SectionBand> section_bands(const Section& section, const SectionHeights& heights) {
  const std::vector<Rows> rows = rows_of_bands(section, heights);
  const double g = section.data().parameters.cell;
  std::vector<SectionBand> bands = open_bands(rows);
  narrow(section.cells(), 0, section.cells().size(), true, rows, g, bands);
  narrow(section.unknown_cells(), 0, section.unknown_cells().size(), false, rows, g, bands);
  return bands;
}

std::vector<SectionStretch> section_stations(const Section& section,
                                             const SectionHeights& heights) {
  const std::vector<Rows> rows = rows_of_bands(section, heights);
  std::vector<SectionStretch> stretches;
  for (const std::uint32_t bin : section.data().bins) stretches.push_back({bin, open_bands(rows)});
  const auto narrow_by = [&](const SectionCells& cells, bool is_blocked) {
    std::size_t first = 0;
    for (SectionStretch& stretch : stretches) {
      std::size_t end = first;
      while (end < cells.size() && cells.bin[end] == stretch.bin) ++end;
      narrow(cells, first, end, is_blocked, rows, section.data().parameters.cell, stretch.bands);
      first = end;
    }
  };
  narrow_by(section.data().bin_cells, true);
  if (section.data().unknown) narrow_by(*section.data().unknown, false);
  return stretches;
}

SectionHeights heights_of_load(const Section& section, const SectionHeights& heights) {
  SectionHeights out = heights;
  const std::vector<SectionBand> bands = section_bands(section, heights);
  const auto lowest = std::ranges::find_if(
      bands, [&](const SectionBand& band) { return has_room(section.data(), band); });
  if (!out.base && lowest != bands.end() && lowest != bands.begin()) out.base = lowest->z_from;
  return out;
}

std::vector<SectionBand> section_boxes(const Section& section, const SectionHeights& heights) {
  std::vector<SectionBand> boxes = section_bands(section, heights_of_load(section, heights));
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    const SectionBand& below = boxes[i - 1];
    boxes[i].z_from = boxes[0].z_from;
    if (below.left) narrow(boxes[i].left, *below.left);
    if (below.right) narrow(boxes[i].right, *below.right);
  }
  return boxes;
}

namespace {

/// Adds the corners of one side from the base upwards. away: 1 to the left, -1 to the right.
void add_side(const std::vector<SectionBand>& bands, const std::vector<double>& widths, double away,
              double inset, std::vector<OutlinePoint>& side) {
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const double y = away * (widths[i] - inset);
    if (i > 0 && widths[i] == widths[i - 1]) continue;
    if (i == 0) {
      side.push_back({y, bands[0].z_from + inset});
      continue;
    }
    const double step = widths[i] < widths[i - 1] ? -inset : inset;
    side.push_back({side.back().y, bands[i].z_from + step});
    side.push_back({y, bands[i].z_from + step});
  }
  side.push_back({side.back().y, bands[widths.size() - 1].z_to - inset});
}

}  // namespace

std::vector<OutlinePoint> largest_outline(const Section& section, const SectionHeights& heights) {
  const std::vector<SectionBand> bands = section_bands(section, heights_of_load(section, heights));
  const double inset = inset_of(section.data());
  std::vector<double> left, right;
  for (const SectionBand& band : bands) {
    if (!has_room(section.data(), band)) break;
    const auto [to_left, to_right] = room_beside(section.data(), band);
    left.push_back(to_left);
    right.push_back(to_right);
  }
  if (left.empty() || bands[0].z_to - bands[0].z_from <= 2 * inset) {
    throw UsageError("no load stands at z = " + format_number(bands[0].z_from) +
                     ", where the middle is blocked; expected a base above the ground");
  }
  std::vector<OutlinePoint> outline, other;
  add_side(bands, right, -1, inset, outline);
  add_side(bands, left, 1, inset, other);
  outline.insert(outline.end(), other.rbegin(), other.rend());
  return outline;
}

}  // namespace clearway
