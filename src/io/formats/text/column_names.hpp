#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// The line of a text table that names its columns.
struct ColumnNames {
  char separator = ' ';            ///< ',', ';' or ' ' for any blanks
  std::vector<std::string> names;  ///< lower case, without quotes, units in brackets and blanks
  std::vector<std::string> units;  ///< those in brackets, lower case; empty where there is none

  /// The index of the only column whose name is one of `prefixes` with `suffix` behind it; none
  /// where there is no such column or more than one.
  std::optional<std::size_t> find(std::span<const std::string_view> prefixes,
                                  std::string_view suffix) const;
};

/// Splits a header line. A comment mark (#, // or %) before the first name is dropped.
ColumnNames parse_column_names(std::string_view line);

/// Splits a line of data as its header was: at every comma or semicolon, or at runs of blanks.
/// fields: views of `line`, blanks around them included; its capacity is kept.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// The same of CSV (RFC 4180): no separator within a field in double quotes counts.
void split_quoted_fields(std::string_view line, char separator,
                         std::vector<std::string_view>& fields);

}  // namespace clearway
