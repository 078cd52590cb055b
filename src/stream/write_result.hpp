#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "clearway/answer.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Writes a result file at `path`, and returns what its tables say in short: the colliding points,
/// and the clearances if the header asks for them, ascending by source index; then the profile if
/// the header asks for it. chainage: that of every pose, metres, for a profile. Takes at most
/// `memory_bytes`, but no less than least_write_bytes(): if the rows exceed them, it makes several
/// passes over the cells that have any, each for the next range of source indices. threads: 0 for
/// all cores. Throws InputError for a damaged cell, ResourceError for a full disk, Interrupted when
/// the progress asks to stop.
TableSummary write_result(const StoreReader& store, const SearchResult& answer,
                          const ResultHeader& header, const std::filesystem::path& path,
                          std::uint64_t memory_bytes, Progress& progress,
                          std::span<const double> chainage = {}, int threads = 0,
                          const ResultFindings& findings = {});

/// The least memory in which write_result() works, bytes.
std::uint64_t least_write_bytes(const StoreReader& store);

}  // namespace clearway
