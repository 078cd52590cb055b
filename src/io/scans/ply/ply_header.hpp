#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/scans/input_buffer.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t size_bytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;  ///< type of the value, or of the items of a list
  /// Type of a list's number of items; nullopt where the property is not a list.
  std::optional<PlyType> list_count;
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;

  /// Bytes of one element in a binary file; nullopt where a list makes the size vary.
  std::optional<std::size_t> fixed_bytes() const;
  /// Least number of bytes of one element in a binary file.
  std::size_t least_bytes() const;
};

/// Start of the comment in a file of points that were sampled from a mesh. Their spacing in metres
/// (Query::model_spacing) follows.
inline constexpr std::string_view kSpacingComment = "clearway model spacing ";

struct PlyHeader {
  PlyFormat format;
  std::vector<PlyElement> elements;
  std::size_t vertex;          ///< index of the element named vertex
  std::size_t coordinates[3];  ///< indices of the vertices' properties x, y, z, all scalar
  /// Spacing in metres from the comment that begins with kSpacingComment; 0 where there is none.
  double model_spacing = 0;
  /// Unit of the coordinates from the comment that begins with kUnitComment; null where there is
  /// none.
  const NamedUnit* unit = nullptr;
  /// A comment that places the points, see StatedCrs; empty where there is none.
  std::string unplaced = {};

  const PlyElement& vertices() const { return elements[vertex]; }
};

/// Reads the header and leaves the input after it. Throws InputError with the line for anything
/// malformed, and where there is no element vertex with x, y and z. Source: G. Turk, The PLY
/// Polygon File Format, 1994, with the later names of types.
PlyHeader read_ply_header(InputBuffer& input);

}  // namespace clearway
