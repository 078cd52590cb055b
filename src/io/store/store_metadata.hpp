#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/files/xxh64.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway {

/// The ASPRS name of a class of points (LAS 1.4, point formats 6 to 10); "" for reserved and
/// user-defined classes.
constexpr const char* class_name(std::uint8_t value) {
  constexpr std::array kNames{"never classified",
                              "unclassified",
                              "ground",
                              "low vegetation",
                              "medium vegetation",
                              "high vegetation",
                              "building",
                              "low point (noise)",
                              "",
                              "water",
                              "rail",
                              "road surface",
                              "",
                              "wire, guard",
                              "wire, conductor",
                              "transmission tower",
                              "wire connector",
                              "bridge deck",
                              "high noise"};
  return value < kNames.size() ? kNames[value] : "";
}

inline constexpr std::uint32_t kStoreVersion = 2;

/// An input file of a conversion, as recorded in the store.
struct SourceFile {
  std::string name;  ///< base name; "-" for standard input
  std::uint64_t bytes = 0;
  std::uint64_t xxh64 = 0;
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
  /// XXH64 of what was given beside the scans (a file of origins, or a path); 0 where the scans
  /// have their origins themselves.
  std::uint64_t given_hash = 0;
  friend bool operator==(const StoreOrigins&, const StoreOrigins&) = default;
};

/// The description of a store (docs/design/store-format.md), without its cells.
struct StoreMetadata {
  std::uint64_t point_count = 0;
  /// Points of the inputs, including non-finite ones, which are not stored.
  std::uint64_t input_points = 0;
  std::uint32_t cell_points = 0;
  Quantisation quantisation{};
  std::string layout;  ///< "adaptive" or "regular:SIZE"
  LengthUnit unit = LengthUnit::kUnknown;
  std::string crs_wkt;
  std::uint64_t points_hash = 0;
  std::vector<SourceFile> sources;
  /// Number of points of each source file; 0 for files of poses. Empty for a single scan, and in
  /// stores of 0.1.0.
  std::vector<std::uint64_t> source_points = {};
  std::optional<StoreClasses> classes = {};  ///< only where some point has a class above 0
  std::optional<StoreOrigins> origins = {};  ///< only where some point has an origin
  ScanDates dates = {};                      ///< days on which the sources were made
  std::vector<Message> warnings = {};        ///< warnings of the conversion, for users of the store

  /// Number of points of a source file, by its index in `sources`; nullopt where it is not known.
  std::optional<std::uint64_t> points_of_source(std::size_t source) const {
    if (!source_points.empty()) return source_points[source];
    return sources.size() == 1 ? std::optional(input_points) : std::nullopt;
  }
};

/// Prefix of the codes of a store's warnings where another command repeats them.
inline constexpr std::string_view kStorePrefix = "store-";

/// The warnings of the conversion in the form in which other commands repeat them.
inline std::vector<Message> store_warnings(const StoreMetadata& metadata) {
  std::vector<Message> warnings = metadata.warnings;
  for (Message& warning : warnings) warning.code.insert(0, kStorePrefix);
  return warnings;
}

}  // namespace clearway

/// Names and tables that the store's writer and reader share (docs/design/store-format.md).
namespace clearway {

inline const std::string kStoreFormat = "clearway store";
inline constexpr std::uint32_t kMostCellPoints = 1U << 20;
inline constexpr const char* kPointDatasets[4] = {"x", "y", "z", "source"};

/// Dataset of /sources; only where there are several files.
inline constexpr const char* kSourcePoints = "points";

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
