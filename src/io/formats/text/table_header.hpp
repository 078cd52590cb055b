#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/point_reader.hpp"

namespace clearway {

/// Indices of the columns that hold x, y and z.
using CoordinateColumns = std::array<std::size_t, 3>;

/// A line that names the columns of a table of points.
struct TableHeader {
  char separator = ' ';            ///< ',', ';' or ' ' for any blanks
  std::vector<std::string> names;  ///< lower case, without quotes, blanks and units
  std::vector<std::string> units;  ///< of each name, as in brackets or behind `_`; lower case
};

/// Splits a header line. A comment mark and a label that ends in a colon are dropped.
TableHeader parse_table_header(std::string_view line);

/// The lower-case form of a name, as TableHeader holds it.
std::string table_name(std::string_view field);

/// The index of the only column of that name; none where there is no such column or more than one.
std::optional<std::size_t> column_named(const TableHeader& header, std::string_view name);

/// x, y and z; or easting, northing and a height, in whatever order. None where one is missing or
/// named twice.
std::optional<CoordinateColumns> coordinate_columns(const TableHeader& header);

/// What other table than one of points the names tell, for a message; empty where they do not.
std::string other_table(const TableHeader& header);

/// The unit of the three columns as the header says.
struct TableUnit {
  LengthUnit unit = LengthUnit::kUnknown;
  bool any_foot = false;  ///< see CloudInfo
  std::string refused;    ///< a unit that is not read, or two different ones; empty: none
};
TableUnit unit_of(const TableHeader& header, const CoordinateColumns& columns);

}  // namespace clearway
