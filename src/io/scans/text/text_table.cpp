#include "io/scans/text/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/messages/messages.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/text/point_blocks.hpp"

namespace clearway {
namespace {

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
  const bool has_quotes = line.find('"') != std::string_view::npos;
  for (std::size_t start = 0;;) {
    std::size_t end = std::min(line.find(separator, start), line.size());
    if (has_quotes) {
      const std::size_t open = std::min(line.find_first_not_of(" \t", start), line.size());
      if (open < end && line[open] == '"')
        end = std::max(end, end_of_quoted(line, open, separator));
    }
    fields.push_back(line.substr(start, end - start));
    if (end == line.size()) break;
    start = end + 1;
  }
}

namespace {

constexpr std::string_view kEast[] = {"easting",    "east",  "e",       "utm_easting",
                                      "rechtswert", "utm_e", "utm_east"};
constexpr std::string_view kNorth[] = {"northing", "north", "n",        "utm_northing",
                                       "hochwert", "utm_n", "utm_north"};
constexpr std::string_view kHeight[] = {"height", "elevation", "altitude", "h",
                                        "elev",   "alt",       "hgt"};
/// Units besides those of length. No coordinates of a scan are read in them.
constexpr std::string_view kOthers[] = {"mil",     "um",     "deg", "°",      "degree",
                                        "degrees", "arcsec", "rad", "radian", "radians"};

bool is_one_of(std::string_view text, ColumnNames names) {
  return std::find(names.begin(), names.end(), text) != names.end();
}

std::string_view trimmed(std::string_view text, std::string_view marks = " \t\"'") {
  const std::size_t start = text.find_first_not_of(marks);
  if (start == std::string_view::npos) return {};
  return text.substr(start, text.find_last_not_of(marks) - start + 1);
}

/// Removes a comment mark and a label: "# columns: x y z" becomes "x y z".
std::string_view without_mark_and_label(std::string_view line) {
  line = trimmed(line, " \t");
  while (line.starts_with('#')) line.remove_prefix(1);
  if (line.starts_with("//")) line.remove_prefix(2);
  if (line.starts_with('%')) line.remove_prefix(1);
  const std::size_t colon = line.find(':');
  if (colon != std::string_view::npos && line.find_first_of(",;[(\"") > colon) {
    line.remove_prefix(colon + 1);
  }
  return line;
}

/// The text in brackets in a field such as "X [m]".
std::string bracketed_unit(std::string_view field) {
  const std::size_t open = field.find_first_of("[(");
  if (open == std::string_view::npos) return {};
  const char close = field[open] == '[' ? ']' : ')';
  const std::size_t end = field.rfind(close);
  const std::size_t stop = end == std::string_view::npos || end < open ? field.size() : end;
  return lower_case(trimmed(field.substr(open + 1, stop - open - 1)));
}

void add_name(TableHeader& header, std::string_view field) {
  std::string name = table_name(field);
  std::string unit = bracketed_unit(field);
  header.written.push_back(name);
  // The longest unit is taken: "x_us_ft" is a column x.
  std::size_t mark = unit.empty() ? name.find('_', 1) : std::string::npos;
  for (; mark != std::string::npos; mark = name.find('_', mark + 1)) {
    const std::string_view end = std::string_view(name).substr(mark + 1);
    if (find_unit(end) == nullptr && !is_one_of(end, kOthers)) continue;
    unit = end;
    name.resize(mark);
    break;
  }
  header.names.push_back(std::move(name));
  header.units.push_back(std::move(unit));
}

/// Whether there are names such as qx or q_rs_x for each of x, y, z and w.
bool has_quaternion(const TableHeader& header) {
  return std::all_of(std::begin("xyzw"), std::end("xyzw") - 1, [&](char part) {
    return std::any_of(header.names.begin(), header.names.end(), [&](const std::string& name) {
      return name.size() > 1 && name.starts_with('q') && name.ends_with(part);
    });
  });
}

}  // namespace

std::optional<std::size_t> TableHeader::find(ColumnNames prefixes, std::string_view suffix) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string_view name = names[i];
    if (!name.ends_with(suffix)) continue;
    name.remove_suffix(suffix.size());
    if (!is_one_of(name, prefixes)) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

bool TableHeader::has(ColumnNames any_of) const {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return is_one_of(name, any_of); });
}

