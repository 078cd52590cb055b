#include "io/scans/text/xyz_prologue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/messages/messages.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/text/table_header.hpp"

namespace clearway {
namespace {

/// Recognises from the first lines of a text file without column names that it holds something
/// other than points (docs/design/conversion.md, "Text that is no table of points"). A resemblance
/// must hold on every line examined, so that points pass.
class LookAlike {
 public:
  static constexpr std::size_t kMostLines = 100;

  /// Takes the next line of data, which has no leading blanks.
  void add(std::string_view line);

  /// What a text holds that is no table of points.
  struct Verdict {
    std::string what;  ///< for a message; empty for points
    /// The column in which x is likely to be, counted from 1.
    std::size_t first_column = 2;
  };
  Verdict verdict() const;

 private:
  static constexpr std::size_t kMostNumbers = 20;
  static constexpr std::size_t kMostForms = 5;  ///< numbers of a line whose form is noted

  struct Row {
    std::array<double, kMostNumbers> numbers{};
    std::size_t count = 0;  ///< how many numbers the line starts with
    bool whole = false;     ///< whether the line consists of these numbers alone
    /// Whether each of the first numbers is written as a whole number such as 0, 1 or 2.
    std::array<bool, kMostForms> counting{};
    /// Digits of each of the first numbers after its decimal point.
    std::array<std::size_t, kMostForms> decimals{};
  };

  std::size_t fewest_numbers() const;
  std::size_t most_decimals(std::size_t column) const;
  /// How many numbers every line has; 0 where lines differ or hold anything else.
  std::size_t same_numbers() const;
  template <typename Holds>
  bool all_rows(Holds holds) const;
  bool ascending() const;
  bool matrices(std::size_t first) const;
  bool times_and_quaternions() const;
  bool positions_and_quaternions() const;
  bool index_first() const;
  bool time_first() const;
  bool evenly_spaced(std::size_t column) const;
  bool normals_fourth() const;
  bool varies(std::size_t column) const;
  bool all_counting(std::size_t column) const;
  bool grid_first(std::size_t slow, std::size_t fast) const;

  std::vector<Row> rows_;
};

// Deviation of a norm from 1, as for the poses of a trajectory.
constexpr double kUnitTolerance = 0.01;
constexpr double kFarthestMetres = 1e8;    // greater than any coordinate on Earth
constexpr double kHighestMetres = 2e4;     // greater than any height on Earth
constexpr std::size_t kFewestIndices = 3;  // lines
constexpr std::size_t kFewestTimes = 10;   // lines

bool is_unit(std::span<const double> numbers) {
  double square = 0;
  for (const double n : numbers) square += n * n;
  return std::abs(std::sqrt(square) - 1) <= kUnitTolerance;
}

/// Whether the numbers, in three rows of four or more, begin each row with a row of a rotation.
bool is_rotation(std::span<const double> numbers) {
  const auto at = [&](std::size_t row, std::size_t column) { return numbers[row * 4 + column]; };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double dot = 0;
      for (std::size_t k = 0; k < 3; ++k) dot += at(i, k) * at(j, k);
      if (!(std::abs(dot - (i == j ? 1 : 0)) <= kUnitTolerance)) return false;
    }
  }
  return true;
}

/// Whether a number is written with digits alone, without point, sign and exponent.
bool is_counting(const char* begin, const char* end) {
  return begin != end && std::all_of(begin, end, [](char c) { return c >= '0' && c <= '9'; });
}

/// The digits of a number after its decimal point.
std::size_t decimals_of(const char* begin, const char* end) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const char* const point = std::find(begin, end, '.');
  if (point == end) return 0;
  return static_cast<std::size_t>(std::find_if_not(point + 1, end, is_digit) - (point + 1));
}

void LookAlike::add(std::string_view line) {
  Row row;
  const char* at = line.data();
  const char* const end = at + line.size();
  while (row.count < kMostNumbers) {
    const char* const start = at;
    if (!parse_number(at, end, row.numbers[row.count])) break;
    if (row.count < kMostForms) {
      const bool quoted = *start == '"';
      row.counting[row.count] = is_counting(start + quoted, at - quoted);
      row.decimals[row.count] = decimals_of(start, at);
    }
    ++row.count;
    if (at == end || skip_separator(at, end) == 0) break;
  }
  row.whole = at == end;
  rows_.push_back(row);
}

