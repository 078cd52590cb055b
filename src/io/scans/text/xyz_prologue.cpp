#include "io/scans/text/xyz_prologue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr std::string_view kDigits = "0123456789";

/// The numbers with which a line of data starts.
struct Row {
  static constexpr std::size_t kMostNumbers = 20, kMostWritten = 5;

  /// line: without leading blanks.
  explicit Row(std::string_view line);

  std::array<double, kMostNumbers> numbers{};
  std::size_t count = 0;                            ///< how many numbers the line starts with
  bool whole = false;                               ///< whether nothing follows them
  std::array<std::string, kMostWritten> written{};  ///< the first numbers, without quotes
};

using Rows = std::vector<Row>;

Row::Row(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  while (count < kMostNumbers) {
    const char* const start = at;
    if (!parse_number(at, end, numbers[count])) break;
    const bool quoted = *start == '"';
    if (count < kMostWritten) written[count] = std::string(start + quoted, at - quoted);
    ++count;
    if (at == end || skip_separator(at, end) == 0) break;
  }
  whole = at == end;
}

// Deviation of a norm from 1, as for the poses of a trajectory.
constexpr double kUnitTolerance = 0.01;
constexpr double kFarthestMetres = 1e8;  // greater than any coordinate on Earth
constexpr double kHighestMetres = 2e4;   // greater than any height on Earth

/// Whether some numbers of every line have the norm 1, as a quaternion or a normal has.
bool are_units(const Rows& rows, std::size_t first, std::size_t count) {
  return std::ranges::all_of(rows, [=](const Row& row) {
    double square = 0;
    for (std::size_t k = first; k < first + count; ++k) square += row.numbers[k] * row.numbers[k];
    return std::abs(std::sqrt(square) - 1) <= kUnitTolerance;
  });
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

std::size_t fewest_numbers(const Rows& rows) {
  return std::ranges::min(rows, {}, &Row::count).count;
}

std::size_t most_decimals(const Rows& rows, std::size_t column) {
  std::size_t most = 0;
  for (const Row& row : rows) {
    const std::string& text = row.written[column];
    const std::size_t point = text.find('.');
    if (point == std::string::npos) continue;
    const std::size_t end = std::min(text.find_first_not_of(kDigits, point + 1), text.size());
    most = std::max(most, end - (point + 1));
  }
  return most;
}

bool varies(const Rows& rows, std::size_t column) {
  return std::ranges::any_of(
      rows, [&](const Row& row) { return row.numbers[column] != rows[0].numbers[column]; });
}

/// Whether all numbers of a column are written with digits alone.
bool all_counting(const Rows& rows, std::size_t column) {
  return std::ranges::all_of(rows, [=](const Row& row) {
    const std::string& text = row.written[column];
    return !text.empty() && text.find_first_not_of(kDigits) == std::string::npos;
  });
}

/// Whether the absolute values of a column are below a limit.
bool within(const Rows& rows, std::size_t column, double limit) {
  return std::ranges::all_of(rows,
                             [=](const Row& row) { return std::abs(row.numbers[column]) < limit; });
}

/// Whether the fourth to sixth column are a normal, as behind the coordinates of points.
bool normals_fourth(const Rows& rows) { return fewest_numbers(rows) >= 6 && are_units(rows, 3, 3); }

/// Whether the numbers of a column ascend or descend by equal steps, as far as their digits say.
bool evenly_spaced(const Rows& rows, std::size_t column) {
  const double first = rows[0].numbers[column], last = rows.back().numbers[column];
  const double step = (last - first) / static_cast<double>(rows.size() - 1);
  const double digit = std::pow(10.0, -static_cast<double>(most_decimals(rows, column)));
  if (!(std::abs(step) > 0)) return false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double even = first + step * static_cast<double>(i);
    if (!(std::abs(rows[i].numbers[column] - even) <= 1.01 * digit)) return false;
  }
  return true;
}

/// A number may precede or follow each matrix: its index, or its quality.
bool holds_matrices(const Rows& rows) {
  for (std::size_t first = 0; first <= rows[0].count % 4; ++first) {
    const auto is_matrix = [=](const Row& row) {
      return is_rotation(std::span(row.numbers).subspan(first));
    };
    if (std::ranges::all_of(rows, is_matrix)) return true;
  }
  return false;
}

bool holds_times_and_quaternions(const Rows& rows) {
  const auto stays = [](const Row& a, const Row& b) { return !(a.numbers[0] < b.numbers[0]); };
  return are_units(rows, 4, 4) && std::ranges::adjacent_find(rows, stays) == rows.end();
}