std::string lower_case(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

std::string table_name(std::string_view field) {
  field = trimmed(field);
  field = field.substr(0, field.find_first_of("[(", 1));
  std::string name;
  for (const char c : lower_case(field)) {
    if (c != ' ' && c != '\t' && c != '"' && c != '\'') name += c;
  }
  return name;
}

TableHeader parse_table_header(std::string_view line, char separator) {
  TableHeader header;
  line = without_mark_and_label(line);
  header.separator = separator != 0                             ? separator
                     : line.find(';') != std::string_view::npos ? ';'
                     : line.find(',') != std::string_view::npos ? ','
                                                                : ' ';
  std::vector<std::string_view> fields;
  split_fields(line, header.separator, fields);
  for (const std::string_view field : fields) {
    // In "X [m] Y [m]", where blanks separate columns, the unit is a field of its own.
    if (header.separator == ' ' && !header.units.empty() && field.find_first_of("[(") == 0) {
      header.units.back() = bracketed_unit(field);
    } else {
      add_name(header, field);
    }
  }
  return header;
}

std::vector<std::string> other_columns(const TableHeader& header,
                                       std::span<const std::size_t> used) {
  std::vector<std::string> others;
  for (std::size_t i = 0; i < header.written.size(); ++i) {
    const bool is_used = std::ranges::find(used, i) != used.end();
    if (!is_used && !header.written[i].empty()) others.push_back(header.written[i]);
  }
  return others;
}

std::string unquoted(std::string_view field) {
  field = trimmed(field, " \t");
  if (field.size() < 2 || !field.starts_with('"') || !field.ends_with('"')) {
    return std::string(field);
  }
  std::string out;
  for (std::size_t i = 1; i + 1 < field.size(); ++i) {
    out += field[i];
    if (field[i] == '"' && i + 2 < field.size() && field[i + 1] == '"') ++i;
  }
  return out;
}

std::string objection_to_fields(std::string_view line, std::size_t found, std::size_t expected) {
  const std::string commas = decimal_commas_in(line);
  if (!commas.empty()) return excerpt(line) + commas + ", as in 0.25";
  if (std::ranges::count(line, '"') % 2 != 0) return excerpt(line) + ": a quote has no end";
  return counted(found, "column") + "; expected " + std::to_string(expected) + " as before";
}

std::string objection_to_number(std::string_view field, std::size_t column,
                                const std::string& expected) {
  const bool has_comma = field.find(',') != std::string_view::npos;
  return excerpt(field) + " in column " + std::to_string(column + 1) +
         (has_comma ? " has a decimal comma, which is not read; write a decimal point, as in 0.25"
                    : "; expected " + expected);
}

std::optional<PlanColumns> plan_columns(const TableHeader& header) {
  static constexpr std::string_view kZ[] = {"z"};
  auto x = header.find("x");
  auto y = header.find("y");
  if (!x && !y) {
    x = header.find(kEast);
    y = header.find(kNorth);
  }
  const ColumnNames heights = header.has(kZ) ? ColumnNames(kZ) : ColumnNames(kHeight);
  const auto z = header.find(heights);
  if (!x || !y || (!z && header.has(heights))) return std::nullopt;
  return PlanColumns{*x, *y, z};
}

std::optional<CoordinateColumns> coordinate_columns(const TableHeader& header) {
  const auto plan = plan_columns(header);
  if (!plan || !plan->z) return std::nullopt;
  return CoordinateColumns{plan->x, plan->y, *plan->z};
}

std::string other_table(const TableHeader& header) {
  if (has_quaternion(header)) return "a trajectory (columns of a quaternion)";
  const bool turns = header.has(kHeadingColumns) || header.has(kYawColumns);
  if (header.has(kRollColumns) && header.has(kPitchColumns) && turns) {
    return "a trajectory (columns roll, pitch and heading)";
  }
  if (header.has(kLatitudeColumns) && header.has(kLongitudeColumns) &&
      !coordinate_columns(header)) {
    return "latitudes and longitudes, which are angles and no lengths";
  }
  return {};
}

std::string take_units(const TableHeader& header, const CoordinateColumns& columns,
                       StatedCrs& out) {
  const NamedUnit* found = nullptr;
  double heights = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] >= header.units.size()) continue;
    const std::string& unit = header.units[columns[k]];
    const NamedUnit* const known = find_unit(unit);
    const bool read = known != nullptr && known->environment != LengthUnit::kUnknown;
    const bool of_heights = k == 2 && known != nullptr && found != nullptr;
    if (!read && !of_heights && (known != nullptr || is_one_of(unit, kOthers))) return unit;
    if (k == 2 && known != nullptr) heights = known->metres();
    if (!read || of_heights) continue;
    if (found != nullptr && found != known) {
      return std::string(found->symbol) + " and " + std::string(known->symbol) + " together";
    }
    found = known;
  }
  out.height_unit = heights;
  if (found == nullptr) return {};
  out.unit = found->environment;
  out.any_foot = found->any_foot;
  return {};
}

