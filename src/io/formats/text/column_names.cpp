#include "io/formats/text/column_names.hpp"

#include <algorithm>

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

/// "  \"p_x [m]\"" becomes "p_x".
std::string name_in(std::string_view field) {
  const std::size_t unit = field.find_first_of("[(", 1);
  field = field.substr(0, unit);
  std::string name;
  for (const char c : field) {
    if (c == ' ' || c == '\t' || c == '"' || c == '\'') continue;
    name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return name;
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

ColumnNames parse_column_names(std::string_view line) {
  ColumnNames result;
  line = without_mark(line);
  result.separator = line.find(';') != std::string_view::npos   ? ';'
                     : line.find(',') != std::string_view::npos ? ','
                                                                : ' ';
  std::vector<std::string_view> fields;
  split_fields(line, result.separator, fields);
  for (const std::string_view field : fields) result.names.push_back(name_in(field));
  return result;
}

}  // namespace clearway
