#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "clearway/convert.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// The least memory that a conversion accepts: one unit, the counting grid and the buffers.
inline constexpr std::uint64_t kLeastConversionMemory = std::uint64_t{224} << 20;

struct ConversionOptions : ConvertOptions {
  std::vector<std::filesystem::path> inputs;  ///< files and folders, or "-" alone
  std::filesystem::path output;
};

/// What a store keeps of the warnings of its conversion: at most 64, with texts of at most 1,000
/// bytes, where the last one says how many more there were. Without "feet", which its unit says.
std::vector<Message> kept_warnings(const std::vector<Message>& warnings);

struct ConversionReport : ConvertReport {
  StoreMetadata metadata;
};

/// Turns scans into a store (docs/design/conversion.md). Throws UsageError, InputError,
/// ResourceError; Interrupted when the progress asks to stop; whatever happens, nothing stands
/// under the output's name that is not complete.
ConversionReport convert_scans(const ConversionOptions& options, Progress& progress);

/// Whether the output is there already and is the store of these inputs, by names and contents,
/// with these options; all of it is verified. Never of a stream. Throws UsageError where that store
/// is damaged; ResourceError where an input is missing; Interrupted.
bool is_converted(const ConversionOptions& options, Progress& progress);

}  // namespace clearway
