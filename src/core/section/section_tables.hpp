#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "clearway/section.hpp"

/// Tables of widths that follow from the cells of a section.
namespace clearway {

/// The way from the middle, y = 0, to the nearest cell on one side that is blocked or not known.
struct HalfWidth {
  double width;  ///< to the cell's border
  std::uint32_t
      first_pose;          ///< the first pose that blocks a cell there, or at which it is not known
  bool is_blocked = true;  ///< whether a cell there is blocked; otherwise they are not known
};

/// The room between two heights; a side without a value is open up to the border of the window.
struct SectionBand {
  double z_from, z_to;
  std::optional<HalfWidth> left, right;
};

/// The bands of a bin, or of the whole path.
struct SectionStretch {
  std::uint32_t bin = 0;
  std::vector<SectionBand> bands;
};

/// What a load may not use of each half-width: rounding, and between poses half of the motion
/// across.
double kept_beside(const SectionFacts& section);

/// The width of a load that is as wide to the left as to the right; none where both sides are open.
/// A side that is open ends at the border of the window.
std::optional<double> symmetric_width(const SectionFacts& section, const SectionBand& band);

/// The height at which the first band begins. Throws UsageError where it is below the window.
double section_base(const Section& section, const SectionHeights& heights);

/// The bands that lie in the window, from the base upwards. A band has the cells that have more
/// than a millionth of a cell's side of its height. Its left is the least j g of those of them with
/// j >= 0 that are blocked or not known, with the side g of a cell, and its right the least of
/// -(j + 1) g of those with j < 0. Throws UsageError where the section is in doubt, the window
/// lacks the middle or has no whole band, or the base is below the window, and for heights that are
/// not finite or not above 0.
std::vector<SectionBand> section_bands(const Section& section, const SectionHeights& heights);

/// The bands of each bin in which the load has a pose, ascending. Throws as section_bands().
std::vector<SectionStretch> section_stations(const Section& section, const SectionHeights& heights);

/// The heights with the base on which a load stands: the one that is given; without one the bottom
/// of the lowest band that has room for a load in its middle, because what lies below is most often
/// the ground. Where no band has room, the base of section_base(). Throws as section_bands().
SectionHeights heights_of_load(const Section& section, const SectionHeights& heights);

/// For each band from the base of heights_of_load() on, the room from there up to its top; z_from
/// is that base. Throws as section_bands().
std::vector<SectionBand> section_boxes(const Section& section, const SectionHeights& heights);

/// The outline of the largest load that stands on the base of heights_of_load(), inset by more than
/// kept_beside(), counter-clockwise when looking forward with y to the left. Open sides end at the
/// window. Throws as section_bands(), and where no load stands on the base.
std::vector<OutlinePoint> largest_outline(const Section& section, const SectionHeights& heights);

}  // namespace clearway
