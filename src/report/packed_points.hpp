#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The lattice of the points on the page: a point is origin + step * q.
struct PageLattice {
  Vec3 origin{};
  double step = 0.001;
};

/// Fine enough for a radius, coarse enough that every point of the box has a 31-bit place.
PageLattice lattice_for(const Box& box, double finest);

/// A point on the page, with what the browser needs to know of it.
struct PagePoint {
  std::int32_t q[3];
  std::uint8_t tag;  ///< of an environment point its height, of others their class
  friend auto operator<=>(const PagePoint&, const PagePoint&) = default;
};

PagePoint page_point(const PageLattice& lattice, const Vec3& xyz, std::uint8_t tag);

/// Along a Morton curve, so that neighbours follow each other and their differences are small.
/// The order is a function of the points alone.
void sort_along_curve(std::vector<PagePoint>& points);

/// A column of the page: its bytes, deflated and in base64. docs/design/report.md has the layout.
struct PageColumn {
  std::string name;
  std::string base64;
};

/// Differences of consecutive values, zigzag, in four planes of bytes.
std::string delta_planes(std::span<const std::int32_t> values);

/// zlib format, then base64.
std::string deflated_base64(std::string_view bytes);

/// Columns NAME.x, NAME.y, NAME.z and NAME.tag.
void append_columns(const std::string& name, const std::vector<PagePoint>& points,
                    std::vector<PageColumn>& columns);

}  // namespace clearway
