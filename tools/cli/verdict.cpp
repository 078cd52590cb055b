#include "cli/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clearway/result.hpp"
#include "cli/ignored/ignored_options.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/ignored_text.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "io/result/result_rows.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

std::optional<AnswerPlace> first_place(const ResultReader& result) {
  std::optional<AnswerPlace> first;
  ResultRowStream stream(result);
  for (ResultRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (first && rows.first_pose[i] >= first->pose) continue;
      first = {.source = rows.source[i], .pose = rows.first_pose[i], .xyz = rows.xyz[i]};
      if (!rows.body.empty()) first->body = result.header().bodies[rows.body[i]];
    }
  }
  return first;
}

std::optional<AnswerPlace> least_clearance(const ResultReader& result, std::uint64_t& inside) {
  std::optional<AnswerPlace> least;
  ClearanceRowStream stream(result);
  for (ClearanceRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows.distance[i] < 0) ++inside;
      if (least && rows.distance[i] >= *least->distance) continue;
      least = {.source = rows.source[i], .pose = rows.pose[i], .distance = rows.distance[i]};
      if (!rows.xyz.empty()) least->xyz = rows.xyz[i];
      if (!rows.body.empty()) least->body = result.header().bodies[rows.body[i]];
    }
  }
  return least;
}

std::optional<AnswerPlace> least_of_profile(const ResultReader& result) {
  std::optional<AnswerPlace> least;
  std::uint32_t pose = 0;
  ProfileRowStream stream(result);
  for (ProfileRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i, ++pose) {
      if (rows.source[i] == Profile::kNoPoint) continue;
      if (least && rows.distance[i] >= *least->distance) continue;
      least = {
          .source = rows.source[i], .pose = pose, .xyz = rows.xyz[i], .distance = rows.distance[i]};
    }
  }
  return least;
}

std::string place_text(const AnswerPlace& place, const PoseLabels& labels,
                       const std::string& unit) {
  std::string text = fmt::format("pose {}", place.pose);
  if (place.chainage) {
    text += " (";
    if (!labels.name.empty()) text += labels.name[place.pose] + ", ";
    if (!labels.time.empty()) text += fmt::format("time {}, ", labels.time[place.pose]);
    text += fmt::format("{:.2f} {} along the path)", *place.chainage, unit);
  }
  if (place.body) text += ", body " + *place.body;
  if (place.xyz) {
    text += fmt::format(", point {:.3f} {:.3f} {:.3f}", place.xyz->x, place.xyz->y, place.xyz->z);
  }
  return text;
}

std::string nearest_text(const Verdict& verdict, const PoseLabels& labels,
                         const std::string& unit) {
  const auto& nearest = verdict.nearest();
  if (nearest && *nearest->distance < 0) {
    std::string text;
    if (const std::uint64_t inside = verdict.points_inside.value_or(0); inside > 0) {
      text = "; " + counted(inside, "point is", "points are") + " inside the model";
    }
    return text + fmt::format("; the greatest depth inside the model is {:.4g} {} at {}",
                              -*nearest->distance, unit, place_text(*nearest, labels, unit));
  }
  if (nearest) {
    return fmt::format("; the least distance is {:.4g} {} at {}", *nearest->distance, unit,
                       place_text(*nearest, labels, unit));
  }
  const double asked = std::max(verdict.query.profile, verdict.query.clearance);
  return asked > 0 ? fmt::format("; none is within {} {}", asked, unit) : "";
}

ordered_json place_json(const std::optional<AnswerPlace>& place, const PoseLabels& labels) {
  if (!place) return nullptr;
  ordered_json out;
  if (place->distance) out["distance"] = *place->distance;
  out["pose"] = place->pose;
  out["source"] = place->source;
  out["chainage"] = place->chainage ? ordered_json(*place->chainage) : ordered_json(nullptr);
  const char* const axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    out[axes[k]] = place->xyz ? ordered_json((*place->xyz)[k]) : ordered_json(nullptr);
  }
  if (place->body) out["body"] = *place->body;
  if (!labels.time.empty()) out["time"] = labels.time[place->pose];
  if (!labels.name.empty()) out["name"] = labels.name[place->pose];
  return out;
}

void set_chainages(Verdict& verdict, const std::vector<Pose>& poses) {
  const std::vector<double> chainage = chainage_of(poses);
  for (auto* place : {&verdict.first, &verdict.least_clearance, &verdict.least_profile}) {
    if (*place) (*place)->chainage = chainage.at((*place)->pose);
  }
}

std::optional<AnswerPlace> answer_place(const std::optional<FoundPlace>& found, bool distance) {
  if (!found) return std::nullopt;
  AnswerPlace place{.source = found->source, .pose = found->pose, .xyz = found->xyz};
  if (distance) place.distance = found->distance;
  return place;
}

/// Of what a report counts and names, of a search or a merge.
template <typename Report>
Verdict verdict_of_found(const Report& report, const QueryParameters& query, bool float_precision) {
  Verdict out;
  out.colliding_points = report.colliding_points;
  out.query = query;
  sort_ignored(out.query);
  out.ignored = report.ignored;
  out.float_precision = float_precision;
  out.first = answer_place(report.first_place, false);
  out.least_clearance = answer_place(report.least_clearance, true);
  out.least_profile = answer_place(report.least_profile, true);
  out.has_depths = report.model_solids > 0;
  if (out.has_depths && query.clearance > 0) out.points_inside = report.inside_points;
  return out;
}

