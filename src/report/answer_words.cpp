#include "report/answer_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "core/describe/labels.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/verdict_words.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/floor_facts.hpp"
#include "io/scans/length_unit.hpp"
#include "report/label_text.hpp"

namespace clearway {
namespace {

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

std::string nearest_clause(const Answer& answer, const PathWords& path, const std::string& unit) {
  const std::optional<FoundPlace>& nearest = answer.nearest();
  if (nearest && nearest->distance < 0) {
    const std::uint64_t inside = answer.points_inside().value_or(0);
    const std::string points =
        inside == 0 ? "" : counted(inside, "point is", "points are") + " inside the model; ";
    return points + fmt::format("the greatest depth inside the model is {} {} at {}",
                                distance_text(-nearest->distance), unit,
                                place_text(answer, nearest, path, unit));
  }
  if (nearest) {
    return fmt::format("the least distance is {} {} at {}", distance_text(nearest->distance), unit,
                       place_text(answer, nearest, path, unit));
  }
  const double asked = std::max(answer.parameters.profile, answer.parameters.clearance);
  return asked > 0 ? fmt::format("none is within {} {}", format_length(asked), unit) : "";
}

std::string ignored_clause(const Answer& answer) {
  if (!answer.parameters.ignores_points() || answer.ignored.points == 0) return "";
  const std::string text = ignored_text(answer.parameters, answer.ignored) + ", ";
  if (answer.ignored_colliding == 0) return text + "none of which would collide";
  return text + format_count(answer.ignored_colliding) + " of which would collide";
}

std::string floor_clause(const Answer& answer, const std::string& unit) {
  if (!answer.floor_colliding) return "";
  const std::string floor = floor_words(floor_json(answer), unit);
  if (*answer.floor_colliding == 0) return "no point within the radius below " + floor;
  return counted(*answer.floor_colliding, "point") + " within the radius below " + floor +
         " not judged";
}

/// " on 3.2 of 68.0 m", or " on 3.2 m of the path" where its length is not known. What would round
/// to 0 is less than 0.1, because it is not nothing. Empty for a path that stands still.
std::string part_of_path(double part, double path, const std::string& unit) {
  const std::string length = part < 0.05 ? "less than 0.1" : fmt::format("{:.1f}", part);
  if (path > 0) return fmt::format(" on {} of {:.1f} {}", length, path, unit);
  return part > 0 ? " on " + length + " " + unit + " of the path" : "";
}

std::string seen_clause(const Answer& answer, const PathWords& path, const std::string& unit) {
  if (!answer.seen || answer.shard) return "";  // the beams of a part are only some
  const SeenSummary& seen = *answer.seen;
  if (seen.swept == 0) return "the model sweeps no cube, so nothing is known of seen space";
  const double length = path.chainage.empty() ? 0 : path.chainage.back() - path.chainage.front();
  if (seen.listed_groups > 0) {
    const std::uint64_t small = seen.groups - seen.listed_groups;
    const std::string others =
        small == 0 ? ""
                   : fmt::format(" and {} of fewer than {} cubes", counted(small, "group"),
                                 format_count(answer.parameters.seen_min));
    return fmt::format(
        "not scanned{}: no beam passed through {} of {} cubes that the model sweeps, in {}{}",
        part_of_path(seen.not_scanned_length, length, unit), format_count(seen.unseen),
        format_count(seen.swept), counted(seen.listed_groups, "place"), others);
  }
  if (seen.unseen > 0) {
    return fmt::format(
        "a beam passed through all but {} of the {} cubes that the model sweeps, which are in {} "
        "of fewer than {} cubes",
        format_count(seen.unseen), format_count(seen.swept), counted(seen.groups, "group"),
        format_count(answer.parameters.seen_min));
  }
  return "a beam passed through each of the " + format_count(seen.swept) +
         " cubes that the model sweeps";
}

std::string spacing_clause(const Answer& answer, const std::string& unit) {
  const double spacing = answer.model_spacing, radius = answer.parameters.radius;
  if (!(spacing > 0) || answer.verdict() == Verdict::kConflict) return "";
  const std::string closest =
      spacing < radius ? "come as close as " + format_brief(radius - spacing) + " " + unit
                       : std::string("touch something");
  return "the model is points of a mesh, and no place of its surface is farther than " +
         format_brief(spacing) + " " + unit + " from one, so the surface may " + closest;
}

/// Bodies on pivots have no pose at the ends of the path.
std::string searched_clause(const Answer& answer, const std::string& unit) {
  if (!answer.searched || !(answer.searched->whole < answer.searched->path)) return "";
  const SearchedLength& searched = *answer.searched;
  const std::string part =
      searched.part > 0 ? fmt::format(", some bodies on {:.2f} {} more", searched.part, unit) : "";
  return fmt::format("the vehicle was searched on {:.2f} of {:.2f} {} of the path{}",
                     searched.whole, searched.path, unit, part);
}

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
  std::string text = "on " + counted(stretches.size(), "stretch", "stretches") + " of the path";
  if (!path.chainage.empty()) {
    double length = 0;
    for (const auto& [first, last] : stretches) {
      if (last < path.chainage.size()) length += path.chainage[last] - path.chainage[first];
    }
    text += fmt::format(", {:.2f} {} in all,", length, unit);
  }
  return text + " nothing could be found (" + with_commas(codes) + ")";
}

/// How many points are closer than what.
void find_with_budget(AnswerWords& words, const Answer& answer, const std::string& none,
                      const std::string& unit) {
  const ErrorBudget& budget = *answer.budget;
  const double margin = answer.parameters.radius;
  const std::string within = fmt::format(
      "{} {} (the margin of {} {} and {} {} of errors)", format_brief(budget.near_radius(margin)),
      unit, format_length(margin), unit, format_brief(budget.clear()), unit);
  const std::string points = counted(answer.colliding_points, "point is", "points are") +
                             " closer than the margin and " + format_count(answer.near_points) +
                             " more closer than " + within;
  switch (answer.verdict()) {
    case Verdict::kClear:
      words.finding = none + within + " to the model on its way";
      return;
    case Verdict::kUnknown:
      words.finding = "of this part " + points;
      return;
    case Verdict::kUndecided: {
      std::vector<const char*> reasons;
      for (const Reason reason : answer.reasons()) reasons.push_back(name_of(reason));
      words.verdict += " (" + with_commas(reasons) + ")";
      words.finding = points;
      if (answer.is_in_doubt()) words.finding += "; " + doubt_words(answer.doubts());
      return;
    }
    case Verdict::kConflict:
      words.finding = counted(answer.certain.points, "point is", "points are") +
                      " certainly too close, even with " + format_brief(budget.conflict()) + " " +
                      unit + " of errors; " + points;
  }
}

void find(AnswerWords& words, const Answer& answer, const std::string& none,
          const std::string& unit) {
  const std::string limit =
      format_length(answer.parameters.radius) + " " + unit + " to the model on its way";
  words.finding = none + limit;
  switch (answer.verdict()) {
    case Verdict::kClear:
      return;
    case Verdict::kUndecided:
      words.verdict += answer.is_in_doubt()
                           ? std::string(", because ") +
                                 (answer.is_not_scanned() ? "places were not scanned and " : "") +
                                 doubt_words(answer.doubts())
                           : " (not-scanned)";
      return;
    case Verdict::kUnknown:
      words.finding = "no point of this part is closer than " + limit;
      return;
    case Verdict::kConflict:
      words.finding =
          counted(answer.colliding_points, "point is", "points are") + " closer than " + limit;
  }
}

}  // namespace

