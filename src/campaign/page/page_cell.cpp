#include "campaign/page/page_cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/util/format.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

/// A path of a link: what is no plain letter becomes %XX.
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

std::string warnings_text(const ordered_json& facts) {
  std::string text;
  for (const auto& code : facts["warnings"]) {
    text += (text.empty() ? "; warned of " : ", ") + code.get<std::string>();
  }
  return text;
}

}  // namespace

const CellLook& look_of(CellKind kind) {
  static constexpr std::array<CellLook, 5> kLooks{
      {{"conflict", "■", "conflict: a point is closer than the radius"},
       {"doubtful", "△", "clear, but something was warned of: read the report"},
       {"clear", "○", "clear: no point is closer than the radius"},
       {"failed", "✕", "failed: nothing is known"},
       {"not_done", "…", "not done yet: nothing is known"}}};
  return kLooks.at(static_cast<std::size_t>(kind));
}

CellKind kind_of(const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) return CellKind::kFailed;
  if (look.status != TaskStatus::kDone) return CellKind::kUnfinished;
  const ordered_json& facts = look.state->facts;
  if (facts["verdict"] != "clear") return CellKind::kConflict;
  return facts["warnings"].empty() ? CellKind::kClear : CellKind::kDoubtful;
}

std::string cell_word(const TaskLook& look) {
  switch (kind_of(look)) {
    case CellKind::kConflict:
      return "conflict";
    case CellKind::kDoubtful:
      return "clear?";
    case CellKind::kClear:
      return "clear";
    case CellKind::kFailed:
      return "failed (" + std::to_string(look.state->exit_code) + ")";
    default:
      return name_of(look.status);
  }
}

std::string cell_distance(const Task& task, const TaskLook& look) {
  if (look.status != TaskStatus::kDone) return "";
  const ordered_json& facts = look.state->facts;
  const ordered_json& least = facts["least"];
  if (!least.is_null()) {
    const auto distance = least["distance"].get<double>();
    const std::string length = format_brief(std::abs(distance)) + " " + task.unit;
    return distance < 0 ? length + " deep inside" : length;
  }
  const auto radius = task.question["radius"].get<double>();
  const double asked = std::max(
      {radius, task.question["clearance"].get<double>(), task.question["profile"].get<double>()});
  const bool clear = facts["verdict"] == "clear";
  return (clear ? "≥ " + format_number(asked) : "< " + format_number(radius)) + " " + task.unit;
}

std::string cell_details(const Task& task, const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) {
    return (look.shard > 0 ? "shard " + std::to_string(look.shard) + ": " : "") + "exit code " +
           std::to_string(look.state->exit_code) + ": " + look.state->message;
  }
  if (look.status != TaskStatus::kDone) return name_of(look.status);
  const ordered_json& facts = look.state->facts;
  std::string text =
      facts["verdict"].get<std::string>() + ", least distance " + cell_distance(task, look);
  const auto points = facts["colliding_points"].get<std::uint64_t>();
  if (points > 0) {
    text += ", " + format_count(points) + (points == 1 ? " colliding point" : " colliding points");
  }
  return text + warnings_text(facts);
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
