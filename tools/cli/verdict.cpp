#include "cli/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli/support/console.hpp"
#include "cli/support/ignored_options.hpp"
#include "cli/support/label_text.hpp"
#include "core/describe/seen.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/spacing_text.hpp"
#include "core/query/verdict_words.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/floor_facts.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

/// Whether the place's coordinates are known; only old files lack them.
bool has_xyz(const FoundPlace& place) { return !std::isnan(place.xyz.x); }

/// The name of the body that is nearest at a place; empty for one model, and for a profile, which
/// does not say which body is nearest.
std::string body_of(const Answer& answer, const std::optional<FoundPlace>& place) {
  const bool names_body = !answer.bodies.empty() && &place != &answer.least_profile;
  return names_body ? answer.bodies[place->body] : "";
}

std::string place_text(const Answer& answer, const std::optional<FoundPlace>& place,
                       const PathWords& path, const std::string& unit) {
  const std::uint32_t pose = place->pose;
  std::string text = fmt::format("pose {}", pose);
  if (!path.chainage.empty()) {
    text += " (";
    for_each_label({LabelPlace::kFirst, LabelPlace::kNext, LabelPlace::kBesideChainage},
                   [&](const auto& label) {
                     const auto& values = label.of(path.labels);
                     if (!values.empty()) text += label_text(label, values[pose]) + ", ";
                   });
    text += fmt::format("{:.2f} {} along the path)", path.chainage[pose], unit);
  }
  if (const std::string body = body_of(answer, place); !body.empty())
    text += ", " + body_words(body);
  if (has_xyz(*place)) {
    text += fmt::format(", point {:.3f} {:.3f} {:.3f}", place->xyz.x, place->xyz.y, place->xyz.z);
  }
  if (const std::string of = class_words(place->point_class.value_or(0)); !of.empty()) {
    text += " of " + of;
  }
  return text;
}

/// A distance for people: what is less than a millionth is the rounding of coordinates.
std::string distance_text(double distance) {
  return format_brief(std::abs(distance) < 1e-6 ? 0 : distance);
}

std::string nearest_text(const Answer& answer, const PathWords& path, const std::string& unit) {
  const std::optional<FoundPlace>& nearest = answer.nearest();
  if (nearest && nearest->distance < 0) {
    std::string text;
    if (const std::uint64_t inside = answer.points_inside().value_or(0); inside > 0) {
      text = "; " + counted(inside, "point is", "points are") + " inside the model";
    }
    return text + fmt::format("; the greatest depth inside the model is {} {} at {}",
                              distance_text(-nearest->distance), unit,
                              place_text(answer, nearest, path, unit));
  }
  if (nearest) {
    return fmt::format("; the least distance is {} {} at {}", distance_text(nearest->distance),
                       unit, place_text(answer, nearest, path, unit));
  }
  const double asked = std::max(answer.parameters.profile, answer.parameters.clearance);
  return asked > 0 ? fmt::format("; none is within {} {}", format_length(asked), unit) : "";
}

/// A clause about ignored points, such as ", with 12 points ignored (class 2), 3 of which would
/// collide"; empty where none is ignored.
std::string ignored_clause(const Answer& answer) {
  if (!answer.parameters.ignores_points()) return "";
  if (answer.ignored.points == 0) return "";
  std::string text = ", with " + ignored_text(answer.parameters, answer.ignored) + ", ";
  if (answer.ignored_colliding == 0) return text + "none of which would collide";
  return text + format_count(answer.ignored_colliding) + " of which would collide";
}

/// A clause about what lies below the floor, such as ", with 1,190 points within the radius below
/// 0.25 m of the vehicle not judged"; empty without a floor.
std::string floor_clause(const Answer& answer, const std::string& unit) {
  if (!answer.floor_colliding) return "";
  if (*answer.floor_colliding == 0) {
    return ", with no point within the radius below " + floor_words(floor_json(answer), unit);
  }
  return ", with " + counted(*answer.floor_colliding, "point") + " within the radius below " +
         floor_words(floor_json(answer), unit) + " not judged";
}

/// " on 3.2 of 68.0 m", or " on 3.2 m of the path" where its length is not known. What would round
/// to 0 is less than 0.1, because it is not nothing. Empty for a path that stands still.
std::string part_of_path(double part, double path, const std::string& unit) {
  const std::string length = part < 0.05 ? "less than 0.1" : fmt::format("{:.1f}", part);
  if (path > 0) return fmt::format(" on {} of {:.1f} {}", length, path, unit);
  return part > 0 ? " on " + length + " " + unit + " of the path" : "";
}

