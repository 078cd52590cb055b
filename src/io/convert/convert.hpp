#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// The least --memory that a conversion accepts: one unit, the counting grid and the buffers.
inline constexpr std::uint64_t kLeastConversionMemory = std::uint64_t{224} << 20;

struct ConversionOptions {
  std::vector<std::filesystem::path> inputs;  ///< files and folders, or "-" alone
  std::filesystem::path output;
  std::optional<double> scale;         ///< metres
  std::uint32_t cell_points = 65536;   ///< 64 to 2^20
  std::optional<double> regular_size;  ///< metres: the regular layout's cubes; none: adaptive
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  bool ignore_crs = false;
  bool strict = false;
  bool overwrite = false;
};

struct ConversionReport {
  StoreMetadata metadata;
  std::uint64_t cells = 0;
  std::uint64_t non_finite_points = 0;
  double largest_change = 0;  ///< of any coordinate by rounding to the scale, metres
  std::uint64_t temporary_bytes = 0;
  std::uint64_t output_bytes = 0;
  double count_seconds = 0, distribute_seconds = 0, partition_seconds = 0, confirm_seconds = 0;
  std::vector<std::string> remarks;
};

/// Turns scans into a store (docs/design/conversion.md). Throws UsageError, InputError,
/// ResourceError; Interrupted when the progress asks to stop; whatever happens, nothing stands
/// under the output's name that is not complete.
ConversionReport convert(const ConversionOptions& options, Progress& progress);

/// Whether the output is there already and is the store of these inputs, by names and contents,
/// with these options; all of it is verified. Never of a stream. Throws UsageError where that store
/// is damaged; ResourceError where an input is missing; Interrupted.
bool is_converted(const ConversionOptions& options, Progress& progress);

}  // namespace clearway
