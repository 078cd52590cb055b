#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/report.hpp"
#include "clearway/vec3.hpp"
#include "core/util/progress.hpp"
#include "io/files/json.hpp"
#include "report/page_parts.hpp"

namespace clearway {

/// The lattice of the points on the page: a point with the integers q lies at origin + step * q.
struct PageLattice {
  Vec3 origin{};
  double step = 0.001;
};

/// A lattice for the points of a box. Its step is `finest` or, for a large box, so much coarser
/// that the integers of every point have 31 bits.
PageLattice lattice_for(const Box& box, double finest);

/// A point on the page, with what the browser needs to know about it.
struct PagePoint {
  std::int32_t q[3];
  /// The height of an environment point (EnvironmentSample), the class of a point of the result
  /// (ShownPoints), or the body of a model point.
  std::uint8_t tag;
};

PagePoint page_point(const PageLattice& lattice, const Vec3& xyz, std::uint8_t tag);

/// Sorts points along a Morton curve, so that neighbours follow each other and their differences
/// are small. The order depends only on the points.
void sort_along_curve(std::vector<PagePoint>& points);

/// A column of the page: the bytes that the browser reads, which write_page() compresses. Integers
/// are delta_planes(), tags and texts plain bytes.
struct PageColumn {
  std::string name;
  std::string bytes;
};

/// The differences of consecutive values, from 0 on, zigzag-encoded (0, -1, 1, -2 become 0, 1, 2,
/// 3), in four planes of bytes, the lowest first.
std::string delta_planes(std::span<const std::int32_t> values);

/// Appends the columns NAME.x, NAME.y, NAME.z and NAME.tag.
void append_columns(const std::string& name, const std::vector<PagePoint>& points,
                    std::vector<PageColumn>& columns);

/// What the facts of every page begin with: the version, and the texts of its head.
Json page_head(const PageTexts& texts, const std::string& title);

/// What is put into the parts of a page.
struct PageContent {
  std::string title;
  std::string facts;         ///< JSON
  std::string section = {};  ///< the picture of a section, an SVG element; or empty
  std::vector<PageColumn> columns = {};
};

/// Writes a page of page_parts.hpp with its content. Returns its size in bytes. Throws
/// ResourceError.
std::uint64_t write_page(const std::filesystem::path& path, std::string_view page,
                         PageContent content);

}  // namespace clearway