TextTable::TextTable(InputBuffer input, char separator)
    : input_(std::move(input)), separator_(separator) {
  input_.begin_text();
}

bool TextTable::next() {
  do {
    if (!input_.next_line(line_)) return false;
    line_ = without_leading_blanks(line_);
  } while (line_.empty());
  is_cut_ = !input_.line_terminated() && !is_comment() && line_.ends_with('.');
  return true;
}

bool TextTable::is_comment() const { return is_text_comment(line_); }

bool TextTable::starts_with_number() const {
  const char* at = line_.data();
  double value = 0;
  return parse_number(at, at + line_.size(), value);
}

void TextTable::remark_cut(std::vector<Message>& remarks) const {
  if (!is_cut_) return;
  remarks.push_back(warning(
      "cut-text", name() + ": the file ends without a line break within a number, so it may be cut",
      {{"line", input_.line()}}));
}

const TableHeader& TextTable::take_header() {
  header_ = parse_table_header(line_, separator_);
  return header_;
}

bool TextTable::is_header(ColumnNames names) {
  take_header();
  return std::ranges::equal(header_.written, names) &&
         std::ranges::all_of(header_.units, &std::string::empty);
}

std::optional<TextColumn> TextTable::find(std::span<const std::string> columns,
                                          ColumnNames names) const {
  std::optional<TextColumn> found;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!is_one_of(columns[i], names)) continue;
    if (found) refuse_here("the header names two columns for " + found->name + "; expected one");
    found = {std::string(names[0]), i, !header_.units[i].empty()};
  }
  return found;
}

std::optional<TextColumn> TextTable::column(ColumnNames names, const ColumnUnit& unit) const {
  auto found = find(header_.names, names);
  if (!found) return found;
  double metres = unit.unless_named;
  if (found->has_unit) {
    const std::string& text = header_.units[found->index];
    const auto named = file_unit_of(text);
    if (!named) {
      refuse_here("the header has the " + found->name + " in " + excerpt(text) + "; expected " +
                  file_unit_list());
    }
    metres = named->metres_in(unit.environment);
  }
  found->factor = UnitFactor(metres, unit.wanted);
  return found;
}

std::optional<TextColumn> TextTable::column(std::string_view name) const {
  auto found = find(header_.written, {&name, 1});
  if (found && found->has_unit) {
    refuse_here("the header has the " + found->name + " in " +
                excerpt(header_.units[found->index]) + "; expected no unit");
  }
  return found;
}

TextColumn TextTable::needed(std::string_view name, const char* otherwise) const {
  const auto found = column(name);
  if (!found) refuse_here("has no column " + std::string(name) + otherwise);
  return *found;
}

void TextTable::take_row(std::size_t most, const char* rows) {
  if (rows_++ == most) refuse_here("has more " + std::string(rows) + " than " + format_count(most));
  split_fields(line_, header_.separator, fields_);
  if (fields_.size() != header_.names.size()) {
    refuse_here(objection_to_fields(line_, fields_.size(), header_.names.size()));
  }
}

std::string TextTable::text(const TextColumn& column) const {
  const std::string_view field = trimmed(fields_[column.index], " \t");
  if (field.starts_with('"') && (field.size() < 2 || !field.ends_with('"'))) {
    refuse_here(excerpt(field) + ": a quote has no end");
  }
  return unquoted(field);
}

double TextTable::number(const TextColumn& column) const {
  const std::string_view field = fields_[column.index];
  const auto value = parse_whole_number(field);
  if (!value || !std::isfinite(*value)) {
    refuse_here(objection_to_number(field, column.index, "a finite number as " + column.name));
  }
  return column.factor(*value);
}

}  // namespace clearway
