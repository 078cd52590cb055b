#pragma once

#include <cstdint>
#include <filesystem>

#include "clearway/answer.hpp"
#include "core/util/progress.hpp"
#include "io/merge/part_set.hpp"

namespace clearway {

/// Writes the result of all parts to `path`, with a few rows of each part in memory, and sets
/// `summary` to what its tables say in short. Every row is read once and checked
/// against its part's hash. Throws InputError for damaged parts and for a point that is in two of
/// them, ResourceError for a full disk or too little memory, and Interrupted.
void merge_parts(const PartSet& set, const std::filesystem::path& path, std::uint64_t memory_bytes,
                 Progress& progress, TableSummary& summary);

}  // namespace clearway
