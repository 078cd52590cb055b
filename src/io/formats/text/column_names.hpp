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
  char separator = ' ';  ///< ',', ';' or ' ' for any blanks
  /// Names in lower case, without quotes, bracketed units and blanks.
  std::vector<std::string> names;
  std::vector<std::string> units;  ///< units in brackets, lower case; empty where a column has none

  /// The index of the only column whose name is one of `prefixes` followed by `suffix`; nullopt
  /// where there is no such column or more than one.
  std::optional<std::size_t> find(std::span<const std::string_view> prefixes,
                                  std::string_view suffix) const;
};

/// Splits a header line. A comment mark (#, // or %) before the first name is dropped.
ColumnNames parse_column_names(std::string_view line);

/// Splits a line of data in the same way as its header: at every comma or semicolon, or at runs of
/// blanks. fields: views of `line`, including blanks around them; the vector keeps its capacity.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Splits a line of CSV (RFC 4180), where a separator within a field in double quotes does not
/// count.
void split_quoted_fields(std::string_view line, char separator,
                         std::vector<std::string_view>& fields);

}  // namespace clearway
