#include "io/paths/pose_input.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rigid.hpp"
#include "core/util/format.hpp"

namespace clearway {

void set_rotation(const AttitudeRow& row, AngleFrame frame, double north, Pose& pose) {
  const bool ned = frame == AngleFrame::kNed;
  // A body with y right and z down in a world of north, east and down equals one with y left and z
  // up in a world of east, north and up, with yaw pi / 2 - heading and the opposite pitch.
  const double turned = ned ? row.yaw + north : row.yaw - north;
  const double cy = ned ? std::sin(turned) : std::cos(turned);
  const double sy = ned ? std::cos(turned) : std::sin(turned);
  const double cp = std::cos(row.pitch);
  const double sp = ned ? -std::sin(row.pitch) : std::sin(row.pitch);
  const double cr = std::cos(row.roll);
  const double sr = std::sin(row.roll);
  const double rotation[9] = {cy * cp,
                              cy * sp * sr - sy * cr,
                              cy * sp * cr + sy * sr,
                              sy * cp,
                              sy * sp * sr + cy * cr,
                              sy * sp * cr - cy * sr,
                              -sp,
                              cp * sr,
                              cp * cr};
  std::copy_n(rotation, 9, pose.rotation);
}

namespace {

bool all_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
}

Objection objection_to(const Stretch& stretch, bool allow_non_rigid) {
  const std::string found =
      "the rotation has singular values from " + format_number(stretch.least) + " to " +
      format_number(stretch.greatest) + " and determinant " + format_number(stretch.determinant);
  if (!(stretch.least > 0) || !std::isfinite(stretch.greatest)) {
    return {found + "; expected an invertible matrix"};
  }
  if (allow_non_rigid || is_rigid(stretch)) return {};
  return {found + "; expected a rigid motion: singular values within " +
              format_number(kRigidTolerance) + " of 1 and a positive determinant",
          Remedy::kAllowNonRigid};
}

constexpr const char* kRowByRow =
    "expected it row by row: r11 r12 r13 x r21 r22 r23 y r31 r32 r33 z";

/// Whether 16 numbers are a 4x4 matrix in column-major order: its last row 0 0 0 1 then is every
/// fourth number.
bool is_by_column(std::span<const double> numbers) {
  return numbers[3] == 0 && numbers[7] == 0 && numbers[11] == 0 && numbers[15] == 1;
}

/// Whether 12 numbers are nine of a rotation and three of a position.
bool is_rotation_first(std::span<const double> numbers) {
  Pose pose{};
  std::copy_n(numbers.data(), 9, pose.rotation);
  return is_rigid(stretch_of(pose));
}

}  // namespace

std::string objection_to_angle(const char* name, double value, double most, const char* format) {
  if (std::abs(value) <= most) return {};  // false for NaN
  return std::string(name) + " " + format_digits(value, 9) + "; expected an angle up to " +
         format_digits(most, 9) +
         (std::isfinite(value) ? std::string(", as ") + format + " has radians, not degrees"
                               : " in radians");
}

Objection pose_of_matrix(std::span<const double> numbers, bool allow_non_rigid, Pose& pose) {
  if (!all_finite(numbers)) return {"expected finite numbers"};
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(numbers.data() + 4 * row, 3, pose.rotation + 3 * row);
    pose.translation[row] = numbers[4 * row + 3];
  }
  if (numbers.size() == 16) {
    constexpr double kNoise = 1e-9;
    for (std::size_t column = 0; column < 4; ++column) {
      if (std::abs(numbers[12 + column] - (column == 3 ? 1 : 0)) > kNoise) {
        if (is_by_column(numbers)) {
          return {std::string("the 4x4 matrix stands column by column, as its numbers 13 to 15 are "
                              "the position; ") +
                  kRowByRow + " 0 0 0 1"};
        }
        return {"the last row of the 4x4 matrix is not 0 0 0 1, but its numbers 13 to 16 are " +
                format_number(numbers[12]) + " " + format_number(numbers[13]) + " " +
                format_number(numbers[14]) + " " + format_number(numbers[15])};
      }
    }
  }
  const Stretch stretch = stretch_of(pose);
  if (is_rigid(stretch)) return {};
  if (!allow_non_rigid && numbers.size() == 12 && is_rotation_first(numbers)) {
    return {std::string("the first nine numbers are a rotation, and the last three a position; ") +
            kRowByRow};
  }
  return objection_to(stretch, allow_non_rigid);
}

Objection pose_of_quaternion(std::span<const double, 3> position,
                             std::span<const double, 4> quaternion, Pose& pose) {
  if (!all_finite(position) || !all_finite(quaternion)) return {"expected finite numbers"};
  constexpr double kNormTolerance = 0.01;
  const double norm = std::sqrt(quaternion[0] * quaternion[0] + quaternion[1] * quaternion[1] +
                                quaternion[2] * quaternion[2] + quaternion[3] * quaternion[3]);
  if (!(std::abs(norm - 1) <= kNormTolerance)) {
    return {"the quaternion has norm " + format_number(norm) + "; expected 1 within 0.01"};
  }
  const double x = quaternion[0] / norm;
  const double y = quaternion[1] / norm;
  const double z = quaternion[2] / norm;
  const double w = quaternion[3] / norm;
  pose = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
           1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           1 - 2 * (x * x + y * y)},
          {position[0], position[1], position[2]}};
  return {};
}

}  // namespace clearway
