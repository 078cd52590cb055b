#include "cli/verdict.hpp"

#include <fmt/format.h>

#include "cli/support/console.hpp"
#include "cli/support/ignored_options.hpp"
#include "core/describe/labels.hpp"
#include "core/describe/seen.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "io/files/facts_json.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/floor_facts.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json place_json(const Answer& answer, const std::optional<FoundPlace>& place,
                        const PathWords& path, bool distance) {
  if (!place) return nullptr;
  ordered_json out;
  if (distance) out["distance"] = place->distance;
  out["pose"] = place->pose;
  out["source"] = place->source;
  out["chainage"] = nullptr;
  if (!path.chainage.empty()) out["chainage"] = path.chainage[place->pose];
  const char* const axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    out[axes[k]] = has_xyz(*place) ? ordered_json(place->xyz[k]) : ordered_json(nullptr);
  }
  if (const std::string body = body_of(answer, place); !body.empty()) out["body"] = body;
  if (place->point_class) out["class"] = *place->point_class;
  for_each_label([&](const auto& label) {
    const auto& values = label.of(path.labels);
    if (!values.empty()) out[label.key] = values[place->pose];
  });
  return out;
}

/// The greatest depth and its point, null where no point of the environment is free; null as a
/// whole where depths were not asked for.
ordered_json depth_json(const Answer& answer) {
  if (!answer.parameters.depth) return nullptr;
  ordered_json out{{"greatest", nullptr}, {"source", nullptr}, {"depth_source", nullptr}};
  if (!answer.deepest) return out;
  const DeepestPoint& deepest = *answer.deepest;
  return {{"greatest", deepest.depth},
          {"source", deepest.source},
          {"depth_source", deepest.depth_source},
          {"x", deepest.xyz.x},
          {"y", deepest.xyz.y},
          {"z", deepest.xyz.z}};
}

}  // namespace

ordered_json margins_json(const Answer& answer) {
  if (!answer.budget) return nullptr;
  return members_json<&ErrorBudget::clear, &ErrorBudget::conflict>(*answer.budget);
}

ordered_json seen_json(const Answer& answer) {
  if (!answer.seen) return nullptr;
  ordered_json out;
  for_each_field(kSeenColumns, [&](const auto& column) {
    if (column.use.is_in_files) out[column.key] = column.of(*answer.seen);
  });
  return out;
}

ordered_json budget_json(const ErrorBudget& budget) {
  using Budget = ErrorBudget;
  return members_json<&Budget::scan, &Budget::registration, &Budget::pose, &Budget::angle,
                      &Budget::lever, &Budget::model, &Budget::sigmas, &Budget::step,
                      &Budget::motion, &Budget::chord, &Budget::spacing, &Budget::hard,
                      &Budget::way>(budget);
}

std::string found_text(std::uint64_t colliding_points, std::uint64_t environment_points) {
  return fmt::format("{} of {} {}", format_count(colliding_points),
                     counted(environment_points, "environment point"),
                     colliding_points == 1 ? "collides" : "collide");
}

std::string caveat_of(std::size_t warnings) {
  if (warnings == 0) return "";
  return "; see the " + (warnings == 1 ? "warning" : std::to_string(warnings) + " warnings") +
         " above";
}

std::string verdict_to_repeat(const ResultReader& result, const PathWords& path,
                              const std::string& unit) {
  const ResultHeader& header = result.header();
  if (result.collisions() > 0 && !header.ignores_points() && !header.budget) return "";
  const Answer answer = answer_of(result);
  const std::vector<std::string> codes = answer.warned_of();
  return verdict_text(answer, path, unit,
                      codes.empty() ? "" : "; its run warned of " + with_commas(codes));
}

void repeat_warnings(const ResultReader& result, const std::string& prefix) {
  const Answer answer = counted_answer(result);
  for (Message warning : answer.warnings) {
    warning.text = prefix + warning.text;
    log_message(warning);
  }
  const auto warn_of_result = [&](const std::string& text) {
    Message warning;
    warning.severity = Message::Severity::kWarning;
    warning.text = result.name() + ": " + text;
    log_message(warning);
  };
  const std::vector<std::string> doubts = answer.doubts();
  if (answer.verdict() == Verdict::kConflict && !doubts.empty()) {
    warn_of_result(fmt::format("its run warned of {}, so more may collide than it found",
                               fmt::join(doubts, ", ")));
  }
  if (answer.verdict() != Verdict::kUndecided) return;
  if (doubts.empty()) {
    std::vector<std::string> reasons;
    for (const Reason reason : answer.reasons()) reasons.emplace_back(name_of(reason));
    warn_of_result(fmt::format("its verdict is undecided ({})", fmt::join(reasons, ", ")));
    return;
  }
  warn_of_result("its verdict is undecided, because " + doubt_words(doubts));
}

void add_searched(const SearchedLength& searched, ordered_json& out) {
  out["path_length"] = searched.path;
  out["searched_length"] = searched.whole;
  out["partly_searched_length"] = searched.part;
}

void add_inside(const Answer& answer, ordered_json& out) {
  out["points_inside"] = or_null(answer.points_inside());
  out["greatest_depth"] = or_null(answer.greatest_depth());
}

void add_answer(const Answer& answer, const PathWords& path, ordered_json& out) {
  out["poses"] = answer.poses;
  out["colliding_points"] = answer.colliding_points;
  if (!answer.classes.empty()) out["classes"] = clearway::json_of(answer.classes);
  out["clearance_points"] = answer.clearance_points;
  out["profile_poses"] = answer.profile_poses;
  out["verdict"] = name_of(answer.verdict());
  out["reasons"] = json_of_fact(answer.reasons());
  out["doubts"] = answer.doubts();
  out["margins"] = margins_json(answer);
  if (answer.budget) {
    out["near_points"] = answer.near_points;
    out["certain_points"] = answer.certain.points;
  }
  out["seen"] = seen_json(answer);
  out["model_spacing"] = nullptr;
  if (answer.model_spacing > 0) out["model_spacing"] = answer.model_spacing;
  out["ignored"] = ignored_json(answer);
  out["floor"] = floor_json(answer);
  out["path_length"] = out["searched_length"] = out["partly_searched_length"] = nullptr;
  if (answer.searched) add_searched(*answer.searched, out);
  out["shard"] = answer.shard ? ordered_json(to_string(*answer.shard)) : ordered_json(nullptr);
  add_inside(answer, out);
  out["least_clearance"] = place_json(answer, answer.least_clearance, path, true);
  out["least_profile"] = place_json(answer, answer.least_profile, path, true);
  out["first_place"] = place_json(answer, answer.first_place, path, false);
  out["depth"] = depth_json(answer);
}

}  // namespace clearway::tool
