#include "report/report_facts.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/describe/conflict.hpp"
#include "core/describe/query.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "findings/conflict_rank.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/json_text.hpp"
#include "io/result/result.hpp"
#include "io/store/store_metadata.hpp"
#include "io/store/store_reader.hpp"
#include "report/facts_text.hpp"
#include "report/on_site.hpp"
#include "report/shown_poses.hpp"

namespace clearway {
namespace {

constexpr const char* kClassNames[] = {"hit", "near", "watch"};

void write_box(JsonText& json, const char* name, const Box& box) {
  json.key(name).begin('{').field("lo", box.lo).field("hi", box.hi).end('}');
}

/// The number of triangles that belong to no solid.
std::uint64_t surface_triangles(const Model& model) {
  if (!model.is_solid()) return model.triangles.size();
  return static_cast<std::uint64_t>(std::ranges::count(model.solid_of, kNoSolid));
}

std::uint64_t surface_triangles(std::span<const DrawnBody> bodies) {
  std::uint64_t count = 0;
  for (const DrawnBody& body : bodies) count += surface_triangles(body.model);
  return count;
}

void write_bodies(JsonText& json, const ReportFacts& facts) {
  json.key("bodies").begin('[');
  for (const DrawnBody& body : facts.bodies) {
    json.begin('{')
        .field("name", body.name)
        .field("points", std::uint64_t{body.model.vertices.size()});
    json.field("triangles", std::uint64_t{body.model.triangles.size()});
    json.field("solids", body.model.solid_count());
    json.field("surface_triangles", surface_triangles(body.model));
    json.field("poses", std::uint64_t{body.poses.size()});
    json.field("shown_points", std::uint64_t{body.shown_points});
    write_box(json, "box", body.box);
    json.end('}');
  }
  json.end(']');
}

/// Writes the name of a body; nothing for a single model.
void write_body(JsonText& json, const ReportFacts& facts,
                const std::optional<std::uint32_t>& body) {
  if (body) json.field("body", facts.bodies[*body].name);
}

/// The spacing of a mesh that was searched as points; nothing for other models.
std::optional<double> spacing_of(const ResultHeader& header) {
  if (!(header.notes.model_spacing > 0)) return std::nullopt;
  return header.notes.model_spacing;
}

void write_inputs(JsonText& json, const ReportFacts& facts) {
  const ReportOptions& options = facts.options;
  const ResultHeader& header = facts.result.reader().header();
  json.key("inputs").begin('{');
  json.key("result").begin('{').field("name", options.result_name);
  json.field("hash", hash_text(facts.result.reader().recorded_hash<Collisions>())).end('}');
  json.key("environment").begin('{').field("name", options.environment_name);
  json.field("points", header.environment_points);
  json.field("hash", hash_text(header.environment_hash));
  json.field("files", std::uint64_t{facts.store.reader().metadata().sources.size()});
  write_box(json, "box", facts.store.box());
  json.field("crs_wkt", header.crs_wkt).end('}');
  json.key("model").begin('{').field("name", options.model_name);
  json.field("points", header.model_points).field("hash", hash_text(header.model_hash));
  json.field("triangles", header.model_triangles).field("solids", header.model_solids);
  json.field("surface_triangles", surface_triangles(facts.bodies));
  json.field("spacing", spacing_of(header));
  write_box(json, "box", facts.model_box);
  if (const ModelAxes axes = header.notes.model_axes; axes.need_turn()) {
    json.key("axes").begin('[').value(name_of(axes.forward)).value(name_of(axes.up)).end(']');
  }
  json.field("above", options.model_above).field("left_out", options.model_left_out);
  if (!header.bodies.empty()) write_bodies(json, facts);
  json.end('}');
  json.key("trajectory").begin('{').field("name", options.trajectory_name);
  json.field("poses", header.poses).field("hash", hash_text(header.trajectory_hash));
  json.field("chainage_start", facts.options.conflicts.chainage_start);
  json.field("length", facts.searched.path);
  json.field("searched_length", facts.searched.whole);
  json.field("partly_searched_length", facts.searched.part).end('}').end('}');
}

/// Writes the stretches where bodies have no pose, so that nothing is known about them.
void write_unsearched(JsonText& json, const ReportFacts& facts) {
  const double start = facts.options.conflicts.chainage_start;
  json.key("unsearched").begin('[');
  for (const UnsearchedStretch& stretch : facts.unsearched) {
    json.begin('{').field("first_pose", std::uint64_t{stretch.first_pose});
    json.field("last_pose", std::uint64_t{stretch.last_pose});
    json.field("chainage_from", start + stretch.chainage_from);
    json.field("chainage_to", start + stretch.chainage_to);
    json.key("bodies").begin('[');
    for (const std::uint32_t body : stretch.bodies) json.value(facts.bodies[body].name);
    json.end(']').field("has_answer", stretch.has_answer).end('}');
  }
  json.end(']');
}

/// Writes what the search left out; null where it left out nothing.
void write_ignored_points(JsonText& json, const ResultHeader& header, const Answer& answer) {
  json.key("ignored");
  if (!header.ignores_points()) {
    json.raw("null");
    return;
  }
  json.begin('{').field("points", header.ignored.points);
  json.field("colliding", answer.ignored_colliding);
  json.field("what", ignored_text(header)).key("classes").begin('[');
  for (std::size_t i = 0; i < header.ignore_classes.size(); ++i) {
    json.begin('{').field("class", std::uint64_t{header.ignore_classes[i]});
    json.field("name", class_name(header.ignore_classes[i]));
    json.field("points", header.ignored.of_classes[i]).end('}');
  }
  json.end(']').key("boxes").begin('[');
  for (std::size_t i = 0; i < header.ignore_boxes.size(); ++i) {
    json.begin('{').field("lo", header.ignore_boxes[i].lo).field("hi", header.ignore_boxes[i].hi);
    json.field("points", header.ignored.in_boxes[i]).end('}');
  }
  json.end(']').end('}');
}

void write_query(JsonText& json, const ReportFacts& facts) {
  const ResultHeader& header = facts.result.reader().header();
  json.key("query").begin('{');
  for_each_field(kQueryValues, [&](const auto& field) {
    using Value = std::decay_t<decltype(field.of(header))>;
    if (!is_listed(field, header)) return;
    if constexpr (std::is_same_v<Value, std::optional<double>>) {
      json.field(field.key, *field.of(header));
    } else if constexpr (std::is_same_v<Value, std::uint32_t>) {
      json.field(field.key, std::uint64_t{field.of(header)});
    } else {
      json.field(field.key, field.of(header));
    }
  });
  json.end('}');
  write_ignored_points(json, header, facts.answer);
}

void write_classes(JsonText& json, const ReportFacts& facts) {
  json.key("classes").begin('[');
  for (std::size_t k = 0; k < facts.classes.size(); ++k) {
    json.begin('{').field("name", kClassNames[k]).field("below", facts.classes[k]);
    json.field("points", facts.points.of_class[k]);
    json.field("shown", facts.points.shown_class[k]).end('}');
  }
  json.end(']');
}

/// Writes the value of a column, if the row has one or the column is never left out.
template <typename Column, typename Row>
void write_finding(JsonText& json, const Column& column, const Row& row) {
  const auto& value = column.of(row);
  using Value = typename Column::Value;
  if constexpr (std::is_same_v<Value, Box>) {
    json.field("lo", value.lo).field("hi", value.hi);
  } else if constexpr (std::is_enum_v<Value>) {
    json.field(column.key, name_of(value));
  } else if constexpr (requires { value.has_value(); }) {
    if (value || !column.is_left_out) json.field(column.key, value);
  } else {
    json.field(column.key, value);
  }
}

/// Writes a conflict. rank: 1 for the worst of all.
void write_conflict(JsonText& json, const Conflict& conflict, std::size_t rank,
                    const ReportFacts& facts) {
  json.begin('{').field("rank", std::uint64_t{rank});
  for_each_field(kConflictColumns, [&](const auto& column) {
    if (column.is_in_files) write_finding(json, column, conflict);
  });
  if (conflict.certain) json.field("class", *conflict.certain ? "certain" : "possible");
  const auto place = conflict.nearest_source ? facts.points.places.find(*conflict.nearest_source)
                                             : facts.points.places.end();
  json.key("nearest_point");
  if (place == facts.points.places.end()) {
    json.raw("null");
  } else {
    json.value(place->second);
  }
  write_body(json, facts, conflict.body);
  json.end('}');
}

/// Writes the first group along the path that is too small for the list; null where there is none.
void write_first_small(JsonText& json, const Conflicts& found) {
  json.key("first_small");
  if (found.small.empty()) {
    json.raw("null");
    return;
  }
  const SmallGroup& first = found.small.front();
  json.begin('{').field("points", first.points).field("source", first.source);
  json.field("lo", first.box.lo).field("hi", first.box.hi);
  json.field("chainage_from", first.chainage_from).field("chainage_to", first.chainage_to);
  json.end('}');
}

/// A conflict and its rank, 1 for the worst.
using RankedConflict = std::pair<const Conflict*, std::size_t>;

/// The worst conflicts, at most kMostListedConflicts, in the order of their ids.
std::vector<RankedConflict> listed_in_page(const Conflicts& conflicts) {
  std::vector<const Conflict*> out;
  for (const Conflict& conflict : conflicts.listed) out.push_back(&conflict);
  const bool shifts = has_shifts(conflicts);
  std::ranges::sort(out,
                    [&](const Conflict* a, const Conflict* b) { return is_worse(*a, *b, shifts); });
  if (out.size() > kMostListedConflicts) out.resize(kMostListedConflicts);
  std::vector<RankedConflict> ranked;
  for (const Conflict* conflict : out) ranked.emplace_back(conflict, ranked.size() + 1);
  std::ranges::sort(ranked, {}, [](const RankedConflict& one) { return one.first->id; });
  return ranked;
}

void write_conflicts(JsonText& json, const ReportFacts& facts) {
  json.key("conflicts");
  if (facts.conflicts == nullptr) {
    json.raw("null");
    return;
  }
  const Conflicts& found = *facts.conflicts;
  const ConflictOptions& options = facts.options.conflicts;
  json.begin('{').field("count", std::uint64_t{found.listed.size()});
  json.field("gap", options.gap).field("min_points", options.min_points);
  json.field("split", options.split).field("groups", found.groups);
  json.field("small_groups", found.small_groups).field("small_points", found.small_points);
  write_first_small(json, found);
  json.field("longest_group", found.longest_group);
  json.field("longest_group_points", found.longest_group_points);
  const Conflict* worst = worst_of(found);
  json.key("worst");
  if (worst == nullptr) {
    json.raw("null");
  } else {
    json.value(std::uint64_t{worst->id});
  }
  json.key("list").begin('[');
  for (const auto& [conflict, rank] : listed_in_page(found)) {
    write_conflict(json, *conflict, rank, facts);
  }
  json.end(']').end('}');
}

void write_place(JsonText& json, const char* name, const std::optional<FoundPlace>& place) {
  const std::string prefix = name;
  json.field(name, place ? std::optional(place->distance) : std::nullopt);
  json.field((prefix + "_source").c_str(), place ? std::optional(place->source) : std::nullopt);
  json.field((prefix + "_pose").c_str(), place ? std::optional(place->pose) : std::nullopt);
}

void write_station_row(JsonText& json, const StationRow& row) {
  json.begin('{').field("chainage_from", row.chainage_from).field("chainage_to", row.chainage_to);
  if (row.station_from) json.field("station_from", row.station_from);
  if (row.station_to) json.field("station_to", row.station_to);
  write_place(json, "least", row.least);
  write_place(json, "left", row.left);
  write_place(json, "right", row.right);
  write_place(json, "above", row.above);
  json.field("verdict", name_of(row.verdict)).key("reasons").begin('[');
  for (const Reason reason : row.reasons) json.value(name_of(reason));
  json.end(']').key("doubts").begin('[');
  for (const std::string& code : row.doubts) json.value(code);
  json.end(']').field("searched", row.is_searched).key("overthrow").begin('[');
  for (const Overthrow& body : row.overthrow) {
    json.begin('{').field("end", body.end).field("middle", body.middle).end('}');
  }
  json.end(']').end('}');
}

/// Writes the table of stations; null where the result has no first poses.
void write_stations(JsonText& json, const ReportFacts& facts) {
  json.key("stations");
  if (facts.stations == nullptr) {
    json.raw("null");
    return;
  }
  json.begin('{').field("every", facts.every).key("bodies").begin('[');
  for (const std::string& name : facts.stations->bodies) json.value(name);
  json.end(']').key("notes").begin('[');
  for (const Message& message : facts.stations->warnings) json.value(message.text);
  json.end(']').key("list").begin('[');
  for (const StationRow& row : facts.stations->rows) write_station_row(json, row);
  json.end(']').end('}');
}

void write_shift(JsonText& json, const StretchShift& row) {
  json.begin('{').field("conflict", std::uint64_t{row.conflict}).field("shift", row.shift);
  json.field("least_distance", row.least_distance).end('}');
}

/// Writes the shifts that free the path and its conflicts; nothing where they were not given.
void write_shifts(JsonText& json, const ReportFacts& facts) {
  if (!facts.options.shifts) return;
  const ShiftTable& table = *facts.options.shifts;
  json.key("shifts").begin('{').field("lateral_from", table.lateral_from);
  json.field("lateral_to", table.lateral_to).field("step", table.step).key("path");
  write_shift(json, table.path);
  json.key("list").begin('[');
  for (const StretchShift& row : table.conflicts) write_shift(json, row);
  json.end(']').end('}');
}

void write_least(JsonText& json, const ReportFacts& facts) {
  json.key("least_distance");
  if (!facts.least) {
    json.raw("null");
    return;
  }
  json.begin('{').field("distance", facts.least->distance);
  json.field("pose", std::uint64_t{facts.least->pose}).field("chainage", facts.least_chainage);
  json.field("source", facts.least->source).field("point", facts.least->xyz);
  json.field("side", name_of(facts.least->side)).field("lateral", facts.least->lateral);
  write_body(json, facts, facts.least->body);
  json.field("height", facts.least->height).field("of", facts.least_of).end('}');
}

/// Writes how many points are inside solids of the model, and how deep; null where that is not
/// known.
void write_inside(JsonText& json, const ReportFacts& facts) {
  const ResultHeader& header = facts.result.reader().header();
  json.key("inside");
  if (header.model_solids == 0 || !(std::max(header.clearance, header.profile) > 0)) {
    json.raw("null");
    return;
  }
  const bool counts = header.clearance > 0;
  const double depth = facts.least ? std::max(0.0, -facts.least->distance) : 0;
  json.begin('{').field("points",
                        counts ? std::optional(facts.points.summary.inside_points) : std::nullopt);
  json.field("depth", depth).end('}');
}

void write_lattice(JsonText& json, const char* name, const PageLattice& lattice) {
  json.key(name).begin('{').field("origin", lattice.origin).field("step", lattice.step).end('}');
}

/// Writes how much of everything the page holds, and the units of its columns.
void write_page_facts(JsonText& json, const ReportFacts& facts) {
  json.key("page").begin('{');
  json.field("environment_points", std::uint64_t{facts.environment.points.size()});
  json.field("environment_near", facts.environment.near_points);
  json.field("environment_spacing", facts.environment.spacing);
  json.field("reach", facts.reach).field("dense_reach", facts.dense_reach);
  json.field("points", std::uint64_t{facts.points.points.size()});
  json.field("poses", std::uint64_t{facts.shown_poses});
  json.field("model_points", std::uint64_t{facts.shown_model_points});
  json.field("most_listed", std::uint64_t{kMostListedConflicts});
  write_lattice(json, "lattice", facts.lattice);
  write_lattice(json, "environment_lattice", facts.environment_lattice);
  write_lattice(json, "model_lattice", facts.model_lattice);
  json.field("rotation_step", kRotationStep).field("distance_step", kDistanceStep);
  json.field("no_distance", double{kNoDistance});
  json.field("chainage_step", kChainageStep).field("time_step", kTimeStep);
  const auto& times = facts.options.labels.time;
  json.field("time_origin", times.empty() ? 0.0 : times[0]);
  json.field("forward", std::uint64_t(facts.options.conflicts.forward));
  json.field("up", std::uint64_t(facts.options.conflicts.up)).end('}');
}

/// The error budget with its two margins, in the environment's unit; nothing without one.
void write_budget(JsonText& json, const Answer& answer) {
  if (!answer.budget) return;
  const ErrorBudget& b = *answer.budget;
  json.key("margins").begin('{').field("clear", b.clear()).field("conflict", b.conflict()).end('}');
  json.key("budget").begin('{').field("scan", b.scan).field("registration", b.registration);
  json.field("pose", b.pose).field("angle", b.angle).field("lever", b.lever);
  json.field("model", b.model).field("step", b.step).field("motion", b.motion);
  json.field("chord", b.chord).field("spacing", b.spacing).field("sigmas", b.sigmas).end('}');
  json.field("near_points", answer.near_points).field("certain_points", answer.certain.points);
}

void write_unseen_group(JsonText& json, const UnseenGroup& group, const ReportFacts& facts) {
  json.begin('{').field("id", std::uint64_t{group.id}).field("cubes", group.cubes);
  json.field("shown", shown_cubes(facts.unseen, group));
  json.field("lo", group.box.lo).field("hi", group.box.hi).field("middle", group.middle);
  json.field("first_pose", std::uint64_t{group.first_pose});
  json.field("last_pose", std::uint64_t{group.last_pose});
  json.field("chainage_from", group.chainage_from).field("chainage_to", group.chainage_to);
  json.field("side", name_of(group.side));
  json.key("seen");
  if (group.seen) {
    json.begin('{').field("lo", group.seen->lo).field("hi", group.seen->hi).end('}');
  } else {
    json.raw("null");
  }
  json.field("behind_conflict", group.behind_conflict).field("along_path", group.along_path);
  json.field("is_ground", group.is_ground).field("is_sky", group.is_sky).end('}');
}

/// Writes what is known of the space that the model sweeps; nothing where that was not asked for.
void write_seen(JsonText& json, const ReportFacts& facts) {
  if (!facts.answer.seen) return;
  json.key("seen");
  const SeenSummary& seen = *facts.answer.seen;
  const UnseenGroups& unseen = facts.unseen;
  json.begin('{').field("cube", seen.cube).field("swept", seen.swept).field("seen", seen.seen);
  json.field("unseen", seen.unseen).field("groups", seen.groups);
  json.field("listed_groups", seen.listed_groups).field("listed_cubes", seen.listed_cubes);
  json.field("not_scanned_length", seen.not_scanned_length);
  json.field("radius", facts.answer.budget
                           ? facts.answer.budget->near_radius(facts.answer.parameters.radius)
                           : facts.answer.parameters.radius);
  json.field("seen_min", std::uint64_t{facts.answer.parameters.seen_min});
  json.field("behind_conflicts", unseen.behind_conflicts);
  json.key("origins").begin('[');
  const auto& origins = facts.store.reader().metadata().origins;
  if (origins) {
    for (const OriginBasis& basis : origins->rest_on) {
      json.begin('{').field("what", basis.what).field("points", basis.points).end('}');
    }
  }
  json.end(']').field("points_without_origin",
                      origins ? origins->points_without : facts.answer.environment_points);
  json.field("places", std::uint64_t{origins ? origins->quanta.size() : 0});
  json.key("list").begin('[');
  for (const UnseenGroup& group : unseen.listed) write_unseen_group(json, group, facts);
  json.end(']').key("stretches").begin('[');
  for (const auto& [from, to] : unseen.stretches) json.begin('[').value(from).value(to).end(']');
  const UnseenFront& front = unseen.front;
  json.end(']').key("front").begin('{').field("cell", front.cell);
  json.field("columns", std::uint64_t{front.columns}).field("rows", std::uint64_t{front.rows});
  json.field("left", front.left).field("up", front.up);
  json.key("swept").begin('[');
  for (const double length : front.swept) json.value(length);
  json.end(']').key("unseen").begin('[');
  for (const double length : front.unseen) json.value(length);
  json.end(']').end('}').end('}');
}

void write_warnings(JsonText& json, const std::vector<Message>& warnings) {
  json.key("warnings").begin('[');
  for (const Message& warning : warnings) {
    json.begin('{').field("code", warning.code).field("message", warning.text);
    json.key("stretches").begin('[');
    for (const auto& [first, last] : warning.stretches) {
      json.begin('[').value(first).value(last).end(']');
    }
    json.end(']').end('}');
  }
  json.end(']');
}

}  // namespace

const Conflict* worst_of(const Conflicts& conflicts) {
  const bool shifts = has_shifts(conflicts);
  const auto worst = std::ranges::min_element(
      conflicts.listed,
      [&](const Conflict& a, const Conflict& b) { return is_worse(a, b, shifts); });
  return worst == conflicts.listed.end() ? nullptr : &*worst;
}

std::uint64_t shown_cubes(const UnseenGroups& unseen, const UnseenGroup& group) {
  if (unseen.middles.size() <= kMostShownCubes) return group.cubes;
  const double share =
      static_cast<double>(kMostShownCubes) / static_cast<double>(unseen.middles.size());
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(static_cast<double>(group.cubes) * share));
}

