#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/messages/message_table.hpp"
#include "io/files/table_file.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway {

class HeaderValues;

inline constexpr TableFileKind kStoreKind{"clearway store", 4, "a store", "clearway convert",
                                          "convert again"};

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

/// What the header of a store keeps (docs/design/store-format.md): all of the metadata but what is
/// a column, the origins, the cubes of withheld points and the path of a corridor. Reading throws
/// InputError for facts that contradict each other.
void keep_facts(HeaderValues& values, StoreMetadata& metadata);
void keep_facts(HeaderValues& values, StoreCorridor& near);

inline constexpr std::uint32_t kMostCellPoints = 1U << 20;

/// The packed columns of a store, of which it may lack the last two.
enum PointColumn : std::uint8_t { kX, kY, kZ, kSource, kBlocks, kClass, kOrigin };
inline constexpr std::size_t kPointColumns = 7;
inline constexpr const char* kPointColumnNames[kPointColumns] = {"x",   "y",     "z",     "source",
                                                                 "box", "class", "origin"};

/// The columns whose chunks have one index, and the group in which it lies.
struct ChunkGroup {
  const char* name;
  std::size_t first, columns;
};
inline constexpr std::array<ChunkGroup, 4> kChunkGroups{
    {{"cells", kX, 4}, {"blocks", kBlocks, 1}, {"classes", kClass, 1}, {"origins", kOrigin, 1}}};

/// Addresses in the file, sizes and hashes of packed chunks, cell by cell, and for each cell column
/// by column. Empty where a store lacks the columns.
struct ChunkIndex {
  std::vector<std::uint64_t> address;
  std::vector<std::uint32_t> bytes;
  std::vector<std::uint64_t> xxh64;
};

/// Bytes of the chunk of a cell's block boxes: one for each block of a full cell, and a checksum.
constexpr std::size_t block_chunk_bytes(std::uint32_t cell_points) {
  return divide_up(cell_points, kBlockPoints) * sizeof(BlockBox) + sizeof(std::uint32_t);
}

/// One packed chunk.
struct StoredChunk {
  std::uint64_t address;
  std::uint32_t bytes;
  std::uint64_t xxh64;
};

/// The index of each of kChunkGroups.
struct ChunkIndexes : std::array<ChunkIndex, 4> {
  StoredChunk of(std::size_t column, std::size_t cell) const {
    const std::size_t group = column < kBlocks ? 0 : column - kSource;
    const ChunkIndex& index = (*this)[group];
    const std::size_t i = cell * kChunkGroups[group].columns + column - kChunkGroups[group].first;
    return {index.address[i], index.bytes[i], index.xxh64[i]};
  }
};

template <>
struct NumbersOf<QuantumBox> {
  using Number = std::int32_t;
  static constexpr std::uint32_t kCount = 6;
};
template <>
struct NumbersOf<TopNode> {
  using Number = std::uint32_t;
  static constexpr std::uint32_t kCount = 3;
};

}  // namespace clearway
