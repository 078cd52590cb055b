#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Re-reads a result and checks it: rows intact, source indices ascending and below the number of
/// environment points, coordinates finite and on the result's scale, poses below their number,
/// distances within what was asked for, chainages ascending. Returns the first fault, or nullopt.
std::optional<std::string> verify_result(const ResultReader& result, Progress& progress);

/// Whether the file, which exists, is an intact result, or part of one, with this header.
bool is_intact_result(const std::filesystem::path& file, const ResultHeader& header,
                      Progress& progress);

}  // namespace clearway
