#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/result/result.hpp"

namespace clearway::campaign {

/// What tells the questions of results apart: parameters, sizes and hashes of the inputs, and of a
/// part which one it is.
nlohmann::ordered_json question_of(const ResultHeader& header);

/// Whether the file is a complete result of that question. Its rows are not read.
bool answers(const std::filesystem::path& file, const nlohmann::ordered_json& question);

}  // namespace clearway::campaign
