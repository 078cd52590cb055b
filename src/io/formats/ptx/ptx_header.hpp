#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"

/// PTX, the text format of Leica's Cyclone: one scan after another, each with ten lines of header
/// and then one line per point.
namespace clearway {

/// The header of one scan in a PTX file.
struct PtxHeader {
  std::uint64_t line = 0;    ///< number of the header's first line
  std::uint64_t points = 0;  ///< number of points, columns times rows
  /// Row-major with last column 0 0 0 1; a point p as a row becomes p M.
  std::array<double, 16> matrix{};
  double stretch[2] = {1, 1};  ///< least and greatest singular value of the matrix' rotation
  double determinant = 1;
  bool rigid = true;  ///< whether the matrix neither scales nor shears nor mirrors
  /// Largest difference in a coordinate between an axis of the scanner and its row of the matrix.
  double axes_differ = 0;
  /// Distance of the scanner's position from the translation of the matrix.
  double position_differs = 0;

  Vec3 place(const Vec3& point) const;
};

/// Reads the header of the next scan; nullopt at the end of the file. Throws InputError, also for a
/// matrix that cannot be inverted.
std::optional<PtxHeader> read_ptx_header(InputBuffer& input);

}  // namespace clearway
