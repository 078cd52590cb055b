#include "findings/ledger/ledger_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_lines.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr std::array<const char*, kLedgerColumns> kNames{
    "key",    "status", "owner",  "comment", "until", "x",    "y",          "z",
    "size_x", "size_y", "size_z", "side",    "least", "trim", "first_seen", "last_seen"};
constexpr std::string_view kMark = "\xEF\xBB\xBF";

std::string without_blanks(std::string text) {
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  const auto begin = std::ranges::find_if_not(text, is_blank);
  text.erase(text.begin(), begin);
  return text;
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// What a cell says: without its quotes, and without blanks around it.
std::string said_by(const std::string& raw) { return without_blanks(unquoted(raw)); }

/// The separator of a header: the one that it has most of.
char separator_of(std::string_view header) {
  char best = ',';
  for (const char one : {';', '\t'}) {
    if (std::ranges::count(header, one) > std::ranges::count(header, best)) best = one;
  }
  return best;
}

std::optional<LedgerStatus> status_of(const std::string& word) {
  for (const LedgerStatus status : {LedgerStatus::kNew, LedgerStatus::kOpen,
                                    LedgerStatus::kAccepted, LedgerStatus::kResolved}) {
    if (word == name_of(status)) return status;
  }
  return std::nullopt;
}

}  // namespace

const char* name_of(LedgerColumn column) { return kNames[static_cast<std::size_t>(column)]; }

LedgerTable::LedgerTable() {
  lines_.push_back({{kNames.begin(), kNames.end()}, line_end_});
  for (std::size_t i = 0; i < kLedgerColumns; ++i) place_[i] = i;
}

LedgerTable::LedgerTable(std::string text, std::string name) : name_(std::move(name)) {
  std::string_view rest = text;
  refuse_foreign(name_, rest);
  if (rest.starts_with("\xFF\xFE") || rest.starts_with("\xFE\xFF")) {
    throw InputError(name_ + ": is in UTF-16; save it as CSV in UTF-8");
  }
  has_mark_ = rest.starts_with(kMark);
  if (has_mark_) rest.remove_prefix(kMark.size());
  separator_ = separator_of(rest.substr(0, rest.find_first_of("\r\n")));
  parse(rest);
  find_columns();
  find_forms();
  check_rows();
}

/// Divides the text in lines and cells. A quoted cell may hold separators and line breaks.
void LedgerTable::parse(std::string_view text) {
  Line line;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      cell += "\"\"";  // a quote in the cell
      ++i;
      continue;
    }
    if (c == '"' && (quoted || without_blanks(cell).empty())) quoted = !quoted;
    const bool is_end = !quoted && is_line_end(c);
    if (!is_end && (quoted || c != separator_)) {
      cell += c;
      continue;
    }
    line.cells.push_back(std::exchange(cell, {}));
    if (!is_end) continue;
    line.end = text.substr(i, line_break_bytes(text.data() + i, text.data() + text.size()));
    i += line.end.size() - 1;
    lines_.push_back(std::exchange(line, {}));
  }
  if (quoted) throw InputError(name_ + ": a quote is not closed, so the file may be cut");
  if (!cell.empty() || !line.cells.empty()) {
    line.cells.push_back(std::move(cell));
    lines_.push_back(std::move(line));
  }
  if (lines_.empty()) throw InputError(name_ + ": is empty; expected the table of a ledger");
  if (!lines_.front().end.empty()) line_end_ = lines_.front().end;
}

void LedgerTable::find_columns() {
  const std::vector<std::string>& header = lines_.front().cells;
  for (std::size_t i = 0; i < kLedgerColumns; ++i) {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < header.size(); ++k) {
      if (in_small_letters(said_by(header[k])) == kNames[i]) places.push_back(k);
    }
    if (places.size() != 1) {
      throw InputError(
          name_ + ": line 1: " + (places.empty() ? "lacks the column " : "has twice the column ") +
          kNames[i] + ", which the table of a ledger has");
    }
    place_[i] = places.front();
  }
  for (std::size_t line = 1; line < lines_.size(); ++line) {
    const std::vector<std::string>& cells = lines_[line].cells;
    const auto is_empty = [](const std::string& cell) { return said_by(cell).empty(); };
    if (std::ranges::all_of(cells, is_empty)) continue;
    rows_.push_back(line);
    if (cells.size() <= header.size()) continue;
    if (std::all_of(cells.begin() + static_cast<std::ptrdiff_t>(header.size()), cells.end(),
                    is_empty)) {
      continue;
    }
    refuse_line(name_, line + 1,
                "has " + std::to_string(cells.size()) + " cells, and the header " +
                    std::to_string(header.size()));
  }
}

