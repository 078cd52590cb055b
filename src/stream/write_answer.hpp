#pragma once

#include <cstdint>
#include <filesystem>

#include "core/answer.hpp"
#include "core/progress.hpp"
#include "io/result.hpp"
#include "io/store.hpp"

namespace clearway {

/// Writes the colliding points, and the clearances where the header asks for them, to a result file
/// at `path`, ascending by source index. Takes at most `memory_bytes`, but no less than
/// least_write_bytes(): where the rows exceed them, in several passes over the cells that have
/// some, each for the next range of source indices. Throws InputError for a damaged cell,
/// ResourceError for a full disk, Interrupted when the progress asks to stop.
void write_answer(const Store& store, const Answer& answer, const ResultHeader& header,
                  const std::filesystem::path& path, std::uint64_t memory_bytes,
                  Progress& progress);

/// The least memory in which write_answer works, bytes.
std::uint64_t least_write_bytes();

}  // namespace clearway
