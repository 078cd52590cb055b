#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/files/bytes.hpp"
#include "io/files/file.hpp"
#include "io/scans/point_field.hpp"

namespace clearway {

enum class PlyCoordinates { kFloat32, kFloat64 };

/// Contents of a PLY file's header, which must be known before the first point is written.
struct PlyOutput {
  std::uint64_t points = 0;
  PlyCoordinates coordinates = PlyCoordinates::kFloat64;
  std::vector<PointField> fields{};     ///< become properties of type uint, uchar or double
  std::vector<std::string> comments{};  ///< comments of one line each
};

/// Writes a point cloud as binary little-endian PLY, front to back: the element "vertex" with the
/// properties x, y, z (double, or float rounded to nearest) and the properties that the header asks
/// for. Output is buffered; the caller owns the file.
class PlyWriter {
 public:
  PlyWriter(const File& file, const PlyOutput& header);

  /// values: those of each field of the header. Throws std::logic_error where they do not fit.
  void write(std::span<const Vec3> points, std::span<const FieldValues> values = {});

  /// Flushes. Throws std::logic_error unless exactly header.points points were written.
  void finish();

 private:
  ByteWriter out_;
  PlyOutput header_;
  std::uint64_t written_ = 0;
};

}  // namespace clearway
