#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"

/// PTX, the text format of Leica's Cyclone: one scan after another, ten lines and a point a line.
namespace clearway {

/// What stands before the points of one scan.
struct PtxHeader {
  std::uint64_t line = 0;           ///< of the first of its lines
  std::uint64_t points = 0;         ///< columns times rows
  std::array<double, 16> matrix{};  ///< row by row, last column 0 0 0 1: p' = p M, p a row
  double stretch[2] = {1, 1};       ///< least and greatest singular value of the matrix' rotation
  double determinant = 1;
  bool rigid = true;            ///< neither scales nor shears nor mirrors
  double axes_differ = 0;       ///< largest |axis - row of the matrix| of the scanner's axes
  double position_differs = 0;  ///< distance of the scanner's position from that of the matrix

  Vec3 place(const Vec3& point) const;
};

/// None at the end of the file. Throws InputError, also for a matrix that cannot be inverted.
std::optional<PtxHeader> read_ptx_header(InputBuffer& input);

}  // namespace clearway