/// Two layouts of scans that look alike are excluded: a normal with a curvature of 0, and an
/// intensity of 0 with a normal.
bool holds_quaternions(const Rows& rows) {
  return are_units(rows, 3, 4) && !are_units(rows, 3, 3) && !are_units(rows, 4, 3);
}

/// A regular grid of points is excluded, whose second column stays the same or counts too.
bool has_index_first(const Rows& rows) {
  const auto counts = [&](std::size_t column, double step) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double expected = rows[0].numbers[column] + step * static_cast<double>(i);
      if (rows[i].numbers[column] != expected) return false;
    }
    return all_counting(rows, column);
  };
  return counts(0, 1) && !counts(1, 0) && !counts(1, 1);
}

/// Whether the first column is a time and the next three are coordinates. Points may be sorted by
/// x, so other signs are needed: docs/design/conversion.md, "Signs of a time".
bool has_time_first(const Rows& rows) {
  const auto goes_back = [](const Row& a, const Row& b) { return b.numbers[0] < a.numbers[0]; };
  if (!varies(rows, 0) || std::ranges::adjacent_find(rows, goes_back) != rows.end()) return false;
  for (const std::size_t column : {1, 2, 3}) {
    if (!within(rows, column, kFarthestMetres)) return false;
  }
  const auto is_far = [](const Row& row) { return row.numbers[0] > kFarthestMetres; };
  if (std::ranges::all_of(rows, is_far)) return true;
  const auto [fewest, most] =
      std::minmax({most_decimals(rows, 1), most_decimals(rows, 2), most_decimals(rows, 3)});
  if (fewest == 0 || normals_fourth(rows) || !varies(rows, 1) || !varies(rows, 3)) return false;
  if (most_decimals(rows, 0) > most || all_counting(rows, 0)) return true;
  const bool no_height =
      within(rows, 3, kHighestMetres) && std::ranges::all_of(rows, [](const Row& row) {
        return std::abs(row.numbers[2]) > kHighestMetres;
      });
  return no_height || (fewest == most && evenly_spaced(rows, 0) && !evenly_spaced(rows, 1));
}

/// Whether the first two columns are the row and the column of a grid, of which one runs through
/// while the other stays, and the next three are coordinates.
bool has_grid_first(const Rows& rows) {
  if (!all_counting(rows, 0) || !all_counting(rows, 1) || normals_fourth(rows)) return false;
  for (const std::size_t column : {2, 3, 4}) {
    if (most_decimals(rows, column) == 0) return false;
  }
  const auto runs = [&](std::size_t slow, std::size_t fast) {
    const auto stops = [=](const Row& a, const Row& b) {
      const double lines = b.numbers[slow] - a.numbers[slow];
      const double places = b.numbers[fast] - a.numbers[fast];
      return !(lines == 0 ? places > 0 : lines > 0 && places < 0);
    };
    return std::ranges::adjacent_find(rows, stops) == rows.end();
  };
  return runs(0, 1) || runs(1, 0);
}

/// Something other than points that a text without column names may hold, recognised by its first
/// lines (docs/design/conversion.md, "Text that is no table of points"). The resemblance must hold
/// on every line examined, so that points pass.
struct LookAlike {
  std::size_t fewest_lines;
  /// Numbers of every line. Where `most` is 0, anything may follow them; otherwise all lines have
  /// the same number of numbers and nothing else.
  std::size_t fewest, most;
  bool (*test)(const Rows& rows);
  const char* what;          ///< end of the message
  std::size_t first_column;  ///< in which x is likely to be, counted from 1
};

constexpr std::size_t kExaminedLines = 100;
constexpr LookAlike kLookAlikes[] = {
    {1, 12, 13, holds_matrices, ", a rigid 3 x 4 matrix)", 2},
    {1, 16, 17, holds_matrices, ", a rigid 4 x 4 matrix)", 2},
    {2, 8, Row::kMostNumbers, holds_times_and_quaternions, ": time, position, quaternion)", 2},
    {1, 7, 7, holds_quaternions, ": position, quaternion)", 1},
    {3, 5, 0, has_grid_first, "two columns are the row and the column of a grid", 3},
    {3, 4, 0, has_index_first, "column is the point's number", 2},
    {10, 4, 0, has_time_first, "column is a time", 2},
};

constexpr std::size_t kMostCommentHeaders = 16;

class PrologueReader {
 public:
  PrologueReader(InputBuffer& input, const PointReadOptions& options)
      : input_(input), options_(options) {}