std::size_t LookAlike::fewest_numbers() const {
  std::size_t fewest = kMostNumbers;
  for (const Row& row : rows_) fewest = std::min(fewest, row.count);
  return rows_.empty() ? 0 : fewest;
}

std::size_t LookAlike::same_numbers() const {
  const auto like_first = [this](const Row& row) {
    return row.whole && row.count == rows_[0].count;
  };
  return !rows_.empty() && all_rows(like_first) ? rows_[0].count : 0;
}

template <typename Holds>
bool LookAlike::all_rows(Holds holds) const {
  return std::all_of(rows_.begin(), rows_.end(), holds);
}

bool LookAlike::ascending() const {
  return std::adjacent_find(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
           return !(a.numbers[0] < b.numbers[0]);
         }) == rows_.end();
}

bool LookAlike::matrices(std::size_t first) const {
  return all_rows(
      [=](const Row& row) { return is_rotation(std::span(row.numbers).subspan(first)); });
}

bool LookAlike::times_and_quaternions() const {
  return rows_.size() > 1 && ascending() &&
         all_rows([](const Row& row) { return is_unit(std::span(row.numbers).subspan(4, 4)); });
}

/// Whether the rows are positions and quaternions. Two layouts of scans that look alike are
/// excluded: a normal with a curvature of 0, and an intensity of 0 with a normal.
bool LookAlike::positions_and_quaternions() const {
  const auto unit = [this](std::size_t first, std::size_t count) {
    return all_rows(
        [=](const Row& row) { return is_unit(std::span(row.numbers).subspan(first, count)); });
  };
  return unit(3, 4) && !unit(3, 3) && !unit(4, 3);
}

/// Whether the first column is an index. A regular grid of points is excluded, whose second column
/// stays the same or counts too.
bool LookAlike::index_first() const {
  if (rows_.size() < kFewestIndices || fewest_numbers() < 4) return false;
  const auto counts = [this](std::size_t column, double step) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double expected = rows_[0].numbers[column] + step * static_cast<double>(i);
      if (!rows_[i].counting[column] || rows_[i].numbers[column] != expected) return false;
    }
    return true;
  };
  return counts(0, 1) && !counts(1, 0) && !counts(1, 1);
}

std::size_t LookAlike::most_decimals(std::size_t column) const {
  std::size_t most = 0;
  for (const Row& row : rows_) most = std::max(most, row.decimals[column]);
  return most;
}

/// Whether the numbers of a column ascend or descend by equal steps, as far as their digits say.
bool LookAlike::evenly_spaced(std::size_t column) const {
  const double first = rows_[0].numbers[column], last = rows_.back().numbers[column];
  const double step = (last - first) / static_cast<double>(rows_.size() - 1);
  const double digit = std::pow(10.0, -static_cast<double>(most_decimals(column)));
  if (!(std::abs(step) > 0)) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double even = first + step * static_cast<double>(i);
    if (!(std::abs(rows_[i].numbers[column] - even) <= 1.01 * digit)) return false;
  }
  return true;
}

bool LookAlike::varies(std::size_t column) const {
  return !all_rows([&](const Row& row) { return row.numbers[column] == rows_[0].numbers[column]; });
}

bool LookAlike::all_counting(std::size_t column) const {
  return all_rows([=](const Row& row) { return row.counting[column]; });
}

/// Whether the fourth to sixth column are a normal, as behind the coordinates of points.
bool LookAlike::normals_fourth() const {
  return fewest_numbers() >= 6 &&
         all_rows([](const Row& row) { return is_unit(std::span(row.numbers).subspan(3, 3)); });
}

