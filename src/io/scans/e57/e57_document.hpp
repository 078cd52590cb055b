#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "io/scans/e57/e57_file.hpp"

namespace clearway {

/// The part of each record that one bytestream of a scan holds.
struct E57Field {
  enum class Kind { kInteger, kFloat32, kFloat64, kText };

  Kind kind = Kind::kText;
  unsigned bits = 8;         ///< bits of a record; for a string, the least number
  std::int64_t minimum = 0;  ///< kInteger: value that the stored bits are added to
  double scale = 1;          ///< kInteger: the value is integer * scale + offset
  double offset = 0;

  /// Bytes of this many records in the bytestream; at most 2^60, more than any file has.
  std::uint64_t bytes_of(std::uint64_t records) const {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 60;
    return bits > 0 && records > kMost / bits ? kMost : (records * bits + 7) / 8;
  }
};

/// The fields from which a point's position is computed; indices into E57Scan::places.
enum E57Place : std::uint8_t {
  kE57X,
  kE57Y,
  kE57Z,
  kE57CartesianState,
  kE57Range,
  kE57Azimuth,
  kE57Elevation,
  kE57SphericalState,
  kE57Places
};

/// Stands in E57Scan::places for a field that the scan lacks.
inline constexpr std::uint32_t kNoE57Stream = std::numeric_limits<std::uint32_t>::max();

/// One scan as the XML section describes it, not yet checked against its binary section.
struct E57Scan {
  std::size_t number = 1;  ///< number of the scan in the file, from 1
  std::uint64_t records = 0;
  std::uint64_t file_offset = 0;                 ///< physical position of the binary section
  std::vector<E57Field> fields;                  ///< one per bytestream, in their order
  std::array<std::uint32_t, kE57Places> places;  ///< indices into fields
  std::optional<Pose> pose;
  std::optional<Box> bounds;  ///< declared bounds of the Cartesian coordinates

  bool has(E57Place place) const { return places[place] != kNoE57Stream; }
  bool is_cartesian() const { return has(kE57X); }
  bool is_spherical() const { return has(kE57Range); }
  /// Whether the scan's packets need no bytes, because every field has only one value.
  bool takes_no_bytes() const {
    for (const E57Field& field : fields) {
      if (field.bits > 0) return false;
    }
    return true;
  }
  bool has_coordinates() const { return is_cartesian() || is_spherical(); }
  std::string name() const { return "scan " + std::to_string(number); }
};

struct E57Document {
  std::vector<E57Scan> scans;
  std::string crs;  ///< content of e57Root/coordinateMetadata
};

/// Parses the XML section. Throws InputError.
E57Document read_e57_document(E57Container& file);

}  // namespace clearway