bool has_xyz(const FoundPlace& place) { return !std::isnan(place.xyz.x); }

std::string body_of(const Answer& answer, const std::optional<FoundPlace>& place) {
  const bool names_body = !answer.bodies.empty() && &place != &answer.least_profile;
  return names_body ? answer.bodies[place->body] : "";
}

AnswerWords answer_words(const Answer& answer, const PathWords& path, const std::string& unit) {
  AnswerWords words{.ignored = ignored_clause(answer),
                    .floor = floor_clause(answer, unit),
                    .seen = seen_clause(answer, path, unit),
                    .nearest = nearest_clause(answer, path, unit),
                    .spacing = spacing_clause(answer, unit),
                    .searched = searched_clause(answer, unit),
                    .doubt = doubt_clause(answer, path, unit)};
  const Verdict verdict = answer.verdict();
  if (verdict != Verdict::kUnknown) {
    words.verdict = verdict_words(verdict, !answer.warnings.empty());
  }
  const bool is_of_all = words.ignored.empty() && words.floor.empty();
  const std::string none =
      std::string("no ") + (is_of_all ? "environment" : "other") + " point is closer than ";
  (answer.budget ? find_with_budget : find)(words, answer, none, unit);
  const bool is_open = answer.budget && verdict == Verdict::kUndecided;
  if (verdict != Verdict::kConflict && !is_open) return words;
  words.classes = classified_words(answer.classes, answer.colliding_points + answer.near_points);
  if (answer.first_place) {
    words.first = (answer.parameters.between_poses ? "first on the way from " : "first at ") +
                  place_text(answer, answer.first_place, path, unit);
  }
  return words;
}

std::string sentence_of(std::string clause) {
  if (clause.empty()) return clause;
  clause[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(clause[0])));
  return clause + ".";
}

std::string verdict_text(const Answer& answer, const PathWords& path, const std::string& unit,
                         const std::string& caveat, bool names_nearest) {
  AnswerWords words = answer_words(answer, path, unit);
  if (!names_nearest && answer.verdict() == Verdict::kConflict) words.nearest.clear();
  std::string without;
  for (const std::string& clause : {words.ignored, words.floor}) {
    if (!clause.empty()) without += ", with " + clause;
  }
  std::string text = answer.shard ? in_words(*answer.shard) + ": " : "";
  text += words.verdict.empty() ? words.finding + without
                                : words.verdict + without + ": " + words.finding;
  const std::string merge = answer.shard ? "clearway merge gives the answer of all parts" : "";
  for (const std::string& clause : {words.classes, words.first, words.seen, words.nearest,
                                    words.spacing, merge, words.searched, words.doubt}) {
    if (!clause.empty()) text += "; " + clause;
  }
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

}  // namespace clearway
