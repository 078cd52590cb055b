#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "clearway/convert.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// The least memory that a conversion accepts, which holds one unit, the counting grid and the
/// buffers.
inline constexpr std::uint64_t kLeastConversionMemory = std::uint64_t{224} << 20;

struct ConversionOptions : ConvertOptions {
  std::vector<std::filesystem::path> inputs;  ///< files and folders, or "-" alone
  std::filesystem::path output;
  /// Called after each record of the journal; for tests.
  std::function<void()> journalled = nullptr;
};

/// The warnings of its conversion that a store keeps: at most 64, with texts of at most 1,000
/// bytes; if there were more, those that put answers in doubt come first, and the last one says how
/// many there were.
std::vector<Message> kept_warnings(const std::vector<Message>& warnings);

struct ConversionReport : ConvertReport {
  StoreMetadata metadata;
};

/// Converts scans into a store (docs/design/conversion.md). Throws UsageError, InputError,
/// ResourceError, and Interrupted when the progress asks to stop. Whatever happens, no incomplete
/// file ever has the output's name.
ConversionReport convert_scans(const ConversionOptions& options, Progress& progress);

/// Whether the output exists and is the store of these inputs, by names and contents, with these
/// options; all of it is verified. Always false for a stream. Throws UsageError where that store is
/// damaged, ResourceError where an input is missing, and Interrupted.
bool is_converted(const ConversionOptions& options, Progress& progress);

}  // namespace clearway
