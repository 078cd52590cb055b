#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "clearway/vec3.hpp"
#include "io/formats/byte_writer.hpp"
#include "io/system/file.hpp"

namespace clearway {

enum class PlyCoordinates { kFloat32, kFloat64 };

/// Contents of a PLY file's header, which must be known before the first point is written.
struct PlyOutput {
  std::uint64_t points = 0;
  PlyCoordinates coordinates = PlyCoordinates::kFloat64;
  bool first_pose = false;  ///< adds the property "first_pose", uint
  bool distance = false;    ///< adds the properties "distance", double, and "pose", uint
  bool body = false;        ///< adds the property "body", uint
  std::string comment{};    ///< comment of one line; empty for none
};

/// Additional properties of consecutive points. A span has one value per point where the header has
/// the property, and is empty otherwise.
struct PlyExtras {
  std::span<const std::uint32_t> first_pose{};
  std::span<const double> distance{};
  std::span<const std::uint32_t> pose{};
  std::span<const std::uint32_t> body{};
};

/// Writes a point cloud as binary little-endian PLY, front to back: the element "vertex" with the
/// properties x, y, z (double, or float rounded to nearest) and the properties that the header asks
/// for. Output is buffered; the caller owns the file.
class PlyWriter {
 public:
  PlyWriter(const File& file, const PlyOutput& header);

  void write(std::span<const Vec3> points, const PlyExtras& extras = {});

  /// Flushes. Throws std::logic_error unless exactly header.points points were written.
  void finish();

 private:
  ByteWriter out_;
  PlyOutput header_;
  std::uint64_t written_ = 0;
};

}  // namespace clearway
