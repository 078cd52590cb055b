#include "io/formats/text/xyz_prologue.hpp"

#include <algorithm>
#include <utility>

#include "io/formats/text/column_names.hpp"
#include "io/formats/text/look_alike.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::size_t kMostCommentHeaders = 16;

class PrologueReader {
 public:
  PrologueReader(InputBuffer& input, const PointReadOptions& options)
      : input_(input), options_(options) {}

  XyzPrologue read() {
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected points, one a line");
    input_.skip_byte_order_mark();
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
      const auto found = header ? column_named(*header, table_name(wanted)) : std::nullopt;
      if (!found) return std::nullopt;
      columns[k] = *found;
    }
    return columns;
  }

  std::string wanted_columns() const {
    return options_.columns[0] + ", " + options_.columns[1] + ", " + options_.columns[2];
  }

  /// Reads a first line that is no point: the header that names the columns, or something to
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
    split_fields(line, separator, fields);
    return std::any_of(columns.begin(), columns.end(), [&](std::size_t column) {
      return column < fields.size() && parse_whole_number(fields[column]);
    });
  }

  /// Finds the separator of the lines behind a header, which may differ from the one between its
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
    all_named_ = all_named_ || !options_.columns.empty();
  }

  void warn(const char* code, const std::string& what) {
    out_.remarks.push_back({Message::Severity::kWarning, code, input_.name() + ": " + what, {}});
  }

  void warn_of_misfit(const Comment& comment) {
    warn("column-names", "the comment in line " + std::to_string(comment.line) + " names " +
                             std::to_string(comment.header.names.size()) +
                             " columns, but the points have " + std::to_string(fields_) +
                             "; the first three are read as x, y and z");
  }

  /// Throws InputError where the text looks like something else than points. line: the first line
  /// of data, which was already read.
  void refuse_look_alike(std::string_view line) {
    const std::uint64_t number = input_.line();
    LookAlike look_alike;
    look_alike.add(line);
    for (std::size_t i = 1; i < LookAlike::kMostLines && next_data_line(input_, line); ++i) {
      look_alike.add(line);
    }
    const std::string verdict = look_alike.verdict();
    if (verdict.empty()) return;
    refuse_line(input_.name(), number,
                "looks like " + verdict +
                    "; expected points, with x, y and z in the first three "
                    "columns",
                options_.may_choose ? Remedy::kColumns : Remedy::kNone);
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
