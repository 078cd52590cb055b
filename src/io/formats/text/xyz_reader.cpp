#include "io/formats/text/xyz_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "io/formats/text/column_names.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

using Columns = std::array<std::size_t, 3>;  // of x, y and z
constexpr Columns kFirstThree{0, 1, 2};

std::string_view without_leading_blanks(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const start = skip_blanks(line.data(), end);
  return {start, static_cast<std::size_t>(end - start)};
}

bool is_comment(std::string_view line) {
  return line.empty() || line.front() == '#' || line.starts_with("//");
}

/// x y z in the first three columns of a line; false where it is anything else.
bool parse_point(std::string_view line, Vec3& point) {
  const char* at = line.data();
  const char* const end = at + line.size();
  char first = 0;
  if (!parse_number(at, end, point.x) || (first = skip_separator(at, end)) == 0 ||
      !parse_number(at, end, point.y) || skip_separator(at, end) != first ||
      !parse_number(at, end, point.z)) {
    return false;
  }
  if (at == end) return true;
  const char behind = skip_separator(at, end);
  return behind == first || behind == ' ';
}

/// x, y and z in given columns.
bool parse_point(std::string_view line, char separator, const Columns& columns,
                 std::vector<std::string_view>& fields, Vec3& point) {
  split_fields(line, separator, fields);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns[axis] >= fields.size()) return false;
    const auto value = parse_whole_number(fields[columns[axis]]);
    if (!value) return false;
    point[static_cast<int>(axis)] = *value;
  }
  return true;
}

std::optional<Columns> columns_named(const ColumnNames& header) {
  static constexpr std::string_view kPlain[] = {""};
  const auto x = header.find(kPlain, "x");
  const auto y = header.find(kPlain, "y");
  const auto z = header.find(kPlain, "z");
  if (!x || !y || !z) return std::nullopt;
  return Columns{*x, *y, *z};
}

std::optional<std::uint64_t> whole_number(std::string_view line) {
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  std::uint64_t value = 0;
  const char* const end = line.data() + line.size();
  const auto [stop, error] = std::from_chars(line.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

class XyzReader final : public PointReader {
 public:
  explicit XyzReader(InputBuffer input) : input_(std::move(input)) {
    read_prologue();
    first_point_ = input_.mark();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.positions.resize(kBatchPoints);
    std::size_t count = 0;
    std::string_view line;
    while (count < kBatchPoints && next_data_line(line)) {
      if (next_ == info_.declared_points) {
        fail("more than the " + std::to_string(next_) + " points that the first line declares");
      }
      parse(line, batch.positions[count++]);
      ++next_;
    }
    batch.positions.resize(count);
    if (count < kBatchPoints) check_count();
    return count > 0;
  }

  void rewind() override {
    input_.return_to(first_point_);
    next_ = 0;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  bool next_data_line(std::string_view& line) {
    do {
      if (!input_.next_line(line)) return false;
      line = without_leading_blanks(line);
    } while (is_comment(line));
    return true;
  }

  void parse(std::string_view line, Vec3& point) {
    const bool valid = columns_ == kFirstThree
                           ? parse_point(line, point)
                           : parse_point(line, separator_, columns_, fields_, point);
    if (!valid) {
      fail(excerpt(line) +
           "; expected three numbers, the coordinates x y z, in blanks, commas or "
           "semicolons");
    }
    if (info_.declared_points && !input_.line_terminated()) {
      fail(
          "the file ends without a line break, so it may be cut; expected one behind the last "
          "line");
    }
  }

  void check_count() const {
    if (info_.declared_points && next_ != *info_.declared_points) {
      refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                std::to_string(next_) + " points; expected " +
                                std::to_string(*info_.declared_points) +
                                " as the first line declares");
    }
  }

  /// Reads what stands before the first point and leaves the input there.
  void read_prologue() {
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected points, one a line");
    input_.skip_byte_order_mark();
    std::string_view line;
    for (bool first = true;; first = false) {
      const InputBuffer::Mark start = input_.mark();
      if (!input_.next_line(line)) return;
      line = without_leading_blanks(line);
      if (is_comment(line)) {
        if (first) note_comment(line);
        continue;
      }
      Vec3 point{};
      if (parse_point(line, point)) return input_.return_to(start);
      read_first_line(line);
      return;
    }
  }

  /// The order of the columns where a first comment starts with x, y and z.
  void note_comment(std::string_view line) {
    ColumnNames header = parse_column_names(line);
    if (!line.starts_with("//") || header.names.size() < 3) return;
    header.names.resize(3);
    if (const auto columns = columns_named(header)) use_columns(*columns, header.separator);
  }

  void use_columns(const Columns& columns, char separator) {
    columns_ = columns;
    separator_ = separator;
  }

  /// A first line that is no point.
  void read_first_line(std::string_view line) {
    if (const auto count = whole_number(line)) {
      if (!input_.line_terminated()) fail("expected a line break behind the number of points");
      info_.declared_points = *count;
      refuse_ptx();
      return;
    }
    const ColumnNames header = parse_column_names(line);
    const auto columns = columns_named(header);
    if (!columns) {
      fail(excerpt(line) +
           "; expected the coordinates x y z, the number of points, or a header with "
           "one column each named x, y and z");
    }
    use_columns(*columns, header.separator);
  }

  void refuse_ptx() {
    const InputBuffer::Mark start = input_.mark();
    std::string_view line;
    if (next_data_line(line) && whole_number(line)) {
      fail(
          "two lines of one number each start a PTX file, which is not read; expected points. "
          "Convert it to LAS or PLY, for example with PDAL");
    }
    input_.return_to(start);
  }

  InputBuffer input_;
  CloudInfo info_;
  Columns columns_ = kFirstThree;
  char separator_ = ' ';
  std::vector<std::string_view> fields_;
  InputBuffer::Mark first_point_;
  std::uint64_t next_ = 0;  ///< number of points read
};

}  // namespace

std::unique_ptr<PointReader> read_xyz(InputBuffer input) {
  return std::make_unique<XyzReader>(std::move(input));
}

}  // namespace clearway
