#include "io/formats/ptx/ptx_header.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/geometry/rigid.hpp"
#include "io/formats/text/point_line.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

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
                    shown(line[3]) + "; expected " + shown(last) +
                    ", as the translation is in the last row");
  }
  std::copy(line.begin(), line.end(), matrix.begin() + static_cast<std::ptrdiff_t>(4 * row));
}

void judge_matrix(const InputBuffer& input, PtxHeader& header) {
  Pose pose{};
  for (std::size_t i = 0; i < 9; ++i) pose.rotation[i] = header.matrix[i % 3 * 4 + i / 3];
  const Stretch stretch = stretch_of(pose);
  if (!(stretch.least > 0) || !std::isfinite(stretch.greatest)) {
    fail(input, "the 4x4 matrix of the scan has singular values from " + shown(stretch.least) +
                    " to " + shown(stretch.greatest) + "; expected an invertible matrix");
  }
  header.stretch[0] = stretch.least;
  header.stretch[1] = stretch.greatest;
  header.determinant = stretch.determinant;
  header.rigid = is_rigid(stretch);
}

}  // namespace

Vec3 PtxHeader::place(const Vec3& p) const {
  const auto& m = matrix;
  return {p.x * m[0] + p.y * m[4] + p.z * m[8] + m[12],
          p.x * m[1] + p.y * m[5] + p.z * m[9] + m[13],
          p.x * m[2] + p.y * m[6] + p.z * m[10] + m[14]};
}

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

}  // namespace clearway
