#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "io/result/result.hpp"

namespace clearway::campaign {

/// What distinguishes the questions that results answer: parameters, and sizes and hashes of the
/// inputs; for a part also which part it is, and of which store.
nlohmann::ordered_json question_of(const ResultHeader& header);

/// Turns the question of a result into that of one of its parts. store: the fingerprint as text,
/// because parts of two stores of the same points do not fit together.
void ask_for_part(const Shard& shard, const std::string& store, nlohmann::ordered_json& question);

/// Whether the file is a complete result or part that answers this question. Its rows are not read.
bool answers(const std::filesystem::path& file, const nlohmann::ordered_json& question);

/// Whether the file is a complete result or part that answers another question.
bool answers_another(const std::filesystem::path& file, const nlohmann::ordered_json& question);

/// Whether the file is the journal of a run with another model or trajectory.
bool is_journal_of_others(const std::filesystem::path& file,
                          const nlohmann::ordered_json& question);

}  // namespace clearway::campaign
