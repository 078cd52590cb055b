#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/progress.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/formats/length_unit.hpp"

namespace clearway {

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
