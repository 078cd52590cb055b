#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr const char* kExpected =
    "; expected the columns chainage_from,chainage_to,outline,margin or "
    "station_from,station_to,outline,margin";

class TableOfOutlines {
 public:
  TableOfOutlines(const std::filesystem::path& path, const OutlineOptions& options,
                  std::vector<Message>* messages)
      : file_(InputBuffer::open_regular(path)), options_(options), messages_(messages) {
    table_.path = path;
  }

  OutlineTable read() {
    while (file_.next()) {
      if (file_.is_comment()) continue;
      outline_ ? add() : take_header();
    }
    if (table_.rows.empty()) {
      refuse(file_.name(),
             std::string("holds no row with an outline") + (outline_ ? "" : kExpected));
    }
    check_order();
    return std::move(table_);
  }

 private:
  void take_header() {
    file_.take_header();
    const double unit = options_.environment_unit;
    const ColumnUnit lengths{unit, unit, unit}, stations{unit, unit, 1};
    const auto chainage_from = file_.column("chainage_from", lengths);
    const auto chainage_to = file_.column("chainage_to", lengths);
    const auto station_from = file_.column("station_from", stations);
    const auto station_to = file_.column("station_to", stations);
    const bool by_chainage = chainage_from || chainage_to, by_station = station_from || station_to;
    if (by_chainage && by_station) {
      file_.refuse_here("gives stretches by chainage and by station; expected one of them");
    }
    table_.by_station = by_station;
    const auto& from = by_station ? station_from : chainage_from;
    const auto& to = by_station ? station_to : chainage_to;
    outline_ = file_.column("outline", lengths);
    if (!from || !to || !outline_) file_.refuse_here(excerpt(file_.line()) + kExpected);
    from_ = *from;
    to_ = *to;
    margin_ = file_.column("margin", lengths);
  }

  void add() {
    file_.take_row(kMostOutlineRows, "rows");
    OutlineRow row{
        .line = file_.input().line(), .from = file_.number(from_), .to = file_.number(to_)};
    if (!(row.from < row.to)) {
      file_.refuse_here("the stretch from " + format_brief(row.from) + " to " +
                        format_brief(row.to) + " ends before it begins; expected a greater end");
    }
    if (margin_ && !file_.text(*margin_).empty()) {
      row.margin = file_.number(*margin_);
      if (*row.margin < 0) file_.refuse_here("a margin below 0; expected 0 or more");
    }
    const std::string name = file_.text(*outline_);
    if (name.empty()) file_.refuse_here("names no outline; expected a file");
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
      file_.refuse_here(error.what());
    } catch (const ResourceError& error) {
      throw ResourceError(file_.name() + ": line " + std::to_string(file_.input().line()) + ": " +
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
      refuse_line(file_.name(), second,
                  "overlaps line {} from {} to {}; expected stretches that do not overlap", first,
                  format_brief(after.from), format_brief(std::min(before.to, after.to)));
    }
  }

  TextTable file_;
  const OutlineOptions& options_;
  std::vector<Message>* messages_;
  OutlineTable table_;
  TextColumn from_, to_;
  std::optional<TextColumn> outline_, margin_;                 ///< no outline: before the header
  std::map<std::string, std::vector<OutlinePoint>> outlines_;  ///< by the names in the table
};

}  // namespace

OutlineTable read_outline_table(const std::filesystem::path& path, const OutlineOptions& options,
                                std::vector<Message>* messages) {
  return TableOfOutlines(path, options, messages).read();
}

}  // namespace clearway
