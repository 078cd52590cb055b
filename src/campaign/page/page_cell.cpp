#include "campaign/page/page_cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/util/format.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

/// A path as the text of a link, in which every byte that is not plain becomes %XX.
std::string link_text(const std::string& path) {
  constexpr std::string_view kPlain = "/-._~", kDigits = "0123456789ABCDEF";
  std::string link;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || kPlain.find(c) != std::string_view::npos) {
      link += c;
    } else {
      link += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return link;
}

}  // namespace

std::string cell_word(const TaskLook& look) {
  const Outcome outcome = outcome_of(look);
  switch (outcome) {
    case Outcome::kDoubtful:
      return "clear?";
    case Outcome::kFailed:
      return "failed (" + std::to_string(look.state->exit_code) + ")";
    case Outcome::kUnfinished:
      return name_of(look.status);
    default:
      return words_of(outcome).word;
  }
}

std::string cell_distance(const Task& task, const TaskLook& look) {
  const Outcome outcome = outcome_of(look);
  if (look.status != TaskStatus::kDone || outcome == Outcome::kUndecided) return "";
  const ordered_json& facts = look.state->facts;
  const ordered_json& least = facts["least"];
  if (!least.is_null()) {
    const auto distance = least["distance"].get<double>();
    const std::string length = format_brief(std::abs(distance)) + " " + task.unit;
    return length.starts_with("0 ") || distance >= 0 ? length : length + " deep inside";
  }
  const auto radius = task.question["radius"].get<double>();
  const double asked = std::max(
      {radius, task.question["clearance"].get<double>(), task.question["profile"].get<double>()});
  return (outcome != Outcome::kConflict ? "≥ " + format_number(asked)
                                        : "< " + format_number(radius)) +
         " " + task.unit;
}

std::string cell_details(const Task& task, const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) {
    return (look.shard > 0 ? "shard " + std::to_string(look.shard) + ": " : "") + "exit code " +
           std::to_string(look.state->exit_code) + ": " + look.state->message;
  }
  if (look.status == TaskStatus::kOutdated) {
    return std::string(name_of(look.status)) + ": " + look.changed;
  }
  if (look.status != TaskStatus::kDone) return name_of(look.status);
  const ordered_json& facts = look.state->facts;
  std::string text = words_of(outcome_of(look)).word;
  const std::string distance = cell_distance(task, look), caveats = caveats_of(facts);
  if (!distance.empty()) text += ", least distance " + distance;
  const auto points = facts["colliding_points"].get<std::uint64_t>();
  if (points > 0) {
    text += ", " + counted(points, "colliding point");
  }
  return text + (caveats.empty() ? "" : "; " + caveats);
}

std::string cell_link(const Task& task, const TaskLook& look) {
  const std::string folder = task.folder().string() + "/";
  if (look.status == TaskStatus::kFailed) {
    const std::string of = look.shard > 0 ? "shards/" + std::to_string(look.shard) + "/" : "";
    return link_text(folder + of + "log.txt");
  }
  if (look.status != TaskStatus::kDone) return "";
  const bool report = std::ranges::find(task.outputs, kReportName) != task.outputs.end();
  return link_text(folder + (report ? kReportName : "run.json"));
}

}  // namespace clearway::campaign
