#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/messages/message_table.hpp"
#include "io/files/xxh64.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway {

inline constexpr std::uint32_t kStoreVersion = 2;

/// An input file of a conversion, as recorded in the store.
struct SourceFile {
  std::string name;  ///< base name; "-" for standard input
  std::uint64_t bytes = 0;
  std::uint64_t xxh64 = 0;

  template <typename Values>
  void keep(Values& values) {
    values.add(name, bytes, xxh64);
  }
  friend bool operator==(const SourceFile&, const SourceFile&) = default;
};

/// The classes of all points of a store.
struct StoreClasses {
  std::uint64_t hash = 0;  ///< XXH64 of the classes of all points, one byte each, in source order
  std::array<std::uint64_t, 256> points{};  ///< number of points of each class
  friend bool operator==(const StoreClasses&, const StoreClasses&) = default;
};

/// What the origins of some points rest on, such as "poses of E57", and the number of these points.
struct OriginBasis {
  std::string what;
  std::uint64_t points = 0;

  template <typename Values>
  void keep(Values& values) {
    values.add(what, points);
  }
  friend bool operator==(const OriginBasis&, const OriginBasis&) = default;
};

/// The places of the scanners from which the points of a store were seen.
struct StoreOrigins {
  /// The distinct origins, ascending lexicographically, in the integers of the store: an origin o
  /// is llround((o - offset) / scale), which may lie beyond 32 bits.
  std::vector<std::array<std::int64_t, 3>> quanta;
  std::uint64_t points_without = 0;  ///< number of points whose input has no origin
  /// XXH64 of the origins and of the ranges of source indices that each of them has.
  std::uint64_t hash = 0;
  std::vector<OriginBasis> rest_on = {};
  friend bool operator==(const StoreOrigins&, const StoreOrigins&) = default;
};

/// The index of a cube of 1 m along x, y and z: floor(coordinate / edge), where the edge is 1 m in
/// the unit of the coordinates. What lies beyond 32 bits counts to the outermost cubes.
using MetreCube = std::array<std::int32_t, 3>;

/// The edge of a MetreCube in this unit; 1 where the unit is not known or no length.
inline double metre_cube_edge(LengthUnit unit) {
  const double metres = metres_of(unit);
  return metres > 0 ? 1 / metres : 1;
}

/// The points of the inputs that have the flag `withheld`.
struct StoreWithheld {
  std::uint64_t points = 0;
  bool kept = false;  ///< whether they are among the points of the store
  /// The cubes in which those lie that were left out, ascending lexicographically.
  std::vector<MetreCube> cubes = {};

  std::uint64_t left_out() const { return kept ? 0 : points; }
  friend bool operator==(const StoreWithheld&, const StoreWithheld&) = default;
};

/// The corridor that a store was made of, where points farther from a path were left out.
struct StoreCorridor {
  std::vector<Vec3> path;  ///< positions, in the unit of the coordinates
  double within = 0;       ///< the greatest distance of a stored point from the path
  /// A box around all points of the inputs, those left out included. Where a part was not read, the
  /// bounds that the input declares of it count instead.
  Box whole{};
  std::uint64_t left_out = 0;  ///< points of the inputs that are not stored because they lie beyond
  /// How many of left_out were not even read: those of nodes of COPC and of passed-over files
  std::uint64_t unread = 0;
  std::uint64_t unread_bytes = 0;  ///< bytes of the inputs that were not read
  std::uint64_t passed_over = 0;   ///< files passed over by their declared bounds
  friend bool operator==(const StoreCorridor&, const StoreCorridor&) = default;
};

/// The description of a store (docs/design/store-format.md), without its cells.
struct StoreMetadata {
  std::uint64_t point_count = 0;
  /// Points of the inputs, including non-finite and withheld ones, which are not stored.
  std::uint64_t input_points = 0;
  std::uint32_t cell_points = 0;
  Quantisation quantisation{};
  /// The coarsest step to which an input rounded its coordinates, of each axis and in the unit of
  /// the coordinates; 0 where an axis has few values, and where inputs are regular rasters
  std::array<double, 3> steps{};
  std::string layout;  ///< "adaptive" or "regular:SIZE"
  /// The options of the conversion that shape a store, a line each, such as "scale: none"; files
  /// by a hash of their contents. A conversion with other options would make another store.
  std::string options = {};
  LengthUnit unit = LengthUnit::kUnknown;
  std::string crs_wkt;
  /// Metres per unit of the inputs' heights, where they were converted from a given unit; otherwise
  /// 0.
  double height_unit = 0;
  std::uint64_t points_hash = 0;
  std::vector<SourceFile> sources;
  /// Number of points of each source file; 0 for files of poses. Empty for a single scan.
  std::vector<std::uint64_t> source_points = {};
  std::optional<StoreClasses> classes = {};  ///< only where some point has a class above 0
  std::optional<StoreOrigins> origins = {};  ///< only where some point has an origin
  /// Only where some point of the inputs has the flag `withheld`
  std::optional<StoreWithheld> withheld = {};
  std::optional<StoreCorridor> near = {};  ///< only where points far from a path were left out
  ScanDates dates = {};                    ///< days on which the sources were made
  std::vector<Message> warnings = {};      ///< warnings of the conversion, for users of the store

