#pragma once

#include <cmath>
#include <cstdint>

#include "clearway/section.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// A rectangle of cells of the window, counted from the window's first column and row; both ends
/// belong to it.
struct SectionRect {
  std::uint32_t column_from, column_to, row_from, row_to;
};

/// The cells of a cross-section, and the range of x' in which points count (docs/design/section.md,
/// "Definitions"). The result is the same on host and device.
struct SectionLattice {
  double x_from, x_to;    ///< closed range of x', with the margin and, between poses, the motion
  double cell;            ///< side of a cell
  double per_cell;        ///< 1 / cell
  double j_from, j_to;    ///< columns: whole numbers, j_from <= j < j_to
  double k_from, k_to;    ///< rows: whole numbers, k_from <= k < k_to
  std::uint32_t columns;  ///< j_to - j_from
  std::uint32_t rows;     ///< k_to - k_from

  std::uint64_t cells() const { return std::uint64_t{columns} * rows; }

  /// The number, on any axis, of the cell at a place.
  CLEARWAY_HD double number_of(double place) const {
    return std::floor(rounded_quotient(place, cell));
  }

  /// Whether a place in the frame of the load blocks a cell of the window; false for NaN.
  CLEARWAY_HD bool find(const Vec3& place, std::uint32_t& column, std::uint32_t& row) const {
    if (!(place.x >= x_from && place.x <= x_to)) return false;
    const double j = number_of(place.y), k = number_of(place.z);
    if (!(j >= j_from && j < j_to && k >= k_from && k < k_to)) return false;
    column = static_cast<std::uint32_t>(j - j_from);
    row = static_cast<std::uint32_t>(k - k_from);
    return true;
  }

  /// The number of the cell at a bound of places. It is rounded otherwise than number_of(), by less
  /// than bounds are widened.
  CLEARWAY_IN_CLONE CLEARWAY_HD double number_at_bound(double bound) const {
    return std::floor(bound * per_cell);
  }

  /// The cells of the window that places with y' and z' in these ranges, which are widened, may
  /// block; false where there are none. An end that is NaN is taken as unbounded.
  CLEARWAY_HD bool cover(double y_from, double y_to, double z_from, double z_to,
                         SectionRect& rect) const {
    return along(number_at_bound(y_from), number_at_bound(y_to), j_from, j_to, rect.column_from,
                 rect.column_to) &&
           along(number_at_bound(z_from), number_at_bound(z_to), k_from, k_to, rect.row_from,
                 rect.row_to);
  }

 private:
  CLEARWAY_HD static bool along(double from, double to, double first, double end,
                                std::uint32_t& rect_from, std::uint32_t& rect_to) {
    if (to < first || from >= end) return false;
    rect_from = static_cast<std::uint32_t>(from > first ? from - first : 0.0);
    rect_to = static_cast<std::uint32_t>(to < end ? to - first : end - 1 - first);
    return true;
  }
};

/// The lattice of a question whose defaults have been filled in. motion: along, or 0. Throws
/// UsageError for a range or a window that is empty or not finite, and for cells that are not above
/// 0, or so small that the window has 2^31 of them or numbers beyond 32 bits.
SectionLattice section_lattice(const SectionParameters& parameters, double motion);

/// The lattice of a section that was found.
SectionLattice lattice_of(const SectionFacts& section);

}  // namespace clearway
