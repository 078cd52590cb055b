#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/scans/point_reader.hpp"

namespace clearway {

/// Names of columns, in lower case.
using ColumnNames = std::span<const std::string_view>;

inline constexpr std::string_view kLatitudeColumns[] = {"lat", "latitude"};
inline constexpr std::string_view kLongitudeColumns[] = {"lon", "long", "lng", "longitude"};
inline constexpr std::string_view kRollColumns[] = {"roll"};
inline constexpr std::string_view kPitchColumns[] = {"pitch"};
inline constexpr std::string_view kHeadingColumns[] = {"heading", "azimuth"};
inline constexpr std::string_view kYawColumns[] = {"yaw"};

/// A line that names the columns of a text table.
struct TableHeader {
  char separator = ' ';  ///< ',', ';' or ' ' for any blanks
  /// Names in lower case, without quotes, blanks and units: "X_ft" and "x [ft]" are both "x".
  std::vector<std::string> names;
  /// The unit of each column, given in brackets or after `_`, in lower case; or empty.
  std::vector<std::string> units;
  std::vector<std::string> written;  ///< the names with units after `_`, such as "x_ft"

  /// The index of the only column whose name is one of `prefixes` followed by `suffix`; nullopt
  /// where there is no such column or more than one.
  std::optional<std::size_t> find(ColumnNames prefixes, std::string_view suffix = {}) const;
  std::optional<std::size_t> find(std::string_view name) const { return find({&name, 1}); }
  bool has(ColumnNames any_of) const;
};

/// Splits a header line. A comment mark (#, // or %) and a label that ends in a colon are dropped.
TableHeader parse_table_header(std::string_view line);

/// The lower-case form of a name, as TableHeader holds it, with a unit after `_`.
std::string table_name(std::string_view field);

/// Splits a line of data in the same way as its header: at every comma or semicolon, or at runs of
/// blanks. fields: views of `line`, including blanks around them; the vector keeps its capacity.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Splits a line of CSV (RFC 4180), where a separator within a field in double quotes does not
/// count.
void split_quoted_fields(std::string_view line, char separator,
                         std::vector<std::string_view>& fields);

/// Indices of the columns that hold x, y and z.
using CoordinateColumns = std::array<std::size_t, 3>;

/// The columns of x, y and z, or of easting, northing and height, in any order. Nullopt where one
/// is missing or named twice.
std::optional<CoordinateColumns> coordinate_columns(const TableHeader& header);

/// Indices of the columns of a line in plan, with or without heights.
struct PlanColumns {
  std::size_t x, y;
  std::optional<std::size_t> z;
};

/// The columns of x and y, or of easting and northing, and that of z or a height where the table
/// has one. Nullopt where x or y is missing or one of them is named twice.
std::optional<PlanColumns> plan_columns(const TableHeader& header);

/// What kind of table the names indicate if not one of points, for a message; otherwise empty.
std::string other_table(const TableHeader& header);

/// The units of the columns x, y and z as the header gives them.
struct TableUnit {
  LengthUnit unit = LengthUnit::kUnknown;  ///< of x and y, or of z where they name none
  bool any_foot = false;                   ///< see StatedCrs
  double heights = 0;                      ///< metres per unit of z; 0 where it names none
  /// The unit that is not read, or the two of x and y that differ; otherwise empty.
  std::string refused = {};
};
TableUnit unit_of(const TableHeader& header, const CoordinateColumns& columns);

}  // namespace clearway