std::string json_of(const ReportFacts& facts) {
  JsonText json;
  json.begin('{').field("clearway", CLEARWAY_VERSION).field("title", facts.title);
  json.field("project", facts.options.project).field("client", facts.options.client);
  json.field("author", facts.options.author).field("date", facts.options.date);
  json.field("verdict", name_of(facts.answer.verdict()));
  json.key("reasons").begin('[');
  for (const Reason reason : facts.answer.reasons()) json.value(name_of(reason));
  json.end(']').key("doubts").begin('[');
  for (const std::string& code : facts.answer.doubts()) json.value(code);
  json.end(']');
  write_budget(json, facts.answer);
  write_seen(json, facts);
  json.field("colliding_points", facts.result.size());
  json.field("unit", facts.store.length_unit());
  write_least(json, facts);
  write_inside(json, facts);
  write_query(json, facts);
  write_inputs(json, facts);
  write_unsearched(json, facts);
  write_on_site(json, facts);
  write_warnings(json, facts.answer.warnings);
  write_classes(json, facts);
  write_conflicts(json, facts);
  write_stations(json, facts);
  if (facts.section != nullptr) {
    json.key("section");
    facts.section->write_facts(json);
  }
  write_shifts(json, facts);
  write_page_facts(json, facts);
  json.end('}');
  return json.text();
}

}  // namespace clearway
