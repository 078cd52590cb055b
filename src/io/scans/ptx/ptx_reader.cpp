#include "io/scans/ptx/ptx_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "clearway/vec3.hpp"
#include "core/geometry/rigid.hpp"
#include "core/util/format.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/xyz_reader.hpp"

/// PTX, the text format of Leica's Cyclone: one scan after another, each with ten lines of header
/// and then one line per point.
namespace clearway {
namespace {

/// The header of one scan in a PTX file.
struct PtxHeader {
  std::uint64_t line = 0;    ///< number of the header's first line
  std::uint64_t points = 0;  ///< number of points, columns times rows
  /// Row-major with last column 0 0 0 1; a point p as a row becomes p M.
  std::array<double, 16> matrix{};
  Pose pose{};               ///< the matrix as a pose
  Vec3 position{};           ///< where the scanner stood
  Stretch stretch{1, 1, 1};  ///< of the matrix
  /// Largest difference in a coordinate between an axis of the scanner and its row of the matrix.
  double axes_differ = 0;
  /// Distance of the scanner's position from the translation of the matrix.
  double position_differs = 0;

  Vec3 place(const Vec3& point) const;
};

constexpr std::uint64_t kMostOfASide = 0xFFFFFFFF;  // greatest number of columns or rows
constexpr double kNoise = 1e-9;                     // tolerance for 0 and 1 in the last column

[[noreturn]] void fail(const InputBuffer& input, const std::string& what) {
  refuse_line(input.name(), input.line(), what);
}

std::string_view next(InputBuffer& input, const char* expected) {
  std::string_view line;
  if (next_data_line(input, line)) return line;
  refuse(input.name(), "ends after line " + std::to_string(input.line()) +
                           " within the ten lines before a scan; expected " + expected);
}

std::uint64_t side(const InputBuffer& input, std::string_view line, const char* of) {
  const auto count = count_in(line);
  if (!count || *count > kMostOfASide) {
    fail(input, excerpt(line) + "; expected the number of " + of +
                    " of a scan, a whole number up to 4294967295");
  }
  return *count;
}

template <std::size_t Count>
std::array<double, Count> numbers(InputBuffer& input, const char* expected) {
  const std::string_view line = next(input, expected);
  std::array<double, Count> out{};
  const auto found = parse_number_line(line, out);
  if (found != Count ||
      !std::all_of(out.begin(), out.end(), [](double n) { return std::isfinite(n); })) {
    fail(input, excerpt(line) + "; expected " + expected);
  }
  return out;
}

/// Reads a row of the matrix. row: its index, from 0.
void read_row(InputBuffer& input, std::size_t row, std::array<double, 16>& matrix) {
  const auto line = numbers<4>(input, "a row of the 4x4 matrix, four numbers");
  const double last = row == 3 ? 1 : 0;
  if (std::abs(line[3] - last) > kNoise) {
    fail(input, "row " + std::to_string(row + 1) + " of the 4x4 matrix ends with " +
                    format_number(line[3]) + "; expected " + format_number(last) +
                    ", as the translation is in the last row");
  }
  std::copy(line.begin(), line.end(), matrix.begin() + static_cast<std::ptrdiff_t>(4 * row));
}

void judge_matrix(const InputBuffer& input, PtxHeader& header) {
  Pose& pose = header.pose;
  for (std::size_t i = 0; i < 9; ++i) pose.rotation[i] = header.matrix[i % 3 * 4 + i / 3];
  for (std::size_t k = 0; k < 3; ++k) pose.translation[k] = header.matrix[12 + k];
  const Stretch stretch = stretch_of(pose);
  if (!(stretch.least > 0) || !std::isfinite(stretch.greatest)) {
    fail(input, "the 4x4 matrix of the scan has singular values from " +
                    format_number(stretch.least) + " to " + format_number(stretch.greatest) +
                    "; expected an invertible matrix");
  }
  header.stretch = stretch;
}

Vec3 PtxHeader::place(const Vec3& p) const {
  const auto& m = matrix;
  return {p.x * m[0] + p.y * m[4] + p.z * m[8] + m[12],
          p.x * m[1] + p.y * m[5] + p.z * m[9] + m[13],
          p.x * m[2] + p.y * m[6] + p.z * m[10] + m[14]};
}

/// Reads the header of the next scan; nullopt at the end of the file. Throws InputError, also for a
/// matrix that cannot be inverted.
std::optional<PtxHeader> read_ptx_header(InputBuffer& input) {
  std::string_view line;
  if (!next_data_line(input, line)) return std::nullopt;
  PtxHeader header;
  header.line = input.line();
  const std::uint64_t columns = side(input, line, "columns");
  header.points = columns * side(input, next(input, "the number of rows"), "rows");
  const auto position = numbers<3>(input, "the scanner's position, three numbers");
  std::array<std::array<double, 3>, 3> axes{};
  for (auto& axis : axes) axis = numbers<3>(input, "an axis of the scanner, three numbers");
  for (std::size_t row = 0; row < 4; ++row) read_row(input, row, header.matrix);
  judge_matrix(input, header);
  header.position = {position[0], position[1], position[2]};
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    squares += std::pow(position[k] - header.matrix[12 + k], 2);
    for (std::size_t row = 0; row < 3; ++row) {
      header.axes_differ =
          std::max(header.axes_differ, std::abs(axes[row][k] - header.matrix[4 * row + k]));
    }
  }
  header.position_differs = std::sqrt(squares);
  return header;
}

constexpr double kAxesTolerance = 1e-3;      // greatest difference in a coordinate of an axis
constexpr double kPositionTolerance = 1e-3;  // greatest distance between positions, metres

/// Counts of what deserves a remark, over all scans.
struct PtxFindings {
  std::uint64_t scans = 0, records = 0;
  std::uint64_t not_rigid = 0, contradicting = 0;  // numbers of scans
  PtxHeader first_not_rigid, most_contradicting;