/// A clause about seen space, such as "; not scanned on 3.2 of 68 m"; empty where it was not asked
/// for, and for a shard, whose beams are only some.
std::string seen_clause(const Answer& answer, const PathWords& path, const std::string& unit) {
  if (!answer.seen || answer.shard) return "";
  const SeenSummary& seen = *answer.seen;
  const double length = path.chainage.empty() ? 0 : path.chainage.back();
  if (seen.listed_groups > 0) {
    const std::uint64_t small = seen.groups - seen.listed_groups;
    const std::string others =
        small == 0 ? ""
                   : fmt::format(" and {} of fewer than {} cubes", counted(small, "group"),
                                 answer.parameters.seen_min);
    return fmt::format(
        "; not scanned{}: no beam passed through {} of {} cubes that the model sweeps, in {}{}",
        part_of_path(seen.not_scanned_length, length, unit), format_count(seen.unseen),
        format_count(seen.swept), counted(seen.listed_groups, "place"), others);
  }
  if (seen.unseen > 0) {
    return fmt::format(
        "; a beam passed through all but {} of the {} cubes that the model sweeps, "
        "which are in {} of fewer than {} cubes",
        format_count(seen.unseen), format_count(seen.swept), counted(seen.groups, "group"),
        answer.parameters.seen_min);
  }
  return "; a beam passed through each of the " + format_count(seen.swept) +
         " cubes that the model sweeps";
}

/// A clause about the classes of what collides or is near; empty where they say nothing.
std::string classified_clause(const Answer& answer) {
  const std::string words =
      classified_words(answer.classes, answer.colliding_points + answer.near_points);
  return words.empty() ? "" : "; " + words;
}

/// The verdict of a query with an error budget, with what it rests on.
std::string finding_with_budget(const Answer& answer, const PathWords& path,
                                const std::string& unit) {
  const ErrorBudget& budget = *answer.budget;
  const double margin = answer.parameters.radius;
  const std::string asked = format_length(margin);
  const std::string within = fmt::format("{} {} (the margin of {} {} and {} {} of errors)",
                                         format_brief(budget.near_radius(margin)), unit, asked,
                                         unit, format_brief(budget.clear()), unit);
  const std::string ignored = ignored_clause(answer) + floor_clause(answer, unit);
  const std::string points = counted(answer.colliding_points, "point is", "points are") +
                             " closer than the margin and " + format_count(answer.near_points) +
                             " more closer than " + within;
  const std::string name = verdict_words(answer.verdict(), !answer.warnings.empty());
  std::string text;
  switch (answer.verdict()) {
    case Verdict::kClear:
      return name + ignored + ": no " + (ignored.empty() ? "environment" : "other") +
             " point is closer than " + within + " to the model on its way";
    case Verdict::kUnknown:
      return "of this part " + points + ignored;
    case Verdict::kUndecided: {
      std::vector<std::string> reasons;
      for (const Reason reason : answer.reasons()) reasons.emplace_back(name_of(reason));
      text = fmt::format("{} ({})", name, fmt::join(reasons, ", ")) + ignored + ": " + points;
      if (answer.is_in_doubt()) text += "; " + doubt_words(answer.doubts());
      break;
    }
    case Verdict::kConflict:
      text = name + ignored + ": " + counted(answer.certain.points, "point is", "points are") +
             " certainly too close, even with " + format_brief(budget.conflict()) + " " + unit +
             " of errors; " + points;
      break;
  }
  text += classified_clause(answer);
  if (answer.first_place) {
    text += std::string("; first ") +
            (answer.parameters.between_poses ? "on the way from " : "at ") +
            place_text(answer, answer.first_place, path, unit);
  }
  return text;
}

/// The verdict with the finding behind it.
std::string finding_text(const Answer& answer, const PathWords& path, const std::string& unit) {
  if (answer.budget) return finding_with_budget(answer, path, unit);
  const std::string limit = format_length(answer.parameters.radius) + " " + unit;
  const std::string ignored = ignored_clause(answer) + floor_clause(answer, unit);
  const std::string none = std::string("no ") + (ignored.empty() ? "environment" : "other") +
                           " point is closer than " + limit + " to the model on its way";
  const std::string name = verdict_words(answer.verdict(), !answer.warnings.empty());
  switch (answer.verdict()) {
    case Verdict::kClear:
      return name + ignored + ": " + none;
    case Verdict::kUndecided:
      if (!answer.is_in_doubt()) return name + " (not-scanned)" + ignored + ": " + none;
      return name + ", because " + (answer.is_not_scanned() ? "places were not scanned and " : "") +
             doubt_words(answer.doubts()) + ignored + ": " + none;
    case Verdict::kUnknown:
      return "no point of this part is closer than " + limit + " to the model on its way" + ignored;
    case Verdict::kConflict:
      break;
  }
  std::string text = name + ignored + ": " +
                     counted(answer.colliding_points, "point is", "points are") + " closer than " +
                     limit + " to the model on its way" + classified_clause(answer);
  if (answer.first_place) {
    text += std::string("; first ") +
            (answer.parameters.between_poses ? "on the way from " : "at ") +
            place_text(answer, answer.first_place, path, unit);
  }
  return text;
}

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