/// Whether the first column is a time and the next three are coordinates. Points may be sorted by
/// x, so other signs are needed: docs/design/conversion.md, "Signs of a time".
bool LookAlike::time_first() const {
  if (rows_.size() < kFewestTimes || fewest_numbers() < 4 || !varies(0)) return false;
  const bool never_back =
      std::is_sorted(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.numbers[0] < b.numbers[0]; });
  const auto within = [this](std::size_t column, double limit) {
    return all_rows([=](const Row& row) { return std::abs(row.numbers[column]) < limit; });
  };
  if (!never_back || !within(1, kFarthestMetres) || !within(2, kFarthestMetres) ||
      !within(3, kFarthestMetres)) {
    return false;
  }
  if (all_rows([](const Row& row) { return row.numbers[0] > kFarthestMetres; })) return true;
  const auto [fewest, most] = std::minmax({most_decimals(1), most_decimals(2), most_decimals(3)});
  if (fewest == 0 || normals_fourth() || !varies(1) || !varies(3)) return false;
  if (most_decimals(0) > most || all_counting(0)) return true;
  const bool no_height = within(3, kHighestMetres) && all_rows([](const Row& row) {
                           return std::abs(row.numbers[2]) > kHighestMetres;
                         });
  return no_height || (fewest == most && evenly_spaced(0) && !evenly_spaced(1));
}

/// Whether two columns are the row and the column of a grid, of which one runs through while the
/// other stays, and the next three are coordinates. slow, fast: 0 and 1 in either order.
bool LookAlike::grid_first(std::size_t slow, std::size_t fast) const {
  if (rows_.size() < kFewestIndices || fewest_numbers() < 5) return false;
  if (!all_counting(0) || !all_counting(1)) return false;
  for (std::size_t column = 2; column < 5; ++column) {
    if (most_decimals(column) == 0) return false;
  }
  const auto goes_on = [=](const Row& a, const Row& b) {
    const double lines = b.numbers[slow] - a.numbers[slow];
    const double places = b.numbers[fast] - a.numbers[fast];
    return lines == 0 ? places > 0 : lines > 0 && places < 0;
  };
  return !normals_fourth() &&
         std::adjacent_find(rows_.begin(), rows_.end(), std::not_fn(goes_on)) == rows_.end();
}

LookAlike::Verdict LookAlike::verdict() const {
  const std::size_t n = same_numbers();
  // A number may precede or follow each matrix: its index, or its quality.
  for (const std::size_t numbers : {12u, 16u}) {
    if ((n == numbers && matrices(0)) || (n == numbers + 1 && (matrices(0) || matrices(1)))) {
      return {"a trajectory (" + std::to_string(n) + " numbers a line, a rigid " +
              (numbers == 12 ? "3 x 4" : "4 x 4") + " matrix)"};
    }
  }
  if (n >= 8 && times_and_quaternions()) {
    return {"a trajectory (" + std::to_string(n) + " numbers a line: time, position, quaternion)"};
  }
  if (n == 7 && positions_and_quaternions()) {
    return {"a trajectory (7 numbers a line: position, quaternion)", 1};
  }
  if (grid_first(0, 1) || grid_first(1, 0)) {
    return {"a table whose first two columns are the row and the column of a grid", 3};
  }
  if (index_first()) return {"a table whose first column is the point's number"};
  if (time_first()) return {"a table whose first column is a time"};
  return {};
}

constexpr std::size_t kMostCommentHeaders = 16;

class PrologueReader {
 public:
  PrologueReader(InputBuffer& input, const PointReadOptions& options)
      : input_(input), options_(options) {}

  XyzPrologue read() {
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected points, one a line");
    input_.begin_text();
    std::string_view line;
    for (;;) {
      const InputBuffer::Mark start = input_.mark();
      if (!input_.next_line(line)) return std::move(out_);
      line = without_leading_blanks(line);
      if (is_text_comment(line)) {
        note_comment(line);
      } else if (!header_ && !out_.declared_points && count_in(line)) {
        read_count(line);
      } else if (!header_ && !is_point(line)) {
        read_header(line);
      } else {
        fields_ = count_fields(line);
        if (header_) {
          settle_separator(line);
        } else {
          choose_columns(line);
        }
        if (!all_named_) refuse_look_alike(line);
        input_.return_to(start);
        return std::move(out_);
      }
    }
  }

