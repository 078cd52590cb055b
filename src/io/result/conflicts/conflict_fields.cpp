#include "io/result/conflicts/conflict_fields.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/describe/conflict.hpp"
#include "core/query/ignored_points.hpp"
#include "io/result/conflicts/json_text.hpp"

namespace clearway {
std::vector<ConflictField> fields_of(const Conflict& c, const ResultHeader& header) {
  std::vector<ConflictField> fields;
  add_fields(fields, kConflictColumns, c);
  if (header.budget) {
    const bool certain = c.certain.value_or(false);
    fields.push_back({"class", std::string_view(certain ? "certain" : "possible")});
  }
  if (c.body) {
    fields.push_back({"body", std::uint64_t{*c.body}});
    fields.push_back({"body_name", std::string_view(header.bodies.at(*c.body))});
  }
  return fields;
}

std::optional<double> rounded_up(std::optional<double> shift) {
  if (shift) *shift = std::ceil(*shift * 1000) / 1000;
  return shift;
}

Conflict as_conflict(const SmallGroup& group) {
  Conflict out;
  out.points = group.points;
  out.source = out.group = group.source;
  out.box = group.box;
  for (int k = 0; k < 3; ++k) out.centroid[k] = (group.box.lo[k] + group.box.hi[k]) / 2;
  out.first_pose = group.first_pose;
  out.last_pose = group.last_pose;
  out.chainage_from = group.chainage_from;
  out.chainage_to = group.chainage_to;
  out.station_from = group.station_from;
  out.station_to = group.station_to;
  return out;
}

std::vector<Conflict> small_groups_instead(const Conflicts& conflicts) {
  std::vector<Conflict> out;
  if (!conflicts.listed.empty()) return out;
  for (const SmallGroup& group : conflicts.small) out.push_back(as_conflict(group));
  return out;
}

std::vector<ConflictField> sample_fields(const ConflictFile& file) {
  Conflict conflict;
  if (!file.header.bodies.empty()) conflict.body = 0;
  if (!file.options.station.empty()) conflict.station_from = conflict.station_to = 0;
  return fields_of(conflict, file.header);
}

namespace {

/// Most small groups that a file lists, the first ones along the path; nobody reads millions.
constexpr std::size_t kMostSmallGroups = 1000;

std::string small_json(const std::vector<SmallGroup>& groups) {
  std::string out;
  for (std::size_t i = 0; i < std::min(groups.size(), kMostSmallGroups); ++i) {
    std::vector<ConflictField> fields;
    add_fields(fields, kSmallGroupColumns, groups[i]);
    out += (i == 0 ? "" : ", ") + json_object(fields);
  }
  return "[" + out + "]";
}

}  // namespace

std::string summary_json(const ConflictFile& file) {
  const ResultHeader& header = file.header;
  const Conflicts& conflicts = file.conflicts;
  JsonMembers out;
  out.add("kind", json_string("conflicts"));
  out.add("unit", json_string(symbol_of(file.unit())));
  out.add_length("radius", header.radius);
  out.add_length("clearance", header.clearance);
  out.add("between_poses", header.between_poses ? "true" : "false");
  out.add("verdict", json_string(name_of(file.answer.verdict())));
  if (header.budget) {
    std::vector<std::string> reasons;
    for (const Reason reason : file.answer.reasons()) reasons.emplace_back(name_of(reason));
    out.add("reasons", json_strings(reasons));
    out.add("margins", "{\"clear\": " + json_number(header.budget->clear()) +
                           ", \"conflict\": " + json_number(header.budget->conflict()) + "}");
    out.add_count("near_points", file.answer.near_points);
    out.add_count("certain_points", file.answer.certain.points);
  }
  out.add("doubts", json_strings(file.answer.doubts()));
  if (const auto codes = file.answer.warned_of(); !codes.empty()) {
    out.add("warned_of", json_strings(codes));
  }
  if (header.ignores_points()) {
    out.add_count("ignored_points", header.ignored.points);
    out.add_count("ignored_colliding", file.answer.ignored_colliding);
    out.add("ignored", json_string(ignored_text(header)));
  }
  out.add_length("gap", file.options.gap);
  out.add_count("min_points", file.options.min_points);
  out.add_length("split", file.options.split);
  out.add_count("environment_points", header.environment_points);
  out.add_count("model_points", header.model_points);
  out.add_count("poses", header.poses);
  if (!header.bodies.empty()) out.add("bodies", json_strings(header.bodies));
  out.add_hash("environment_hash", header.environment_hash);
  out.add_hash("model_hash", header.model_hash);
  out.add_hash("trajectory_hash", header.trajectory_hash);
  out.add("crs_wkt", json_string(header.crs_wkt));
  out.add_length("path_length", conflicts.path_length);
  out.add_count("colliding_points", conflicts.colliding_points);
  out.add_count("conflict_count", conflicts.listed.size());
  out.add_count("groups", conflicts.groups);
  out.add_count("small_groups", conflicts.small_groups);
  out.add_count("small_points", conflicts.small_points);
  out.add("small", small_json(conflicts.small));
  out.add_length("longest_group", conflicts.longest_group);
  out.add_count("longest_group_points", conflicts.longest_group_points);
  out.add("warnings", json_messages(file.all_warnings()));
  return std::move(out).text();
}

}  // namespace clearway
