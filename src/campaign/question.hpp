#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "io/result/result.hpp"

namespace clearway::campaign {

/// What tells the questions of results apart: parameters, sizes and hashes of the inputs, and of a
/// part which one it is, of which store.
nlohmann::ordered_json question_of(const ResultHeader& header);

/// Makes the question of a result that of one of its parts. store: its fingerprint as text. Parts
/// of two stores of the same points do not fit together.
void ask_for_part(const Shard& shard, const std::string& store, nlohmann::ordered_json& question);

/// Whether the file is a complete result of that question. Its rows are not read.
bool answers(const std::filesystem::path& file, const nlohmann::ordered_json& question);

/// Whether the file is a complete result, but of another question.
bool answers_another(const std::filesystem::path& file, const nlohmann::ordered_json& question);

/// Whether the file is the journal of a run of another model or trajectory.
bool is_journal_of_others(const std::filesystem::path& file,
                          const nlohmann::ordered_json& question);

}  // namespace clearway::campaign
