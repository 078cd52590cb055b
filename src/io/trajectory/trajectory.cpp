#include "clearway/trajectory.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "io/formats/input_buffer.hpp"
#include "io/formats/text/column_names.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"
#include "io/trajectory/pose_input.hpp"
#include "io/trajectory/trajectory_columns.hpp"

namespace clearway {
namespace {

bool starts_with_number(std::string_view line) {
  const char* at = line.data();
  double value = 0;
  return parse_number(at, at + line.size(), value);
}

class TrajectoryParser {
 public:
  TrajectoryParser(InputBuffer input, const TrajectoryOptions& options)
      : input_(std::move(input)), options_(options), format_(options.format) {}

  std::vector<Pose> parse() {
    input_.skip_byte_order_mark();
    std::string_view line;
    while (input_.next_line(line)) {
      const char* const end = line.data() + line.size();
      line.remove_prefix(static_cast<std::size_t>(skip_blanks(line.data(), end) - line.data()));
      if (line.empty()) continue;
      if (line.front() == '#') {
        if (first_line_ == 0 && reads_names()) note_header(line);
      } else if (first_line_ == 0 && !started_ && is_header(line)) {
        started_ = true;
      } else {
        if (first_line_ == 0) start(line);
        add_row(line);
      }
    }
    return std::move(poses_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, Remedy remedy = Remedy::kNone) const {
    refuse_line(input_.name(), input_.line(), what, remedy);
  }

  bool reads_names() const {
    return format_ == TrajectoryFormat::kAuto || format_ == TrajectoryFormat::kCsv;
  }

  void note_header(std::string_view line) {
    if (auto columns = pose_columns(parse_column_names(line))) columns_ = std::move(columns);
  }

  /// Whether the first line that is no comment names columns; refused where they make no pose.
  bool is_header(std::string_view line) {
    if (starts_with_number(line)) return false;
    if (format_ == TrajectoryFormat::kEuroc) return true;
    if (!reads_names()) return false;
    columns_ = pose_columns(parse_column_names(line));
    if (!columns_) {
      fail(excerpt(line) +
           "; expected numbers, or a header with the columns x y z (or tx, p_x, pos_x, ...) and qx "
           "qy "
           "qz qw (or q_x, ...) or r00 to r22");
    }
    format_ = TrajectoryFormat::kCsv;
    return true;
  }

  /// Settles the format by the first line of numbers.
  void start(std::string_view line) {
    first_line_ = input_.line();
    std::vector<std::string_view> fields;
    split_fields(line, columns_ ? columns_->separator : ',', fields);
    if (format_ == TrajectoryFormat::kEuroc) {
      if (fields.size() < 8) {
        fail(std::to_string(fields.size()) +
             " columns; expected at least 8 with commas: time, position x y z, quaternion w x y z");
      }
      columns_ = euroc_columns(fields.size());
    } else if (format_ == TrajectoryFormat::kCsv && !columns_) {
      fail("expected a header that names the columns before the first numbers");
    } else if (format_ == TrajectoryFormat::kAuto) {
      if (columns_ && columns_->fields == fields.size()) {
        format_ = TrajectoryFormat::kCsv;
      } else {
        guess(line);
      }
    }
  }

  /// By the number of numbers, where there is no header.
  void guess(std::string_view line) {
    const auto count = parse_number_line(line, numbers_);
    if (count == 12u || count == 16u) {
      format_ = TrajectoryFormat::kMatrix;
    } else if (count == 8u) {
      constexpr double kSurelyNanoseconds = 1e14;
      if (numbers_[0] >= kSurelyNanoseconds) {
        fail(
            "8 numbers with a time in nanoseconds, but no header; the format can be tum (qx qy qz "
            "qw) or euroc (qw qx qy qz)",
            Remedy::kNameFormat);
      }
      format_ = TrajectoryFormat::kTum;
    } else {
      refuse_count(
          line, count,
          "12 or 16 (a matrix), 8 (TUM: t x y z qx qy qz qw), or a header that names the columns. "
          "EuRoC without a header has to be named");
    }
  }

  [[noreturn]] void refuse_count(std::string_view line, std::optional<std::size_t> count,
                                 const std::string& expected) const {
    if (!count) fail(excerpt(line) + "; expected numbers only, in blanks or commas: " + expected);
    if (count == 4u || count == 3u) {
      fail(std::to_string(*count) +
           " numbers; a matrix spread over several lines is not read. Expected each pose on one "
           "line: " +
           expected);
    }
    fail((*count > numbers_.size() ? "more than " + std::to_string(numbers_.size())
                                   : std::to_string(*count)) +
         " numbers; expected " + expected);
  }

  void add_row(std::string_view line) {
    Pose pose{};
    const Objection objection = format_ == TrajectoryFormat::kMatrix ? parse_matrix(line, pose)
                                : format_ == TrajectoryFormat::kTum  ? parse_tum(line, pose)
                                                                     : parse_columns(line, pose);
    if (!objection.text.empty()) fail(objection.text, objection.remedy);
    poses_.push_back(pose);
  }

  Objection parse_matrix(std::string_view line, Pose& pose) {
    const auto count = parse_number_line(line, numbers_);
    if (count != 12u && count != 16u) refuse_count(line, count, "12 or 16, a row-major matrix");
    if (row_numbers_ == 0) row_numbers_ = *count;
    if (count != row_numbers_) {
      return {std::to_string(*count) + " numbers; expected " + std::to_string(row_numbers_) +
              " as in line " + std::to_string(first_line_)};
    }
    return pose_of_matrix(std::span(numbers_).first(*count), options_.allow_non_rigid, pose);
  }

  Objection parse_tum(std::string_view line, Pose& pose) {
    const auto count = parse_number_line(line, numbers_);
    if (count != 8u) refuse_count(line, count, "8: t x y z qx qy qz qw");
    if (!std::isfinite(numbers_[0])) return {"expected a finite time"};
    const std::span<const double> numbers(numbers_);
    return pose_of_quaternion(numbers.subspan<1, 3>(), numbers.subspan<4, 4>(), pose);
  }

  Objection parse_columns(std::string_view line, Pose& pose) {
    split_fields(line, columns_->separator, fields_);
    if (fields_.size() != columns_->fields) {
      return {std::to_string(fields_.size()) + " columns; expected " +
              std::to_string(columns_->fields) + " as before"};
    }
    std::array<double, 3> position{};
    for (std::size_t k = 0; k < 3; ++k) position[k] = number_in(columns_->position[k]);
    const auto& rotation = columns_->rotation;
    if (rotation.size() == 4) {
      std::array<double, 4> quaternion{};
      for (std::size_t k = 0; k < 4; ++k) quaternion[k] = number_in(rotation[k]);
      return pose_of_quaternion(position, quaternion, pose);
    }
    std::array<double, 12> matrix{};
    for (std::size_t k = 0; k < 9; ++k) matrix[4 * (k / 3) + k % 3] = number_in(rotation[k]);
    for (std::size_t k = 0; k < 3; ++k) matrix[4 * k + 3] = position[k];
    return pose_of_matrix(matrix, options_.allow_non_rigid, pose);
  }

  double number_in(std::size_t column) const {
    const auto value = parse_whole_number(fields_[column]);
    if (!value) {
      fail(excerpt(fields_[column]) + " in column " + std::to_string(column + 1) +
           "; expected a number");
    }
    return *value;
  }

  InputBuffer input_;
  TrajectoryOptions options_;
  TrajectoryFormat format_;             ///< kAuto until the first numbers
  std::optional<PoseColumns> columns_;  ///< of kCsv and kEuroc, and what a comment may have named
  std::uint64_t first_line_ = 0;        ///< of numbers; 0: none yet
  bool started_ = false;                ///< a header has been read
  std::size_t row_numbers_ = 0;         ///< 12 or 16 in every line; 0: none yet
  std::array<double, 16> numbers_{};
  std::vector<std::string_view> fields_;
  std::vector<Pose> poses_;
};

}  // namespace

std::vector<Pose> read_trajectory(const std::filesystem::path& path,
                                  const TrajectoryOptions& options) {
  File file = File::open_for_reading(path);
  const auto access = file.is_regular() ? InputBuffer::Access::kSeek : InputBuffer::Access::kStream;
  return TrajectoryParser(InputBuffer(std::move(file), access), options).parse();
}

}  // namespace clearway