/// bodies: none where there is one model.
template <typename Report>
void name_bodies(const Report& report, const std::vector<std::string>& bodies, Verdict& out) {
  if (bodies.empty()) return;
  if (out.first) out.first->body = bodies[report.first_place->body];
  if (out.least_clearance) out.least_clearance->body = bodies[report.least_clearance->body];
}

}  // namespace

Verdict verdict_of(const SearchReport& report, const Query& query, const SearchOptions& options) {
  Verdict out = verdict_of_found(report, query, options.float_precision);
  out.shard = options.shard;
  std::vector<std::string> bodies;
  for (const Body& body : query.bodies) bodies.push_back(body.name);
  name_bodies(report, bodies, out);
  set_chainages(out, query.poses);
  return out;
}

Verdict verdict_of(const MergeReport& report, bool float_precision) {
  Verdict out = verdict_of_found(report, report.parameters, float_precision);
  name_bodies(report, report.bodies, out);
  return out;
}

Verdict verdict_of(const ResultReader& result, const std::vector<Pose>& poses) {
  Verdict out;
  out.colliding_points = result.collisions();
  out.query = result.header();
  out.ignored = result.header().ignored;
  if (result.header().part) out.shard = result.header().part->shard;
  out.float_precision = result.header().float_precision;
  if (result.header().first_pose) out.first = first_place(result);
  std::uint64_t inside = 0;
  out.least_clearance = least_clearance(result, inside);
  out.has_depths = result.header().model_solids > 0;
  if (out.has_depths && out.query.clearance > 0) out.points_inside = inside;
  out.least_profile = least_of_profile(result);
  if (!poses.empty()) set_chainages(out, poses);
  return out;
}

std::optional<double> greatest_depth(const Verdict& verdict) {
  const bool is_known = std::max(verdict.query.clearance, verdict.query.profile) > 0;
  if (!verdict.has_depths || !is_known) return std::nullopt;
  return verdict.nearest() ? std::max(0.0, -*verdict.nearest()->distance) : 0;
}

std::string found_text(std::uint64_t colliding_points, std::uint64_t environment_points) {
  return fmt::format("{} of {} {}", format_count(colliding_points),
                     counted(environment_points, "environment point"),
                     colliding_points == 1 ? "collides" : "collide");
}

std::string caveat_of(std::size_t warnings) {
  if (warnings == 0) return "";
  return ", but see the " + (warnings == 1 ? "warning" : std::to_string(warnings) + " warnings") +
         " above";
}

std::string verdict_text(const Verdict& verdict, const PoseLabels& labels, const std::string& unit,
                         const std::string& caveat) {
  const std::string limit = fmt::format("{} {}", verdict.query.radius, unit);
  std::string text;
  if (verdict.shard) text = in_words(*verdict.shard) + ": ";
  const bool ignores = verdict.query.ignores_points();
  const std::string ignored =
      ignores ? ", with " + ignored_text(verdict.query, verdict.ignored) : "";
  if (verdict.is_clear()) {
    text += "clear" + ignored + ": no " + (ignores ? "other" : "environment") +
            " point is closer than " + limit + " to the model on its way";
  } else if (!verdict.is_conflict()) {
    text += "no point of this part is closer than " + limit + " to the model on its way" + ignored;
  } else {
    text += "conflict" + ignored + ": " + format_count(verdict.colliding_points) +
            (verdict.colliding_points == 1 ? " point is" : " points are") + " closer than " +
            limit + " to the model on its way";
    if (verdict.first) {
      text += std::string("; first ") + (verdict.query.between_poses ? "on the way from " : "at ") +
              place_text(*verdict.first, labels, unit);
    }
  }
  text += nearest_text(verdict, labels, unit);
  if (verdict.query.tolerance > 0) {
    text += fmt::format("; points within {} {} of that distance may be judged wrongly",
                        verdict.query.tolerance, unit);
  }
  if (verdict.shard) text += "; clearway merge gives the answer of all parts";
  if (verdict.float_precision) text += "; not exact, as single precision alone decided";
  return text + caveat + ".";
}

void add_verdict(const Verdict& verdict, const PoseLabels& labels, ordered_json& out) {
  out["verdict"] = verdict.is_clear() ? "clear" : verdict.is_conflict() ? "conflict" : "unknown";
  out["ignored"] = ignored_json(verdict.query, verdict.ignored);
  out["shard"] = verdict.shard ? ordered_json(to_string(*verdict.shard)) : ordered_json(nullptr);
  const std::optional<double> depth = greatest_depth(verdict);
  out["points_inside"] = nullptr;
  if (verdict.points_inside) out["points_inside"] = *verdict.points_inside;
  out["greatest_depth"] = depth ? ordered_json(*depth) : ordered_json(nullptr);
  out["least_clearance"] = place_json(verdict.least_clearance, labels);
  out["least_profile"] = place_json(verdict.least_profile, labels);
  out["first_place"] = place_json(verdict.first, labels);
}

}  // namespace clearway::tool