  void add(const PtxHeader& header) {
    ++scans;
    records += header.points;
    if (!is_rigid(header.stretch) && ++not_rigid == 1) first_not_rigid = header;
    if (header.axes_differ <= kAxesTolerance && header.position_differs <= kPositionTolerance) {
      return;
    }
    const auto size = [](const PtxHeader& h) {
      return std::max(h.axes_differ, h.position_differs);
    };
    if (++contradicting == 1 || size(header) > size(most_contradicting)) {
      most_contradicting = header;
    }
  }

  void append_to(std::vector<Message>& remarks, const std::string& name) const;
};

Message remark_on_stretch(const PtxFindings& found, const std::string& name) {
  const PtxHeader& h = found.first_not_rigid;
  return warning(
      "scan-not-rigid",
      name + ": " + format_count(found.not_rigid) + " of " + format_count(found.scans) +
          " scans have a matrix that scales, shears or mirrors. The first is at line " +
          std::to_string(h.line) + ": singular values from " + format_digits(h.stretch.least, 9) +
          " to " + format_digits(h.stretch.greatest, 9) + ", determinant " +
          format_digits(h.stretch.determinant, 9) + ". The matrices are applied as they are",
      {{"scans", found.not_rigid},
       {"line", h.line},
       {"least", h.stretch.least},
       {"greatest", h.stretch.greatest},
       {"determinant", h.stretch.determinant}});
}

Message remark_on_axes(const PtxFindings& found, const std::string& name) {
  const PtxHeader& h = found.most_contradicting;
  return warning(
      "scan-axes-contradict",
      {{"scans", found.contradicting},
       {"line", h.line},
       {"position", h.position_differs},
       {"axes", h.axes_differ}},
      "{}: the scanner's position and axes contradict the matrix in {} of {} scans. In the one at "
      "line {} the positions are {} apart, and the axes differ by {}. The matrix is applied",
      name, format_count(found.contradicting), format_count(found.scans), h.line,
      format_digits(h.position_differs, 9), format_digits(h.axes_differ, 9));
}

void PtxFindings::append_to(std::vector<Message>& remarks, const std::string& name) const {
  if (not_rigid > 0) remarks.push_back(remark_on_stretch(*this, name));
  if (contradicting > 0) remarks.push_back(remark_on_axes(*this, name));
}

class PtxReader final : public PointReader {
 public:
  PtxReader(InputBuffer input, std::vector<Message> remarks)
      : input_(std::move(input)), remarks_(std::move(remarks)) {
    input_.begin_text();
    start_ = input_.mark();
    if (!next_scan()) refuse(input_.name(), "holds no scan; expected PTX, columns and rows first");
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    while (batch.positions.size() < kBatchPoints) {
      if (left_ == 0) {
        // A batch holds points of one scan.
        if (!batch.positions.empty() || !next_scan()) break;
        continue;
      }
      const auto index = static_cast<std::uint32_t>(batch.positions.size());
      if (!read_point(batch.positions.emplace_back())) batch.absent.push_back(index);
    }
    batch.turn = turn_of(scan_.pose);
    if (batch.positions.empty()) finish();
    return !batch.positions.empty();
  }

