#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/scans/input_buffer.hpp"

/// PCD, the format of the Point Cloud Library: versions .5 to .7.
/// Source: https://pointclouds.org/documentation/tutorials/pcd_file_format.html
namespace clearway {

enum class PcdData { kAscii, kBinary, kCompressed };

struct PcdField {
  std::string name;
  std::size_t size = 4;     ///< bytes per element: 1, 2, 4 or 8
  char type = 'F';          ///< type of the elements: I, U or F
  std::uint64_t count = 1;  ///< number of elements

  std::uint64_t bytes() const { return size * count; }
  /// Whether the field is padding, which aligns other fields in memory. The data of kCompressed has
  /// none.
  bool padding() const { return name == "_"; }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::array<std::size_t, 3> coordinates{};  ///< indices of x, y and z
  std::uint64_t height = 1;                  ///< number of rows; above 1 for an organised cloud
  std::uint64_t points = 0;
  std::optional<std::array<double, 7>> viewpoint;  ///< x y z, quaternion w x y z
  PcdData data = PcdData::kAscii;

  /// Bytes of all fields of a point, with or without padding.
  std::uint64_t point_bytes(bool with_padding) const;
};

/// Reads the header and leaves the input after the line DATA. Throws InputError.
PcdHeader read_pcd_header(InputBuffer& input);

/// Loads an element of a field as a double from its little-endian bytes.
using PcdLoad = double (*)(const std::byte*);
PcdLoad load_of(const PcdField& field);

}  // namespace clearway
