#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/table_header.hpp"

namespace clearway {
namespace {

constexpr const char* kExpected =
    "; expected the columns chainage_from,chainage_to,outline,margin or "
    "station_from,station_to,outline,margin";

/// A column, and how its numbers are converted.
struct Column {
  std::size_t index = 0;
  UnitFactor factor{1};
};

/// A field without the blanks and quotes around it; two quotes in a quoted field stand for one.
std::string text_of(std::string_view field) {
  const auto is_space = [](char c) { return is_blank(c) || c == '\r'; };
  while (!field.empty() && is_space(field.front())) field.remove_prefix(1);
  while (!field.empty() && is_space(field.back())) field.remove_suffix(1);
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return std::string(field);
  std::string out;
  for (std::size_t i = 1; i + 1 < field.size(); ++i) {
    out += field[i];
    if (field[i] == '"' && i + 2 < field.size() && field[i + 1] == '"') ++i;
  }
  return out;
}

class TableOfOutlines {
 public:
  TableOfOutlines(const std::filesystem::path& path, const OutlineOptions& options,
                  std::vector<Message>* messages)
      : input_(File::open_regular(path), InputBuffer::Access::kSeek),
        options_(options),
        messages_(messages) {
    table_.path = path;
  }

  OutlineTable read() {
    input_.begin_text();
    std::string_view line;
    bool has_header = false;
    while (next_data_line(input_, line)) {
      if (!std::exchange(has_header, true)) {
        take_header(line);
      } else {
        add(line);
      }
    }
    if (table_.rows.empty())
      refuse(input_.name(), "holds no row with an outline" + after_nothing());
    check_order();
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse_here(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  std::string after_nothing() const { return fields_in_header_ == 0 ? kExpected : ""; }

  /// The column of this name; none where there is none. environment: the unit of its numbers is
  /// that of the environment, otherwise metres.
  std::optional<Column> column(const TableHeader& header, std::string_view name,
                               bool in_environment) {
    std::optional<Column> found;
    for (std::size_t i = 0; i < header.names.size(); ++i) {
      if (header.names[i] != name) continue;
      if (found) refuse_here("names the column " + std::string(name) + " twice");
      found = Column{.index = i};
      double metres = options_.environment_unit;
      if (!header.units[i].empty()) {
        const auto unit = file_unit_of(header.units[i]);
        if (!unit) {
          refuse_here("has the column " + std::string(name) + " in " + excerpt(header.units[i]) +
                      "; expected " + file_unit_list());
        }
        metres = unit->metres_in(options_.environment_unit);
      }
      found->factor = UnitFactor(metres, in_environment ? options_.environment_unit : 1);
    }
    return found;
  }

  void take_header(std::string_view line) {
    const TableHeader header = parse_table_header(line);
    separator_ = header.separator;
    fields_in_header_ = header.names.size();
    const auto chainage_from = column(header, "chainage_from", true);
    const auto chainage_to = column(header, "chainage_to", true);
    const auto station_from = column(header, "station_from", false);
    const auto station_to = column(header, "station_to", false);
    const auto outline = column(header, "outline", true);
    const bool by_chainage = chainage_from || chainage_to, by_station = station_from || station_to;
    if (by_chainage && by_station) {
      refuse_here("gives stretches by chainage and by station; expected one of them");
    }
    table_.by_station = by_station;
    const auto& from = by_station ? station_from : chainage_from;
    const auto& to = by_station ? station_to : chainage_to;
    if (!from || !to || !outline) refuse_here(excerpt(line) + kExpected);
    from_ = *from;
    to_ = *to;
    outline_ = outline->index;
    margin_ = column(header, "margin", true);
  }

  double number(const Column& column, const char* name, std::string_view line) const {
    const std::string field = text_of(fields_[column.index]);
    const auto value = parse_whole_number(field);
    if (!value || !std::isfinite(*value)) {
      refuse_here(excerpt(field) + decimal_commas_in(line) + "; expected a finite number as " +
                  name);
    }
    return column.factor(*value);
  }

  void add(std::string_view line) {
    split_quoted_fields(line, separator_, fields_);
    if (fields_.size() != fields_in_header_) {
      refuse_here("has " + counted(fields_.size(), "field") + decimal_commas_in(line) +
                  "; expected " + std::to_string(fields_in_header_));
    }
    if (table_.rows.size() == kMostOutlineRows) {
      refuse_here("has more rows than " + format_count(kMostOutlineRows));
    }
    OutlineRow row{.line = input_.line()};
    row.from = number(from_, table_.by_station ? "station_from" : "chainage_from", line);
    row.to = number(to_, table_.by_station ? "station_to" : "chainage_to", line);
    if (!(row.from < row.to)) {
      refuse_here("the stretch from " + format_brief(row.from) + " to " + format_brief(row.to) +
                  " ends before it begins; expected a greater end");
    }
    if (margin_ && !text_of(fields_[margin_->index]).empty()) {
      row.margin = number(*margin_, "margin", line);
      if (*row.margin < 0) refuse_here("a margin below 0; expected 0 or more");
    }
    const std::string name = text_of(fields_[outline_]);
    if (name.empty()) refuse_here("names no outline; expected a file");
    row.file = name;
    row.outline = outline_in(name);
    table_.rows.push_back(std::move(row));
  }

  /// The outline in a file, which is read once.
  const std::vector<OutlinePoint>& outline_in(const std::string& name) {
    const auto [at, is_new] = outlines_.try_emplace(name);
    if (!is_new) return at->second;
    try {
      at->second = read_outline(table_.path.parent_path() / name, options_, messages_);
    } catch (const InputError& error) {
      refuse_here(error.what());
    } catch (const ResourceError& error) {
      throw ResourceError(input_.name() + ": line " + std::to_string(input_.line()) + ": " +
                          error.what());
    }
    return at->second;
  }

  /// Sorts the rows, and refuses those that overlap.
  void check_order() {
    std::ranges::stable_sort(table_.rows, {}, &OutlineRow::from);
    for (std::size_t i = 0; i + 1 < table_.rows.size(); ++i) {
      const OutlineRow &before = table_.rows[i], &after = table_.rows[i + 1];
      if (before.to <= after.from) continue;
      const auto& [first, second] = std::minmax(before.line, after.line);
      refuse_line(input_.name(), second,
                  "overlaps line " + std::to_string(first) + " from " + format_brief(after.from) +
                      " to " + format_brief(std::min(before.to, after.to)) +
                      "; expected stretches that do not overlap");
    }
  }

  InputBuffer input_;
  const OutlineOptions& options_;
  std::vector<Message>* messages_;
  OutlineTable table_;
  char separator_ = ',';
  std::size_t fields_in_header_ = 0, outline_ = 0;
  Column from_, to_;
  std::optional<Column> margin_;
  std::vector<std::string_view> fields_;
  std::map<std::string, std::vector<OutlinePoint>> outlines_;  ///< by the names in the table
};

}  // namespace

OutlineTable read_outline_table(const std::filesystem::path& path, const OutlineOptions& options,
                                std::vector<Message>* messages) {
  return TableOfOutlines(path, options, messages).read();
}

}  // namespace clearway