  void rewind() override {
    input_.return_to(start_);
    findings_ = {};
    origins_.clear();
    open_end_ = OpenEnd();
    left_ = 0;
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    Vec3 point{};
    return lines_of_points(points, input_, [&] {
      while (left_ == 0) {
        if (!next_scan()) return false;
      }
      read_point(point);
      return true;
    });
  }

 private:
  bool next_scan() {
    const auto header = read_ptx_header(input_);
    if (!header) return false;
    check_room(*header);
    scan_ = *header;
    left_ = scan_.points;
    if (left_ > 0) origins_.push_back({findings_.records, scan_.position});
    findings_.add(scan_);
    return true;
  }

  void check_room(const PtxHeader& header) const {
    if (header.points <= most_points_in_rest(input_)) return;
    refuse_line(input_.name(), header.line,
                "a scan of " + format_count(header.points) + " points, for which the file of " +
                    format_count(*input_.size()) + " bytes is too short; expected a line for each");
  }

  std::string place() const {
    return std::to_string(scan_.points - left_) + " of " + std::to_string(scan_.points) +
           " points of the scan at line " + std::to_string(scan_.line);
  }

  /// Reads a record; returns false for one without a point.
  bool read_point(Vec3& point) {
    std::string_view line;
    if (!next_data_line(input_, line)) {
      refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                place() + "; expected all of them");
    }
    if (!parse_point(line, point)) {
      refuse_line(
          input_.name(), input_.line(),
          excerpt(line) + " after " + place() + "; expected three numbers, the coordinates x y z");
    }
    open_end_.see(input_, line);
    --left_;
    if (point.x == 0 && point.y == 0 && point.z == 0) {
      constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
      point = {kNaN, kNaN, kNaN};
      return false;
    }
    point = scan_.place(point);
    return true;
  }

  void finish() {
    info_.origins = origins_;
    info_.origins_rest_on = "scanner positions of PTX";
    info_.remarks = remarks_;
    findings_.append_to(info_.remarks, input_.name());
    open_end_.append_to(info_.remarks, input_.name());
  }

  InputBuffer input_;
  std::vector<Message> remarks_;  ///< remarks known before reading
  CloudInfo info_;
  InputBuffer::Mark start_;
  PtxHeader scan_;
  std::uint64_t left_ = 0;  ///< points of the current scan that are not read yet
  PtxFindings findings_;
  std::vector<OriginRun> origins_;  ///< of the scans that were begun
  OpenEnd open_end_;
};

}  // namespace

std::unique_ptr<PointReader> read_ptx(InputBuffer input, std::vector<Message> remarks) {
  return std::make_unique<PtxReader>(std::move(input), std::move(remarks));
}

}  // namespace clearway
