#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "clearway/found_place.hpp"
#include "core/util/progress.hpp"
#include "io/merge/part_set.hpp"

namespace clearway {

struct MergedResult {
  std::uint64_t profile_poses = 0, inside_points = 0;
  std::optional<FoundPlace> first_place = {}, least_clearance = {}, least_profile = {};
};

/// Writes the result of all parts to `path`, a few rows of each part in memory. Every row is read
/// once, and checked against its part's hash. Throws InputError for damaged parts, and for a point
/// in two of them; ResourceError for a full disk or too little memory; Interrupted.
MergedResult merge_parts(const PartSet& set, const std::filesystem::path& path,
                         std::uint64_t memory_bytes, Progress& progress);

}  // namespace clearway
