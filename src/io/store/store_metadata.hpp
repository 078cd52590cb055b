#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/formats/length_unit.hpp"

namespace clearway {

inline constexpr std::uint32_t kStoreVersion = 2;

/// One input file of a conversion, as the store remembers it.
struct SourceFile {
  std::string name;  ///< base name; "-" for standard input
  std::uint64_t bytes = 0;
  std::uint64_t xxh64 = 0;
  friend bool operator==(const SourceFile&, const SourceFile&) = default;
};

/// What a store says of itself besides its cells (docs/design/store-format.md).
struct StoreMetadata {
  std::uint64_t point_count = 0;
  std::uint64_t input_points = 0;  ///< with the non-finite ones, which are not stored
  std::uint32_t cell_points = 0;
  Quantisation quantisation{};
  std::string layout;  ///< "adaptive" or "regular:SIZE"
  LengthUnit unit = LengthUnit::kUnknown;
  std::string crs_wkt;
  std::uint64_t points_hash = 0;
  std::vector<SourceFile> sources;
};

}  // namespace clearway
