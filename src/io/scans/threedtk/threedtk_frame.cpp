#include "io/scans/threedtk/threedtk_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"

namespace clearway {
namespace {

constexpr double kCentimetresPerMetre = 100;
constexpr std::size_t kFrameNumbers = 17;

/// The axis of 3DTK that corresponds to each of Clearway's axes.
constexpr std::array<std::size_t, 3> kAxis{2, 0, 1};
constexpr std::array<double, 3> kSign{1, -1, 1};

}  // namespace

Vec3 from_threedtk(const Vec3& point) {
  return {point.z / kCentimetresPerMetre, -point.x / kCentimetresPerMetre,
          point.y / kCentimetresPerMetre};
}

std::array<double, 12> from_threedtk(const ThreedtkMatrix& matrix) {
  std::array<double, 12> out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      out[4 * row + column] = kSign[row] * kSign[column] * matrix[4 * kAxis[column] + kAxis[row]];
    }
    out[4 * row + 3] = kSign[row] * matrix[12 + kAxis[row]] / kCentimetresPerMetre;
  }
  return out;
}

ThreedtkMatrix threedtk_matrix(std::span<const double, 3> position,
                               std::span<const double, 3> angles) {
  std::array<double, 3> s{}, c{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double radians = angles[k] * std::numbers::pi / 180;
    s[k] = std::sin(radians);
    c[k] = std::cos(radians);
  }
  // The product Rx Ry Rz of rotations about x, y and z, column-major.
  return {c[1] * c[2],
          s[0] * s[1] * c[2] + c[0] * s[2],
          s[0] * s[2] - c[0] * s[1] * c[2],
          0,
          -c[1] * s[2],
          c[0] * c[2] - s[0] * s[1] * s[2],
          c[0] * s[1] * s[2] + s[0] * c[2],
          0,
          s[1],
          -s[0] * c[1],
          c[0] * c[1],
          0,
          position[0],
          position[1],
          position[2],
          1};
}

Objection pose_of_threedtk_euler(std::span<const double> numbers, Pose& pose) {
  if (numbers.size() != 6 && numbers.size() != 7) {
    return {std::to_string(numbers.size()) +
            " numbers; expected six, x y z in centimetres and three angles in degrees"};
  }
  const auto matrix = threedtk_matrix(numbers.first<3>(), numbers.subspan<3, 3>());
  return pose_of_matrix(from_threedtk(matrix), false, pose);
}

Objection pose_of_threedtk_frame(std::span<const double> numbers, bool allow_non_rigid,
                                 Pose& pose) {
  if (numbers.size() != 16 && numbers.size() != kFrameNumbers) {
    return {std::to_string(numbers.size()) +
            " numbers; expected 16 of a 4x4 matrix and the colour of the scan"};
  }
  ThreedtkMatrix matrix;
  std::copy_n(numbers.begin(), matrix.size(), matrix.begin());
  for (std::size_t column = 0; column < 4; ++column) {
    if (matrix[4 * column + 3] != (column == 3 ? 1 : 0)) {
      return {"the last row of the 4x4 matrix is not 0 0 0 1; expected it column by column"};
    }
  }
  return pose_of_matrix(from_threedtk(matrix), allow_non_rigid, pose);
}

Pose read_threedtk_pose(TextTable& table) {
  std::array<double, 7> numbers{};
  std::size_t count = 0;
  while (table.next()) {
    const auto found = parse_number_line(table.line(), std::span(numbers).subspan(count));
    if (!found || count + *found > numbers.size()) {
      table.refuse_here(excerpt(table.line()) +
                        "; expected six numbers in all, x y z in centimetres and three angles in "
                        "degrees");
    }
    count += *found;
  }
  Pose pose{};
  const Objection objection = pose_of_threedtk_euler(std::span(numbers).first(count), pose);
  if (!objection.text.empty()) refuse(table.name(), objection.text);
  return pose;
}

Pose read_threedtk_frames(TextTable& table) {
  std::array<double, kFrameNumbers> numbers{};
  std::optional<Pose> last;
  while (table.next()) {
    const auto found = parse_number_line(table.line(), numbers);
    if (!found || *found > numbers.size()) {
      table.refuse_here(excerpt(table.line()) +
                        "; expected 17 numbers, a 4x4 matrix and the colour of the scan");
    }
    const Objection objection =
        pose_of_threedtk_frame(std::span(numbers).first(*found), false, last.emplace());
    if (!objection.text.empty()) table.refuse_here(objection.text);
  }
  if (!last) refuse(table.name(), "holds no pose; expected lines of 17 numbers");
  return *last;
}

}  // namespace clearway
