#include "io/formats/text/column_names.hpp"

#include <algorithm>
#include <utility>

namespace clearway {
namespace {

std::string_view without_mark(std::string_view line) {
  for (const std::string_view mark : {"#", "//", "%"}) {
    if (line.starts_with(mark)) {
      line.remove_prefix(mark.size());
      break;
    }
  }
  return line;
}

/// The field in lower case, without quotes and blanks.
std::string cleaned(std::string_view field) {
  std::string name;
  for (const char c : field) {
    if (c == ' ' || c == '\t' || c == '"' || c == '\'') continue;
    name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return name;
}

/// The name in a header's field: "  \"p_x [m]\"" becomes "p_x".
std::string name_in(std::string_view field) {
  return cleaned(field.substr(0, field.find_first_of("[(", 1)));
}

/// The unit in a header's field: "  \"p_x [m]\"" becomes "m".
std::string unit_in(std::string_view field) {
  const std::size_t open = field.find_first_of("[(", 1);
  if (open == std::string_view::npos) return {};
  field.remove_prefix(open + 1);
  return cleaned(field.substr(0, field.find_first_of("])")));
}

/// Joins names with their units, because "roll [deg]" is one column even where blanks separate
/// columns.
void join_units(std::string_view line, std::vector<std::string_view>& fields) {
  std::vector<std::string_view> joined;
  for (const std::string_view field : fields) {
    if (!joined.empty() && (field.front() == '[' || field.front() == '(')) {
      const char* const start = joined.back().data();
      const std::size_t length = static_cast<std::size_t>(field.data() - start) + field.size();
      joined.back() = line.substr(static_cast<std::size_t>(start - line.data()), length);
    } else {
      joined.push_back(field);
    }
  }
  fields = std::move(joined);
}

/// Index of the end of the field whose quotes open at `open`; 0 where the quotes do not close right
/// before a separator or the end of the line.
std::size_t end_of_quoted(std::string_view line, std::size_t open, char separator) {
  for (std::size_t at = line.find('"', open + 1); at != std::string_view::npos;
       at = line.find('"', at + 1)) {
    if (at + 1 < line.size() && line[at + 1] == '"') {
      ++at;  // two quotes in a quoted field stand for one
      continue;
    }
    const std::size_t end = std::min(line.find_first_not_of(" \t", at + 1), line.size());
    return end == line.size() || line[end] == separator ? end : 0;
  }
  return 0;
}

}  // namespace

std::optional<std::size_t> ColumnNames::find(std::span<const std::string_view> prefixes,
                                             std::string_view suffix) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string_view name = names[i];
    if (!name.ends_with(suffix)) continue;
    name.remove_suffix(suffix.size());
    if (std::find(prefixes.begin(), prefixes.end(), name) == prefixes.end()) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t start = line.find_first_not_of(" \t", at);
      if (start == std::string_view::npos) break;
      at = std::min(line.find_first_of(" \t", start), line.size());
      fields.push_back(line.substr(start, at - start));
    }
    return;
  }
  for (std::size_t start = 0;;) {
    const std::size_t end = std::min(line.find(separator, start), line.size());
    fields.push_back(line.substr(start, end - start));
    if (end == line.size()) break;
    start = end + 1;
  }
}

void split_quoted_fields(std::string_view line, char separator,
                         std::vector<std::string_view>& fields) {
  split_fields(line, separator, fields);
  if (separator == ' ' || line.find('"') == std::string_view::npos) return;
  fields.clear();
  for (std::size_t start = 0;;) {
    std::size_t end = std::min(line.find(separator, start), line.size());
    const std::size_t open = std::min(line.find_first_not_of(" \t", start), line.size());
    if (open < end && line[open] == '"') end = std::max(end, end_of_quoted(line, open, separator));
    fields.push_back(line.substr(start, end - start));
    if (end == line.size()) break;
    start = end + 1;
  }
}

ColumnNames parse_column_names(std::string_view line) {
  ColumnNames result;
  line = without_mark(line);
  result.separator = line.find(';') != std::string_view::npos   ? ';'
                     : line.find(',') != std::string_view::npos ? ','
                                                                : ' ';
  std::vector<std::string_view> fields;
  split_quoted_fields(line, result.separator, fields);
  if (result.separator == ' ') join_units(line, fields);
  for (const std::string_view field : fields) {
    result.names.push_back(name_in(field));
    result.units.push_back(unit_in(field));
  }
  return result;
}

}  // namespace clearway
