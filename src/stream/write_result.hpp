#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "clearway/found_place.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// What went into a result: its rows, and of each table the place that matters most (of several the
/// smallest source, in the profile the first pose), where it has one.
struct WrittenResult {
  std::uint64_t collisions = 0, clearances = 0;
  std::uint64_t inside_points = 0;        ///< of the clearances those below 0
  std::optional<FoundPlace> first_place;  ///< with first poses only
  std::optional<FoundPlace> least_clearance, least_profile;
};

/// Writes the colliding points, and the clearances where the header asks for them, to a result file
/// at `path`, ascending by source index; then the profile where the header asks for it. chainage:
/// of every pose then, metres. Takes at most `memory_bytes`, but no less than
/// least_write_bytes(): where the rows exceed them, in several passes over the cells that have
/// some, each for the next range of source indices. threads: 0 for all cores. Throws InputError for
/// a damaged cell, ResourceError for a full disk, Interrupted when the progress asks to stop.
WrittenResult write_result(const StoreReader& store, const SearchResult& answer,
                           const ResultHeader& header, const std::filesystem::path& path,
                           std::uint64_t memory_bytes, Progress& progress,
                           std::span<const double> chainage = {}, int threads = 0,
                           const ResultFindings& findings = {});

/// The least memory in which write_result works, bytes.
std::uint64_t least_write_bytes(const StoreReader& store);

}  // namespace clearway
