#include "campaign/question.hpp"

#include <algorithm>
#include <optional>
#include <system_error>

#include "clearway/error.hpp"
#include "core/query/query_fields.hpp"
#include "io/journal/journal.hpp"
#include "io/system/xxh64.hpp"

namespace clearway::campaign {
namespace {

nlohmann::ordered_json ignored_of(const ResultHeader& header) {
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (const Box& box : header.ignore_boxes) {
    boxes.push_back({box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  nlohmann::ordered_json ignored{{"classes", header.ignore_classes}, {"boxes", boxes}};
  if (!header.ignore_classes.empty()) ignored["classes_hash"] = hash_text(header.classes_hash);
  return ignored;
}

/// The question that a complete result or part answers; nothing where there is no such file.
std::optional<nlohmann::ordered_json> question_in(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) return std::nullopt;
  try {
    return question_of(ResultReader(file, Parts::kAccepted).header());
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void ask_for_part(const Shard& shard, const std::string& store, nlohmann::ordered_json& question) {
  question["shard"] = to_string(shard);
  question["store"] = store;
}

nlohmann::ordered_json question_of(const ResultHeader& header) {
  nlohmann::ordered_json question;
  for_each_value_field([&](const auto& field) { question[field.name] = field.of(header); });
  question.update({{"single_precision", header.float_precision},
                   {"environment_points", header.environment_points},
                   {"environment_hash", hash_text(header.environment_hash)},
                   {"model_points", header.model_points},
                   {"model_hash", hash_text(header.model_hash)},
                   {"poses", header.poses},
                   {"trajectory_hash", hash_text(header.trajectory_hash)}});
  if (header.ignores_points()) question["ignored"] = ignored_of(header);
  if (header.model_triangles > 0) question["model_triangles"] = header.model_triangles;
  if (header.part) ask_for_part(header.part->shard, hash_text(header.part->store), question);
  return question;
}

bool answers(const std::filesystem::path& file, const nlohmann::ordered_json& question) {
  return question_in(file) == question;
}

bool answers_another(const std::filesystem::path& file, const nlohmann::ordered_json& question) {
  const auto found = question_in(file);
  return found && *found != question;
}

bool is_journal_of_others(const std::filesystem::path& file,
                          const nlohmann::ordered_json& question) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) return false;
  try {
    const JournalReader journal(file);
    if (!journal.identity()) return false;
    return std::ranges::any_of(*journal.identity(), [&](const auto& field) {
      const auto& [name, value] = field;
      return (name == "model" && question["model_hash"] != value) ||
             (name == "trajectory" && question["trajectory_hash"] != value);
    });
  } catch (const Error&) {
    return false;  // the run reports what is wrong with it
  }
}

}  // namespace clearway::campaign