 private:
  struct Comment {
    TableHeader header;
    std::uint64_t line;
  };

  [[noreturn]] void fail(const std::string& what, bool advise = true) const {
    refuse_line(input_.name(), input_.line(), what,
                advise && options_.may_choose ? Remedy::kColumns : Remedy::kNone);
  }

  void note_comment(std::string_view line) {
    if (line.empty()) return;
    comments_.insert(comments_.begin(), {parse_table_header(line), input_.line()});
    if (comments_.size() > kMostCommentHeaders) comments_.pop_back();
  }

  void read_count(std::string_view line) {
    if (!input_.line_terminated()) {
      fail("expected a line break behind the number of points", false);
    }
    out_.declared_points = count_in(line);
    out_.count_line = input_.line();
  }

  /// Whether a first line is data, judged by the columns as far as they are known.
  bool is_point(std::string_view line) {
    Vec3 point{};
    if (!options_.columns.empty()) {
      const auto columns = chosen_columns(nullptr);
      if (columns && PointLine(*columns, separator_of(line)).parse(line, point)) return true;
    }
    for (const auto& [header, number] : comments_) {
      const auto columns = coordinate_columns(header);
      if (columns && header.names.size() == count_fields(line) &&
          PointLine(*columns, separator_of(line)).parse(line, point)) {
        return true;
      }
    }
    return PointLine().parse(line, point);
  }