/// Finds out how the table writes days and numbers, so that new ones look the same.
void LedgerTable::find_forms() {
  bool is_known = false;
  for (std::size_t row = 0; row < rows(); ++row) {
    for (const LedgerColumn column :
         {LedgerColumn::kFirstSeen, LedgerColumn::kLastSeen, LedgerColumn::kUntil}) {
      const auto read = day_of(get(row, column));
      if (is_known || !read || !read->form) continue;
      form_ = *read->form;
      is_known = true;
    }
    for (const LedgerColumn column : {LedgerColumn::kX, LedgerColumn::kY, LedgerColumn::kZ}) {
      if (separator_ != ',' && get(row, column).find(',') != std::string::npos) {
        has_decimal_commas_ = true;
      }
    }
  }
}

void LedgerTable::check_rows() {
  std::set<std::string> keys;
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string key = get(row, LedgerColumn::kKey);
    if (!key.empty() && !keys.insert(key).second) {
      refuse(row, LedgerColumn::kKey, "another row has this key too");
    }
    const std::string word = in_small_letters(get(row, LedgerColumn::kStatus));
    if (!status_of(word)) {
      refuse(row, LedgerColumn::kStatus, "expected new, open, accepted or resolved");
    }
    day(row, LedgerColumn::kUntil);
  }
}

void LedgerTable::refuse(std::size_t row, LedgerColumn column, const std::string& why) const {
  refuse_line(name_, rows_[row] + 1,
              name_of(column) + (" " + excerpt(get(row, column))) + ": " + why);
}

const std::string* LedgerTable::raw(std::size_t row, LedgerColumn column) const {
  const std::vector<std::string>& cells = lines_[rows_[row]].cells;
  const std::size_t place = place_[static_cast<std::size_t>(column)];
  return place < cells.size() ? &cells[place] : nullptr;
}

std::string LedgerTable::get(std::size_t row, LedgerColumn column) const {
  const std::string* const cell = raw(row, column);
  return cell == nullptr ? std::string() : said_by(*cell);
}

LedgerStatus LedgerTable::status(std::size_t row) const {
  return *status_of(in_small_letters(get(row, LedgerColumn::kStatus)));
}

std::optional<double> LedgerTable::number(std::size_t row, LedgerColumn column) const {
  std::string text = get(row, column);
  if (text.empty()) return std::nullopt;
  if (separator_ != ',' && std::ranges::count(text, ',') == 1) {
    *std::ranges::find(text, ',') = '.';
  }
  const std::optional<double> read = parse_whole_number(text);
  if (!read || !std::isfinite(*read)) refuse(row, column, "expected a number");
  return read;
}

std::optional<Day> LedgerTable::day(std::size_t row, LedgerColumn column) const {
  const std::string text = get(row, column);
  if (text.empty()) return std::nullopt;
  const auto read = day_of(text);
  if (!read) refuse(row, column, "expected a day such as 2026-06-30");
  return read->day;
}

std::string LedgerTable::as_cell(const std::string& value) const {
  const bool needs_quotes = value.find_first_of("\"\r\n") != std::string::npos ||
                            value.find(separator_) != std::string::npos;
  if (!needs_quotes) return value;
  std::string out = "\"";
  for (const char c : value) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

void LedgerTable::set(std::size_t row, LedgerColumn column, const std::string& value) {
  if (get(row, column) == value) return;
  std::vector<std::string>& cells = lines_[rows_[row]].cells;
  const std::size_t place = place_[static_cast<std::size_t>(column)];
  if (cells.size() <= place) cells.resize(place + 1);
  cells[place] = as_cell(value);
}

void LedgerTable::set(std::size_t row, LedgerColumn column, std::optional<double> value,
                      int digits) {
  std::string text;
  if (value) {
    text = fmt::format("{:.{}f}", *value, digits);
    const std::optional<double> before = number(row, column);
    if (before && fmt::format("{:.{}f}", *before, digits) == text) return;
    if (has_decimal_commas_) std::ranges::replace(text, '.', ',');
  }
  set(row, column, text);
}

void LedgerTable::set(std::size_t row, LedgerColumn column, const Day& value) {
  if (day(row, column) == std::optional(value)) return;
  set(row, column, text_of(value, form_));
}

std::size_t LedgerTable::add_row() {
  std::uint64_t next = 1;
  for (std::size_t row = 0; row < rows(); ++row) {
    if (const auto number = parse_count(get(row, LedgerColumn::kKey))) {
      next = std::max(next, *number + 1);
    }
  }
  if (lines_.back().end.empty()) lines_.back().end = line_end_;
  Line line{std::vector<std::string>(lines_.front().cells.size()), line_end_};
  rows_.push_back(lines_.size());
  lines_.push_back(std::move(line));
  set(rows() - 1, LedgerColumn::kKey, std::to_string(next));
  return rows() - 1;
}

std::string LedgerTable::text() const {
  std::string out(has_mark_ ? kMark : std::string_view());
  for (const Line& line : lines_) {
    for (std::size_t i = 0; i < line.cells.size(); ++i) {
      if (i > 0) out += separator_;
      out += line.cells[i];
    }
    out += line.end;
  }
  return out;
}

}  // namespace clearway