  /// Points of the inputs that are not stored because they hold no finite place.
  std::uint64_t points_without_place() const {
    return input_points - point_count - (withheld ? withheld->left_out() : 0) -
           (near ? near->left_out : 0);
  }

  /// Number of points of a source file, by its index in `sources`; nullopt where it is not known.
  std::optional<std::uint64_t> points_of_source(std::size_t source) const {
    if (!source_points.empty()) return source_points[source];
    return sources.size() == 1 ? std::optional(input_points) : std::nullopt;
  }
};

/// The warnings of the conversion in the form in which other commands repeat them.
inline std::vector<Message> store_warnings(const StoreMetadata& metadata) {
  std::vector<Message> warnings = metadata.warnings;
  for (Message& warning : warnings) warning.code.insert(0, kStorePrefix);
  return warnings;
}

// Names and tables that the store's writer and reader share (docs/design/store-format.md).

inline const std::string kStoreFormat = "clearway store";
inline constexpr std::uint32_t kMostCellPoints = 1U << 20;
inline constexpr const char* kPointDatasets[4] = {"x", "y", "z", "source"};

/// Attribute of a store whose heights were converted: StoreMetadata::height_unit.
inline constexpr const char* kHeightUnit = "height_unit";

/// Dataset of /sources; only where there are several files.
inline constexpr const char* kSourcePoints = "points";

/// Attributes and dataset of withheld points; only where the inputs have some. The dataset is
/// missing where the points were kept.
inline constexpr const char* kWithheldPoints = "withheld_points";
inline constexpr const char* kWithheldHash = "withheld_hash";
inline constexpr const char* kWithheld = "withheld";

/// Group and attributes of a corridor; only where points far from a path were left out.
inline constexpr const char* kNearGroup = "near";
inline constexpr const char* kNearPath = "path";
inline constexpr const char* kNearWithin = "near_within";
inline constexpr const char* kNearWhole = "near_whole";
inline constexpr const char* kNearCounts = "near_counts";
inline constexpr const char* kNearHash = "near_hash";

inline std::span<const double> numbers_of(const std::vector<Vec3>& places) {
  return {places.empty() ? nullptr : &places.front().x, 3 * places.size()};
}

/// The hash of what a store says of its corridor.
inline std::uint64_t hash_of(const StoreCorridor& corridor) {
  ColumnHashes hashes;
  hashes.add(numbers_of(corridor.path));
  hashes.add(std::array{corridor.within, corridor.whole.lo.x, corridor.whole.lo.y,
                        corridor.whole.lo.z, corridor.whole.hi.x, corridor.whole.hi.y,
                        corridor.whole.hi.z});
  hashes.add(
      std::array{corridor.left_out, corridor.unread, corridor.unread_bytes, corridor.passed_over});
  return hashes.digest();
}

inline std::span<const std::int32_t> coordinates_of(const std::vector<MetreCube>& cubes) {
  return {cubes.empty() ? nullptr : cubes.front().data(), 3 * cubes.size()};
}

/// The datasets of /cells, row-major. Each cell has four chunks: x, y, z, source.
struct CellIndex {
  std::vector<std::uint32_t> count;    // [cells]
  std::vector<std::int32_t> box;       // [cells, 6]
  std::vector<std::uint64_t> address;  // [cells, 4]
  std::vector<std::uint32_t> bytes;    // [cells, 4]
  std::vector<std::uint64_t> xxh64;    // [cells, 4]
};

inline void add_index(const CellIndex& index, ColumnHashes& hashes) {
  hashes.add(index.count);
  hashes.add(index.box);
  hashes.add(index.address);
  hashes.add(index.bytes);
  hashes.add(index.xxh64);
}

}  // namespace clearway