  /// The columns that the caller chose; nullopt for names where `header` is null or lacks one.
  std::optional<CoordinateColumns> chosen_columns(const TableHeader* header) const {
    CoordinateColumns columns{};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::string& wanted = options_.columns[k];
      if (const auto number = count_in(wanted)) {
        if (*number < 1 || *number > InputBuffer::kLongestLine) return std::nullopt;
        columns[k] = *number - 1;
        continue;
      }
      const auto found = header ? header->find(table_name(wanted)) : std::nullopt;
      if (!found) return std::nullopt;
      columns[k] = *found;
    }
    return columns;
  }

  std::string wanted_columns() const {
    return options_.columns[0] + ", " + options_.columns[1] + ", " + options_.columns[2];
  }

  /// Reads a first line that is not a point: the header that names the columns, or something to
  /// refuse.
  void read_header(std::string_view line) {
    TableHeader header = parse_table_header(line);
    std::optional<CoordinateColumns> columns;
    if (!options_.columns.empty()) {
      columns = chosen_columns(&header);
      if (columns && has_number(line, header.separator, *columns)) {
        fail(excerpt(line) + "; expected numbers in the columns " + wanted_columns(), false);
      }
      if (!columns) {
        fail(excerpt(line) + " does not name each of the columns " + wanted_columns() + " once",
             false);
      }
    } else {
      const std::string other = other_table(header);
      if (!other.empty()) fail("looks like " + other + "; expected points with columns x, y and z");
      columns = coordinate_columns(header);
    }
    if (!columns) {
      fail(excerpt(line) + decimal_commas_in(line) +
           "; expected the coordinates x y z, the number of points, or a header with one column "
           "each named x, y and z, or easting, northing and height");
    }
    use(header, *columns, header.separator);
    header_ = std::move(header);
  }

  /// Whether one of the columns holds a number, in which case the line is a damaged point and no
  /// header.
  static bool has_number(std::string_view line, char separator, const CoordinateColumns& columns) {
    std::vector<std::string_view> fields;
    split_quoted_fields(line, separator, fields);
    return std::any_of(columns.begin(), columns.end(), [&](std::size_t column) {
      return column < fields.size() && parse_whole_number(fields[column]);
    });
  }

  /// Finds the separator of the lines after a header, which may differ from the one between its
  /// names.
  void settle_separator(std::string_view line) {
    Vec3 point{};
    PointLine other(out_.line.columns(), separator_of(line));
    if (!out_.line.parse(line, point) && other.parse(line, point)) out_.line = std::move(other);
    all_named_ = all_named_ || header_->names.size() == fields_;
  }

  /// Chooses the columns at the first line of data, from the comments or as the caller said.
  void choose_columns(std::string_view line) {
    const char separator = separator_of(line);
    if (!options_.columns.empty()) return use_chosen(separator);
    for (const Comment& comment : comments_) {
      const TableHeader& header = comment.header;
      if (header.names.size() == fields_) {
        const std::string other = other_table(header);
        if (!other.empty()) {
          fail("looks like " + other + ", by the comment in line " + std::to_string(comment.line) +
               "; expected points with columns x, y and z");
        }
      }
      const auto columns = coordinate_columns(header);
      if (!columns) continue;
      if (fits(header, *columns)) {
        all_named_ = header.names.size() == fields_;
        return use(header, *columns, separator);
      }
      const bool one_way = fields_ == 3 && std::is_sorted(columns->begin(), columns->end());
      if (*columns != kFirstThree && !one_way) warn_of_misfit(comment);
    }
  }

  void use_chosen(char separator) {
    auto columns = chosen_columns(nullptr);
    const TableHeader* named_by = nullptr;
    for (const auto& [header, number] : comments_) {
      const auto by_names = chosen_columns(&header);
      if (!by_names || header.names.size() != fields_) continue;
      columns = by_names;
      named_by = &header;
      break;
    }
    if (!columns) fail("no header names each of the columns " + wanted_columns() + " once", false);
    use(named_by ? *named_by : TableHeader{}, *columns, separator);
  }

  /// Whether the names fit the lines: there are as many, or fewer that start with x, y and z.
  bool fits(const TableHeader& header, const CoordinateColumns& columns) const {
    if (header.names.size() == fields_) return true;
    return header.names.size() < fields_ && *std::max_element(columns.begin(), columns.end()) == 2;
  }

  void use(const TableHeader& header, const CoordinateColumns& columns, char separator) {
    const TableUnit unit = unit_of(header, columns);
    if (!unit.refused.empty()) {
      const std::string what = "the coordinates are in " + unit.refused + " by the header";
      if (options_.columns.empty()) fail(what + "; expected metres: convert them first", false);
      warn("other-unit", what + ", and are read as metres as they are");
    }
    out_.line = PointLine(columns, separator);
    out_.unit = unit.unit;
    out_.any_foot = unit.any_foot;
    out_.height_unit = unit.heights;
    all_named_ = all_named_ || !options_.columns.empty();
  }

  void warn(WarningCode code, const std::string& what) {
    out_.remarks.push_back(warning(code, input_.name() + ": " + what));
  }

  void warn_of_misfit(const Comment& comment) {
    warn("column-names", "the comment in line " + std::to_string(comment.line) + " names " +
                             std::to_string(comment.header.names.size()) +
                             " columns, but the points have " + std::to_string(fields_) +
                             "; the first three are read as x, y and z");
  }

  /// Throws InputError where the text looks like something other than points. line: the first line
  /// of data, which was already read.
  void refuse_look_alike(std::string_view line) {
    const std::uint64_t number = input_.line();
    LookAlike look_alike;
    look_alike.add(line);
    for (std::size_t i = 1; i < LookAlike::kMostLines && next_data_line(input_, line); ++i) {
      look_alike.add(line);
    }
    const LookAlike::Verdict verdict = look_alike.verdict();
    if (verdict.what.empty()) return;
    refuse(input_.name(),
           "line " + std::to_string(number) + ": looks like " + verdict.what +
               "; expected points, with x, y and z in the first three columns",
           options_.may_choose ? Remedy::kColumns : Remedy::kNone,
           static_cast<double>(verdict.first_column));
  }

  InputBuffer& input_;
  const PointReadOptions& options_;
  XyzPrologue out_;
  std::size_t fields_ = 0;             ///< number of fields in the line of the first point
  std::vector<Comment> comments_;      ///< comments in reverse order
  std::optional<TableHeader> header_;  ///< header on a line of its own that names the columns
  bool all_named_ = false;  ///< whether every column has a name, or the caller chose three
};

}  // namespace

XyzPrologue read_xyz_prologue(InputBuffer& input, const PointReadOptions& options) {
  return PrologueReader(input, options).read();
}

}  // namespace clearway