  XyzPrologue read() {
    out_.info.text_table = true;
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected points, one a line");
    input_.begin_text();
    std::string_view line;
    for (;;) {
      const InputBuffer::Mark start = input_.mark();
      if (!input_.next_line(line)) return std::move(out_);
      line = without_leading_blanks(line);
      if (is_text_comment(line)) {
        note_comment(line);
      } else if (!header_ && !out_.info.declared_points && count_in(line)) {
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
    out_.info.declared_points = count_in(line);
    out_.count_line = input_.line();
    out_.refuses_cut = true;
  }

  /// Whether a first line is data, judged by the columns as far as they are known.
  bool is_point(std::string_view line) {
    Vec3 point{};
    const auto holds = [&](const std::optional<CoordinateColumns>& columns) {
      return columns && PointLine(*columns, separator_of(line)).parse(line, point);
    };
    if (!options_.columns.empty() && holds(chosen_columns({}))) return true;
    const std::size_t fields = count_fields(line);
    return PointLine().parse(line, point) || std::ranges::any_of(comments_, [&](const Comment& c) {
             return c.header.names.size() == fields && holds(coordinate_columns(c.header));
           });
  }

  /// The columns that the caller chose; nullopt for names that `header` lacks.
  std::optional<CoordinateColumns> chosen_columns(const TableHeader& header) const {
    CoordinateColumns columns{};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::string& wanted = options_.columns[k];
      if (const auto number = count_in(wanted)) {
        if (*number < 1 || *number > InputBuffer::kLongestLine) return std::nullopt;
        columns[k] = *number - 1;
        continue;
      }
      const auto found = header.find(table_name(wanted));
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
      columns = chosen_columns(header);
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
    split_fields(line, separator, fields);
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
    TableHeader header;
    const auto named_by = std::ranges::find_if(comments_, [&](const Comment& comment) {
      return comment.header.names.size() == fields_ && chosen_columns(comment.header);
    });
    if (named_by != comments_.end()) header = named_by->header;
    const auto columns = chosen_columns(header);
    if (!columns) fail("no header names each of the columns " + wanted_columns() + " once", false);
    use(header, *columns, separator);
  }

  /// Whether the names fit the lines: there are as many, or fewer that start with x, y and z.
  bool fits(const TableHeader& header, const CoordinateColumns& columns) const {
    if (header.names.size() == fields_) return true;
    return header.names.size() < fields_ && *std::max_element(columns.begin(), columns.end()) == 2;
  }

  void use(const TableHeader& header, const CoordinateColumns& columns, char separator) {
    const std::string refused = take_units(header, columns, out_.info);
    if (!refused.empty()) {
      const std::string what = "the coordinates are in " + refused + " by the header";
      if (options_.columns.empty()) fail(what + "; expected metres: convert them first", false);
      warn("other-unit", what + ", and are read as metres as they are");
    }
    out_.line = PointLine(columns, separator);
    all_named_ = all_named_ || !options_.columns.empty();
  }

  void warn(WarningCode code, const std::string& what) {
    out_.info.remarks.push_back(warning(code, input_.name() + ": " + what));
  }

  void warn_of_misfit(const Comment& comment) {
    warn("column-names", fmt::format("the comment in line {} names {} columns, but the points have "
                                     "{}; the first three are read as x, y and z",
                                     comment.line, comment.header.names.size(), fields_));
  }

  /// Throws InputError where the text looks like something other than points. line: the first line
  /// of data, which was already read.
  void refuse_look_alike(std::string_view line) {
    const std::uint64_t number = input_.line();
    Rows rows;
    do {
      rows.emplace_back(line);
    } while (rows.size() < kExaminedLines && next_data_line(input_, line));
    const std::size_t numbers = fewest_numbers(rows);
    const bool same = std::ranges::all_of(
        rows, [=](const Row& row) { return row.whole && row.count == numbers; });
    for (const LookAlike& like : kLookAlikes) {
      const bool enough = rows.size() >= like.fewest_lines && numbers >= like.fewest;
      const bool alone = like.most == 0 || (same && numbers <= like.most);
      if (!enough || !alone || !like.test(rows)) continue;
      const std::string what = like.most == 0
                                   ? "a table whose first "
                                   : "a trajectory (" + std::to_string(numbers) + " numbers a line";
      refuse(input_.name(),
             "line " + std::to_string(number) + ": looks like " + what + like.what +
                 "; expected points, with x, y and z in the first three columns",
             options_.may_choose ? Remedy::kColumns : Remedy::kNone,
             static_cast<double>(like.first_column));
    }
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
