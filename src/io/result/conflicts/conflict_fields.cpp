#include "io/result/conflicts/conflict_fields.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/describe/conflict.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/text_writer.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/ledger_words.hpp"
#include "io/result/floor_facts.hpp"

namespace clearway {
const LedgerEntry* ledger_entry_of(const Conflict& conflict, const ConflictFile& file) {
  const std::vector<Conflict>& listed = file.conflicts.listed;
  if (file.ledger == nullptr || conflict.id == 0 || conflict.id > listed.size()) return nullptr;
  // Small groups have numbers of their own in some files.
  if (listed[conflict.id - 1].source != conflict.source) return nullptr;
  return &file.ledger->conflicts[conflict.id - 1];
}

std::vector<ConflictField> fields_of(const Conflict& c, const ConflictFile& file) {
  const ResultHeader& header = file.header;
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
  if (c.first_body) {  // that of the trims and the side
    fields.push_back({"first_body", std::uint64_t{*c.first_body}});
    fields.push_back({"first_body_name", std::string_view(header.bodies.at(*c.first_body))});
  }
  if (file.ledger != nullptr) {
    static const LedgerEntry kNone{};
    const LedgerEntry* const found = ledger_entry_of(c, file);
    const LedgerEntry& entry = found != nullptr ? *found : kNone;
    const std::string_view status = found != nullptr ? name_of(entry.status) : "";
    fields.push_back({"ledger", status});
    fields.push_back({"ledger_key", std::string_view(entry.key)});
    fields.push_back({"ledger_why", std::string_view(entry.why)});
    fields.push_back({"ledger_owner", std::string_view(entry.owner)});
    fields.push_back({"ledger_comment", std::string_view(entry.comment)});
    fields.push_back({"ledger_until", std::string_view(entry.until)});
  }
  return fields;
}

std::optional<double> rounded_up(std::optional<double> shift) {
  // What is a whole number but for roundings is taken for it.
  if (shift) *shift = std::ceil(*shift * 1000 - 1e-6) / 1000 + 0.0;  // 0 instead of -0
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
  return fields_of(conflict, file);
}

namespace {

/// Most small groups that a file lists, the first ones along the path; nobody reads millions.
constexpr std::size_t kMostSmallGroups = 1000;

Json small_json(const std::vector<SmallGroup>& groups) {
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(groups.size(), kMostSmallGroups); ++i) {
    std::vector<ConflictField> fields;
    add_fields(fields, kSmallGroupColumns, groups[i]);
    out.push_back(json_of(fields));
  }
  return out;
}

}  // namespace

Json json_of(const FieldValue& value) {
  return std::visit(
      [](const auto& of) {
        using Value = std::decay_t<decltype(of)>;
        if constexpr (std::is_same_v<Value, std::monostate>) {
          return Json();
        } else if constexpr (std::is_same_v<Value, std::string_view>) {
          return of.empty() ? Json() : Json(of);
        } else {
          return Json(of);
        }
      },
      value);
}

Json json_of(const std::vector<ConflictField>& fields) {
  Json out = Json::object();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string& name = fields[i].name;
    if (!name.ends_with("_x")) {
      out[name] = json_of(fields[i].value);
      continue;
    }
    out[name.substr(0, name.size() - 2)] = Json::array(
        {json_of(fields[i].value), json_of(fields[i + 1].value), json_of(fields[i + 2].value)});
    i += 2;
  }
  return out;
}

Json json_of(const ClassCounts& classes) {
  Json out = Json::object();
  for (const auto& [value, points] : classes) out[std::to_string(value)] = points;
  return out;
}

std::string csv_value(const ConflictField& field) {
  const FieldValue& value = field.value;
  if (std::holds_alternative<std::monostate>(value)) return "";
  if (const double* length = std::get_if<double>(&value)) {
    return format_number(readable_length(*length, field.rounds_up));
  }
  const auto* word = std::get_if<std::string_view>(&value);
  return word != nullptr ? csv_cell(*word) : line_text(json_of(value));
}

void add_hashes(Json& json, const ResultHeader& header) {
  json["environment_hash"] = hash_text(header.environment_hash);
  json["model_hash"] = hash_text(header.model_hash);
  json["trajectory_hash"] = hash_text(header.trajectory_hash);
}

Json summary_of(const ConflictFile& file) {
  const ResultHeader& header = file.header;
  const Conflicts& conflicts = file.conflicts;
  Json out{{"kind", "conflicts"},
           {"unit", symbol_of(file.unit())},
           {"radius", header.radius},
           {"clearance", header.clearance},
           {"between_poses", header.between_poses},
           {"verdict", name_of(file.answer.verdict())}};
  if (header.budget) {
    out["reasons"] = json_of_fact(file.answer.reasons());
    out["margins"] = {{"clear", header.budget->clear()}, {"conflict", header.budget->conflict()}};
    out["near_points"] = file.answer.near_points;
    out["certain_points"] = file.answer.certain.points;
  }
  out["doubts"] = file.answer.doubts();
  if (const auto codes = file.answer.warned_of(); !codes.empty()) out["warned_of"] = codes;
  if (header.ignores_points()) {
    out["ignored_points"] = header.ignored.points;
    out["ignored_colliding"] = file.answer.ignored_colliding;
    out["ignored"] = ignored_text(header);
  }
  if (file.answer.floor_colliding) out["floor"] = floor_json(file.answer);
  out["gap"] = conflicts.gap;
  out["min_points"] = conflicts.min_points;
  out["spacing"] = or_null(conflicts.spacing);
  out["split"] = file.options.split;
  out["environment_points"] = header.environment_points;
  out["model_points"] = header.model_points;
  out["poses"] = header.poses;
  if (!header.bodies.empty()) out["bodies"] = header.bodies;
  add_hashes(out, header);
  out["crs_wkt"] = header.crs_wkt;
  out["path_length"] = conflicts.path_length;
  out["colliding_points"] = conflicts.colliding_points;
  if (!conflicts.classes.empty()) out["classes"] = json_of(conflicts.classes);
  out["conflict_count"] = conflicts.listed.size();
  const Conflict* const worst = worst_of(conflicts);
  out["worst"] = worst == nullptr ? Json() : Json(worst->id);
  out["groups"] = conflicts.groups;
  out["small_groups"] = conflicts.small_groups;
  out["small_points"] = conflicts.small_points;
  out["small"] = small_json(conflicts.small);
  out["longest_group"] = conflicts.longest_group;
  out["longest_group_points"] = conflicts.longest_group_points;
  out["longest_group_height_from"] = or_null(conflicts.longest_group_height_from);
  out["longest_group_height_to"] = or_null(conflicts.longest_group_height_to);
  out["longest_group_is"] = name_of(conflicts.longest_group_is);
  if (file.ledger != nullptr) out["ledger"] = ledger_json(*file.ledger);
  out["warnings"] = file.all_warnings();
  return out;
}

}  // namespace clearway
