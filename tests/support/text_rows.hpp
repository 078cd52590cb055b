#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::test {

/// The rows of a table that a raw string holds, one on each line, as cells between "|" without the
/// blanks around them. At least `cells` of them; a missing one is empty. "\n" in a cell is the end
/// of a line.
inline std::vector<std::vector<std::string>> text_rows(std::string_view table,
                                                       std::size_t cells = 4) {
  std::vector<std::vector<std::string>> rows;
  const auto part_before = [](std::string_view& text, char end) {
    const std::size_t at = text.find(end);
    const std::string_view part = text.substr(0, at);
    text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
    return part;
  };
  while (!table.empty()) {
    std::string_view line = part_before(table, '\n');
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    std::vector<std::string>& row = rows.emplace_back();
    while (!line.empty()) {
      std::string cell(part_before(line, '|'));
      cell.erase(0, cell.find_first_not_of(' '));
      cell.erase(cell.find_last_not_of(' ') + 1);
      for (std::size_t at = 0; (at = cell.find("\\n", at)) != std::string::npos; ++at) {
        cell.replace(at, 2, "\n");
      }
      row.push_back(cell);
    }
    row.resize(std::max(cells, row.size()));
  }
  return rows;
}

}  // namespace clearway::test
