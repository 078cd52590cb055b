#pragma once

#include <tuple>

#include "core/describe/field.hpp"

namespace clearway {

/// How tables show a column.
struct ColumnUse {
  bool is_in_files = true;  ///< whether CSV, JSON, GeoJSON, GeoPackage and pages have it
  /// Whether these leave it out where a row has no value, instead of saying that it has
  /// none. Then either all rows of a table have a value or none has.
  bool is_left_out = false;
  /// Whether tables for people round it up, because less than the length would not be enough.
  bool rounds_up = false;
};

/// A column of a table of findings, such as that of conflicts: a member of its rows, with its names
/// and texts for the files, the pages and Python. for_each_field() visits the columns of a list.
template <typename Row, typename Type>
struct FindingColumn {
  using Value = Type;

  Type Row::*member;
  const char* key;  ///< name in files, on pages and in Python
  const char* doc;  ///< documentation in Python and in the guide
  ColumnUse use;

  const Type& of(const Row& row) const { return row.*member; }
  Type& of(Row& row) const { return row.*member; }
};

template <typename Row, typename Type>
constexpr FindingColumn<Row, Type> column(Type Row::*member, const char* key, const char* doc,
                                          const ColumnUse& use = {}) {
  return {member, key, doc, use};
}

/// Where a stretch of the path begins and ends.
template <typename Row>
inline constexpr std::tuple kChainagesOfStretch{
    column(&Row::chainage_from, "chainage_from",
           "Where the stretch begins, in metres along the path."),
    column(&Row::chainage_to, "chainage_to", "Where the stretch ends, in metres along the path.")};

/// The stations of a stretch of the path, which rows have where the labels of the poses do.
template <typename Row, bool kIsLeftOut = false>
inline constexpr std::tuple kStationsOfStretch{
    column(&Row::station_from, "station_from",
           "The station of chainage_from along the alignment, in metres; only where the trajectory "
           "has stations.",
           {.is_left_out = kIsLeftOut}),
    column(&Row::station_to, "station_to",
           "The station of chainage_to along the alignment, in metres; only where the trajectory "
           "has stations.",
           {.is_left_out = kIsLeftOut})};

}  // namespace clearway