/// A clause that says on how much of the path nothing could be found; empty where that is nowhere.
std::string doubt_clause(const Answer& answer, const PathWords& path, const std::string& unit) {
  std::vector<PoseRange> stretches;
  std::set<std::string> codes;
  for (const Message& warning : answer.warnings) {
    if (answer.doubt_of(warning) != Doubt::kStretch) continue;
    stretches.insert(stretches.end(), warning.stretches.begin(), warning.stretches.end());
    codes.insert(warning.code);
  }
  if (stretches.empty()) return "";
  stretches = united_ranges(std::move(stretches));
  std::string text = "; on " + counted(stretches.size(), "stretch", "stretches") + " of the path";
  if (!path.chainage.empty()) {
    double length = 0;
    for (const auto& [first, last] : stretches) {
      if (last < path.chainage.size()) length += path.chainage[last] - path.chainage[first];
    }
    text += fmt::format(", {:.2f} {} in all,", length, unit);
  }
  return text + fmt::format(" nothing could be found ({})", fmt::join(codes, ", "));
}

/// A clause that says on how much of the path the vehicle was searched, since bodies on pivots have
/// no pose at its ends. Empty where that is the whole path.
std::string searched_text(const Answer& answer, const std::string& unit) {
  if (!answer.searched || !(answer.searched->whole < answer.searched->path)) return "";
  const SearchedLength& searched = *answer.searched;
  const std::string part =
      searched.part > 0 ? fmt::format(", some bodies on {:.2f} {} more", searched.part, unit) : "";
  return fmt::format("; the vehicle was searched on {:.2f} of {:.2f} {} of the path{}",
                     searched.whole, searched.path, unit, part);
}

}  // namespace

ordered_json margins_json(const Answer& answer) {
  if (!answer.budget) return nullptr;
  return {{"clear", answer.budget->clear()}, {"conflict", answer.budget->conflict()}};
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
  return {{"scan", budget.scan},       {"registration", budget.registration},
          {"pose", budget.pose},       {"angle", budget.angle},
          {"lever", budget.lever},     {"model", budget.model},
          {"sigmas", budget.sigmas},   {"step", budget.step},
          {"motion", budget.motion},   {"chord", budget.chord},
          {"spacing", budget.spacing}, {"hard", budget.hard()},
          {"way", budget.way()}};
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

std::string verdict_text(const Answer& answer, const PathWords& path, const std::string& unit,
                         const std::string& caveat, bool names_nearest) {
  std::string text = answer.shard ? in_words(*answer.shard) + ": " : "";
  text += finding_text(answer, path, unit) + seen_clause(answer, path, unit);
  if (names_nearest || answer.verdict() != Verdict::kConflict) {
    text += nearest_text(answer, path, unit);
  }
  if (answer.verdict() != Verdict::kConflict) {
    text += spacing_text(answer.model_spacing, answer.parameters.radius, unit);
  }
  if (answer.shard) text += "; clearway merge gives the answer of all parts";
  text += searched_text(answer, unit) + doubt_clause(answer, path, unit);
  return text + caveat + ".";
}

std::string unseen_text(const UnseenGroups& unseen, const Answer& answer, const std::string& unit) {
  std::string text;
  if (unseen.behind_conflicts > 0) {
    const bool one = unseen.behind_conflicts == 1;
    text += fmt::format(
        " {} of the places that were not scanned {} behind a conflict: what collides may hide {} "
        "from the scanner.",
        format_count(unseen.behind_conflicts), one ? "is" : "are", one ? "it" : "them");
  }
  const double radius = answer.budget ? answer.budget->near_radius(answer.parameters.radius)
                                      : answer.parameters.radius;
  for (const UnseenGroup& group : unseen.listed) {
    if (!group.is_ground) continue;
    return text +
           fmt::format(
               " The place that was not scanned from {:.1f} to {:.1f} {} of the path reaches "
               "down to the lowest part of the model, so it is probably the ground: run "
               "again with a --floor that is {} above the model's lowest part, or a little more "
               "where the ground is rough.",
               group.chainage_from, group.chainage_to, unit,
               format_brief(radius - answer.parameters.radius + answer.seen->cube / 2));
  }
  return text;
}

std::string warned_text(const Answer& answer) {
  const std::vector<std::string> codes = answer.warned_of();
  return codes.empty() ? "" : fmt::format("; its run warned of {}", fmt::join(codes, ", "));
}

std::string verdict_to_repeat(const ResultReader& result, const PathWords& path,
                              const std::string& unit) {
  const ResultHeader& header = result.header();
  if (result.collisions() > 0 && !header.ignores_points() && !header.budget) return "";
  const Answer answer = answer_of(result);
  return verdict_text(answer, path, unit, warned_text(answer));
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
  out["reasons"] = names_of(answer.reasons());
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
