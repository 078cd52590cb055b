#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/report.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/input_buffer.hpp"

namespace clearway {
namespace {

constexpr std::size_t kMostObstacles = 1'000'000;

/// The fields of a line of CSV (RFC 4180, but no field has a line break).
std::vector<std::string> fields_of_line(const InputBuffer& input, std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (i + 1 < line.size() && line[i + 1] == '"') {
        fields.back() += line[++i];
      } else {
        quoted = false;
      }
    } else if (c == '"' && fields.back().empty()) {
      quoted = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  if (quoted) refuse_line(input.name(), input.line(), "a quote has no end");
  return fields;
}

/// Where the columns are that are read.
struct Columns {
  std::size_t id = 0, corners[6] = {}, count = 0;
  std::optional<std::size_t> name = {};
};

Columns columns_of(const InputBuffer& input, std::string_view line) {
  const std::vector<std::string> names = fields_of_line(input, line);
  const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) return std::nullopt;
    return static_cast<std::size_t>(at - names.begin());
  };
  const auto need = [&](std::string_view name) {
    if (const auto at = find(name)) return *at;
    refuse_line(input.name(), input.line(),
                "has no column " + std::string(name) +
                    "; expected the CSV file that clearway conflicts writes");
  };
  Columns columns;
  columns.count = names.size();
  columns.id = need("id");
  constexpr std::string_view kCorners[] = {"lo_x", "lo_y", "lo_z", "hi_x", "hi_y", "hi_z"};
  for (std::size_t i = 0; i < 6; ++i) columns.corners[i] = need(kCorners[i]);
  columns.name = find("name");
  return columns;
}

NamedObstacle obstacle_of(const InputBuffer& input, std::string_view line, const Columns& columns) {
  const std::vector<std::string> fields = fields_of_line(input, line);
  if (fields.size() != columns.count) {
    refuse_line(input.name(), input.line(),
                "has " + std::to_string(fields.size()) + " fields; expected " +
                    std::to_string(columns.count));
  }
  NamedObstacle out;
  for (int i = 0; i < 6; ++i) {
    const std::string& field = fields[columns.corners[i]];
    const auto value = parse_whole_number(field);
    if (!value || !std::isfinite(*value)) {
      refuse_line(input.name(), input.line(), excerpt(field) + "; expected a finite coordinate");
    }
    (i < 3 ? out.box.lo : out.box.hi)[i % 3] = *value;
  }
  for (int k = 0; k < 3; ++k) {
    if (out.box.lo[k] <= out.box.hi[k]) continue;
    refuse_line(input.name(), input.line(), "its box ends before it begins");
  }
  if (columns.name) out.name = fields[*columns.name];
  if (out.name.empty()) out.name = "conflict " + fields[columns.id];
  return out;
}

}  // namespace

std::vector<NamedObstacle> read_obstacles(const std::filesystem::path& path) {
  InputBuffer input(File::open_regular(path), InputBuffer::Access::kSeek);
  input.begin_text();
  std::vector<NamedObstacle> out;
  std::string_view line;
  std::optional<Columns> columns;
  while (input.next_line(line)) {
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (!columns) {
      columns = columns_of(input, line);
      continue;
    }
    if (out.size() == kMostObstacles) {
      refuse_line(input.name(), input.line(), "has more than a million conflicts");
    }
    out.push_back(obstacle_of(input, line, *columns));
  }
  if (!columns) refuse(input.name(), "is empty; expected the CSV file of clearway conflicts");
  return out;
}

}  // namespace clearway
