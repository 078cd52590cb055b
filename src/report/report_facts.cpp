#include "report/report_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/describe/conflict.hpp"
#include "core/describe/labels.hpp"
#include "core/describe/query.hpp"
#include "core/describe/reports.hpp"
#include "core/describe/seen.hpp"
#include "core/describe/stations.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "findings/conflict_rank.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/ledger_words.hpp"
#include "io/result/floor_facts.hpp"
#include "io/result/result.hpp"
#include "io/store/store_metadata.hpp"
#include "io/store/store_reader.hpp"
#include "report/answer_words.hpp"
#include "report/shown_poses.hpp"

namespace clearway {
namespace {

constexpr const char* kClassNames[] = {"hit", "near", "watch"};

/// The number of triangles that belong to no solid.
std::uint64_t surface_triangles(const Model& model) {
  if (!model.is_solid()) return model.triangles.size();
  return static_cast<std::uint64_t>(std::ranges::count(model.solid_of, kNoSolid));
}

Json json_of(const DrawnBody& body) {
  return {{"name", body.name},
          {"points", body.model.vertices.size()},
          {"triangles", body.model.triangles.size()},
          {"solids", body.model.solid_count()},
          {"surface_triangles", surface_triangles(body.model)},
          {"poses", body.poses.size()},
          {"shown_points", body.shown_points},
          {"box", body.box}};
}

/// Adds the name of a body; nothing for a single model.
void add_body(Json& json, const ReportFacts& facts, const std::optional<std::uint32_t>& body) {
  if (body) json["body"] = facts.bodies[*body].name;
}

Json json_of_inputs(const ReportFacts& facts) {
  const ReportOptions& options = facts.options;
  const ResultHeader& header = facts.result.reader().header();
  const double spacing = header.notes.model_spacing;
  std::uint64_t surface = 0;
  for (const DrawnBody& body : facts.bodies) surface += surface_triangles(body.model);
  Json model{{"name", options.model_name},
             {"points", header.model_points},
             {"hash", hash_text(header.model_hash)},
             {"triangles", header.model_triangles},
             {"solids", header.model_solids},
             {"surface_triangles", surface},
             {"spacing", spacing > 0 ? Json(spacing) : Json()},  // of a mesh searched as points
             {"box", box_around(facts.bodies)}};
  if (const ModelAxes axes = header.notes.model_axes; axes.need_turn()) {
    model["axes"] = Json::array({name_of(axes.forward), name_of(axes.up)});
  }
  if (!header.bodies.empty()) {
    model["bodies"] = list_of(facts.bodies, [](const DrawnBody& body) { return json_of(body); });
  }
  return {{"result",
           {{"name", options.result_name}, {"hash", hash_text(facts.result.reader().identity())}}},
          {"environment",
           {{"name", options.environment_name},
            {"points", header.environment_points},
            {"hash", hash_text(header.environment_hash)},
            {"scans", json_of_scans(facts.store.reader().metadata())},
            {"box", facts.store.box()},
            {"crs_wkt", header.crs_wkt}}},
          {"model", std::move(model)},
          {"trajectory",
           {{"name", options.trajectory_name},
            {"made_by", options.labels.made_by},
            {"poses", header.poses},
            {"hash", hash_text(header.trajectory_hash)},
            {"chainage_start", facts.options.conflicts.chainage_start},
            {"length", facts.searched.path},
            {"searched_length", facts.searched.whole},
            {"partly_searched_length", facts.searched.part}}}};
}

/// The stretches where bodies have no pose, so that nothing is known about them.
Json json_of_unsearched(const ReportFacts& facts) {
  const double start = facts.options.conflicts.chainage_start;
  return list_of(facts.unsearched, [&](UnsearchedStretch stretch) {
    stretch.chainage_from += start;
    stretch.chainage_to += start;
    Json out = json_of_fact(stretch);
    for (Json& body : out["bodies"]) body = facts.bodies[body].name;
    return out;
  });
}

/// What the search left out; null where it left out nothing.
Json json_of_ignored_points(const ResultHeader& header, const Answer& answer) {
  if (!header.ignores_points()) return {};
  Json classes = Json::array(), boxes = Json::array();
  for (std::size_t i = 0; i < header.ignore_classes.size(); ++i) {
    classes.push_back({{"class", header.ignore_classes[i]},
                       {"name", class_name(header.ignore_classes[i])},
                       {"points", header.ignored.of_classes[i]}});
  }
  for (std::size_t i = 0; i < header.ignore_boxes.size(); ++i) {
    Json box = header.ignore_boxes[i];
    box["points"] = header.ignored.in_boxes[i];
    boxes.push_back(std::move(box));
  }
  return {{"points", header.ignored.points},
          {"colliding", answer.ignored_colliding},
          {"what", ignored_text(header)},
          {"classes", std::move(classes)},
          {"boxes", std::move(boxes)}};
}

Json json_of_query(const ReportFacts& facts) {
  const ResultHeader& header = facts.result.reader().header();
  Json out = Json::object();
  for_each_field(kQueryValues, [&](const auto& field) {
    if (is_listed(field, header)) out[field.key] = json_of_fact(field.of(header));
  });
  return out;
}

Json json_of_classes(const ReportFacts& facts) {
  Json out = Json::array();
  for (std::size_t k = 0; k < facts.classes.size(); ++k) {
    out.push_back({{"name", kClassNames[k]},
                   {"below", facts.classes[k]},
                   {"points", facts.points.of_class[k]},
                   {"shown", facts.points.shown_class[k]}});
  }
  return out;
}

/// Adds the value of a column, if the row has one or the column is never left out.
template <typename Column, typename Row>
void add_finding(Json& json, const Column& column, const Row& row) {
  const auto& value = column.of(row);
  using Value = typename Column::Value;
  if constexpr (std::is_same_v<Value, Box>) {
    json.update(Json(value));
  } else if constexpr (std::is_same_v<Value, std::optional<FoundPlace>>) {
    const std::string key = column.key;
    json[key] = value ? Json(value->distance) : Json();
    json[key + "_source"] = value ? Json(value->source) : Json();
    json[key + "_pose"] = value ? Json(value->pose) : Json();
  } else if (Json fact = json_of_fact(value); !fact.is_null() || !column.use.is_left_out) {
    json[column.key] = std::move(fact);
  }
}

/// What frees the vehicle from a conflict, in sentences.
std::string remedy_of(const Conflict& conflict, const ReportFacts& facts) {
  const ResultHeader& header = facts.result.reader().header();
  RemedyWords how{*facts.conflicts, symbol_of(unit_of(header))};
  how.metre = metres_per_unit(header);
  how.has_budget = header.budget.has_value();
  if (conflict.first_body) how.body = facts.bodies[*conflict.first_body].name;
  if (facts.options.shifts) how.shifts = &*facts.options.shifts;
  return remedy_words(conflict, how);
}

Json json_of(const Conflict& conflict, const ReportFacts& facts) {
  Json out = Json::object();
  for_each_field(kConflictColumns, [&](const auto& column) {
    if (column.use.is_in_files) add_finding(out, column, conflict);
  });
  if (conflict.certain) out["class"] = *conflict.certain ? "certain" : "possible";
  out["classified"] = class_words(conflict);
  out["remedy"] = remedy_of(conflict, facts);
  const auto place = conflict.nearest_source ? facts.points.places.find(*conflict.nearest_source)
                                             : facts.points.places.end();
  out["nearest_point"] = place == facts.points.places.end() ? Json() : Json(place->second);
  add_body(out, facts, conflict.body);
  return out;
}

/// The first group along the path that is too small for the list; null where there is none.
Json first_small(const Conflicts& found) {
  if (found.small.empty()) return {};
  using Group = SmallGroup;
  const Group& first = found.small.front();
  Json out = members_json<&Group::points, &Group::source>(first);
  out.update(Json(first.box));
  out.update(members_json<&Group::chainage_from, &Group::chainage_to>(first));
  return out;
}

/// The worst conflicts, at most kMostListedConflicts, in the order of their ids.
std::vector<const Conflict*> listed_in_page(const Conflicts& conflicts) {
  std::vector<const Conflict*> out = by_rank(conflicts);
  if (out.size() > kMostListedConflicts) out.resize(kMostListedConflicts);
  std::ranges::sort(out, {}, [](const Conflict* one) { return one->id; });
  return out;
}

Json json_of_conflicts(const ReportFacts& facts) {
  if (facts.conflicts == nullptr) return {};
  const Conflicts& found = *facts.conflicts;
  const Conflict* worst = worst_of(found);
  Json out{{"count", found.listed.size()}};
  out.update(members_json<&Conflicts::gap, &Conflicts::min_points, &Conflicts::spacing>(found));
  out["split"] = facts.options.conflicts.split;
  out.update(
      members_json<&Conflicts::groups, &Conflicts::small_groups, &Conflicts::small_points>(found));
  out["first_small"] = first_small(found);
  out["worst"] = worst == nullptr ? Json() : Json(worst->id);
  out["list"] =
      list_of(listed_in_page(found), [&](const Conflict* one) { return json_of(*one, facts); });
  return out;
}

Json json_of(const StationRow& row) {
  Json out = Json::object();
  for_each_field(kStationColumns, [&](const auto& column) { add_finding(out, column, row); });
  if (!row.station_from) out.erase("station_from");
  if (!row.station_to) out.erase("station_to");
  return out;
}

/// The table of stations; null where the result has no first poses.
Json json_of_stations(const ReportFacts& facts) {
  if (!facts.stations) return {};
  return {
      {"every", facts.every},
      {"bodies", facts.stations->bodies},
      {"notes", list_of(facts.stations->warnings, [](const Message& one) { return one.text; })},
      {"list", list_of(facts.stations->rows, [](const StationRow& row) { return json_of(row); })}};
}

Json json_of(const StretchShift& row) {
  return members_json<&StretchShift::conflict, &StretchShift::shift, &StretchShift::least_distance,
                      &StretchShift::warned_of>(row);
}

Json json_of(const ShiftTable& table) {
  Json out =
      members_json<&ShiftTable::lateral_from, &ShiftTable::lateral_to, &ShiftTable::step>(table);
  out["path"] = json_of(table.path);
  out["list"] = list_of(table.conflicts, [](const StretchShift& row) { return json_of(row); });
  return out;
}

/// What the ledger says of the listed conflicts and of its rows.
Json json_of_ledger(const ReportFacts& facts) {
  const Ledger& ledger = *facts.options.ledger;
  Json out{{"name", facts.options.ledger_name}, {"sentence", ledger_sentence(ledger)}};
  out.update(ledger_json(ledger));
  if (ledger.conflicts.size() <= kMostListedConflicts) return out;
  out["conflicts"] = list_of(listed_in_page(*facts.conflicts),
                             [&](const Conflict* one) { return out["conflicts"][one->id - 1]; });
  return out;
}

Json json_of_least(const ReportFacts& facts) {
  if (!facts.least) return {};
  using Least = LeastDistance;
  const Least& least = *facts.least;
  Json out = members_json<&Least::distance, &Least::pose, &Least::chainage, &Least::source>(least);
  out["point"] = least.xyz;
  out.update(members_json<&Least::side, &Least::lateral>(least));
  add_body(out, facts, least.body_number);
  out.update(members_json<&Least::height, &Least::of>(least));
  out["point_class"] = class_words(least.point_class.value_or(0));
  return out;
}

/// How many points are inside solids of the model, and how deep; null where that is not known.
Json json_of_inside(const ReportFacts& facts) {
  const ResultHeader& header = facts.result.reader().header();
  if (header.model_solids == 0 || !(std::max(header.clearance, header.profile) > 0)) return {};
  return {{"points", header.clearance > 0 ? Json(facts.points.summary.inside_points) : Json()},
          {"depth", facts.least ? std::max(0.0, -facts.least->distance) : 0.0}};
}

Json json_of(const PageLattice& lattice) {
  return members_json<&PageLattice::origin, &PageLattice::step>(lattice);
}

/// The labels that the path has, in the order in which sentences of the page name them; of numbers
/// also how their column counts.
Json json_of_labels(const PoseLabels& labels) {
  Json list = Json::array();
  for_each_label({LabelPlace::kBesideChainage, LabelPlace::kFirst, LabelPlace::kNext},
                 [&](const auto& label) {
                   const auto& values = label.of(labels);
                   if (values.empty()) return;
                   Json json{{"key", label.key}, {"title", label.title}};
                   if constexpr (!std::decay_t<decltype(label)>::is_text()) {
                     json["unit"] = symbol_of(label.unit);
                     json["step"] = kLabelStep;
                     json["origin"] = origin_on_page(label, values);
                   }
                   list.push_back(std::move(json));
                 });
  return list;
}

/// How much of everything the page holds, and the units of its columns.
Json json_of_page(const ReportFacts& facts) {
  return {{"environment_points", facts.environment.points.size()},
          {"environment_near", facts.environment.near_points},
          {"environment_spacing", facts.environment.spacing},
          {"reach", facts.reach},
          {"dense_reach", facts.dense_reach},
          {"points", facts.points.points.size()},
          {"poses", facts.shown_poses},
          {"model_points", facts.shown_model_points},
          {"most_listed", kMostListedConflicts},
          {"lattice", json_of(facts.lattice)},
          {"environment_lattice", json_of(facts.environment_lattice)},
          {"model_lattice", json_of(facts.model_lattice)},
          {"rotation_step", kRotationStep},
          {"distance_step", kDistanceStep},
          {"no_distance", kNoDistance},
          {"chainage_step", kChainageStep},
          {"labels", json_of_labels(facts.options.labels)},
          {"forward", static_cast<unsigned>(facts.options.conflicts.forward)},
          {"up", static_cast<unsigned>(facts.options.conflicts.up)}};
}

/// Adds the error budget with its two margins, in the environment's unit; nothing without one.
void add_budget(Json& json, const Answer& answer) {
  if (!answer.budget) return;
  using Budget = ErrorBudget;
  json["margins"] = members_json<&Budget::clear, &Budget::conflict>(*answer.budget);
  json["budget"] = members_json<&Budget::scan, &Budget::registration, &Budget::pose, &Budget::angle,
                                &Budget::lever, &Budget::model, &Budget::step, &Budget::motion,
                                &Budget::chord, &Budget::spacing, &Budget::sigmas>(*answer.budget);
  json["near_points"] = answer.near_points;
  json["certain_points"] = answer.certain.points;
}

Json json_of(const UnseenGroup& group, const ReportFacts& facts) {
  using Group = UnseenGroup;
  Json out = members_json<&Group::id, &Group::cubes>(group);
  out["shown"] = shown_cubes(facts.unseen, group);
  out.update(Json(group.box));
  out.update(
      members_json<&Group::middle, &Group::first_pose, &Group::last_pose, &Group::chainage_from,
                   &Group::chainage_to, &Group::side, &Group::seen, &Group::behind_conflict,
                   &Group::along_path, &Group::is_ground, &Group::is_sky>(group));
  return out;
}

/// What is known of the space that the model sweeps.
Json json_of(const SeenSummary& seen, const ReportFacts& facts) {
  const UnseenGroups& unseen = facts.unseen;
  const Answer& answer = facts.answer;
  const auto& origins = facts.store.reader().metadata().origins;
  Json out;
  for_each_field(kSeenColumns, [&](const auto& column) { out[column.key] = column.of(seen); });
  out["radius"] = answer.budget ? answer.budget->near_radius(answer.parameters.radius)
                                : answer.parameters.radius;
  out["seen_min"] = answer.parameters.seen_min;
  out["behind_conflicts"] = unseen.behind_conflicts;
  out["origins"] = Json::array();
  for (const OriginBasis& basis : origins ? origins->rest_on : std::vector<OriginBasis>{}) {
    out["origins"].push_back(members_json<&OriginBasis::what, &OriginBasis::points>(basis));
  }
  out["points_without_origin"] = origins ? origins->points_without : answer.environment_points;
  out["places"] = origins ? origins->quanta.size() : 0;
  out["list"] = list_of(unseen.listed, [&](const UnseenGroup& one) { return json_of(one, facts); });
  out["stretches"] = unseen.stretches;
  using Front = UnseenFront;
  out["front"] = members_json<&Front::cell, &Front::columns, &Front::rows, &Front::left, &Front::up,
                              &Front::swept, &Front::unseen>(unseen.front);
  return out;
}

Json json_of_warnings(const std::vector<Message>& warnings) {
  return list_of(warnings, [](const Message& warning) -> Json {
    return {{"code", warning.code}, {"message", warning.text}, {"stretches", warning.stretches}};
  });
}

}  // namespace

Json json_of_scans(const StoreMetadata& store) {
  constexpr std::size_t kMostNames = 10;
  Json names = Json::array();
  for (const SourceFile& source : store.sources) {
    if (names.size() == kMostNames) break;
    names.push_back(source.name);
  }
  const ScanDates& dates = store.dates;
  return {{"files", store.sources.size()},
          {"names", std::move(names)},
          {"first_date", dates.known() ? Json(dates.first) : Json()},
          {"last_date", dates.known() ? Json(dates.last) : Json()}};
}

std::uint64_t shown_cubes(const UnseenGroups& unseen, const UnseenGroup& group) {
  if (unseen.middles.size() <= kMostShownCubes) return group.cubes;
  const double share =
      static_cast<double>(kMostShownCubes) / static_cast<double>(unseen.middles.size());
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(static_cast<double>(group.cubes) * share));
}

namespace {

/// The answer in the words that other outputs have.
void add_words(Json& out, const ReportFacts& facts) {
  const Answer& answer = facts.answer;
  PathWords path{facts.options.labels, facts.chainage};
  for (double& chainage : path.chainage) chainage += facts.options.conflicts.chainage_start;
  const AnswerWords words =
      answer_words(answer, path, symbol_of(unit_of(facts.result.reader().header())));
  const std::pair<const char*, const std::string&> clauses[] = {
      {"finding", words.finding}, {"seen", words.seen},         {"nearest", words.nearest},
      {"spacing", words.spacing}, {"searched", words.searched}, {"doubt", words.doubt},
      {"floor", words.floor},     {"ignored", words.ignored}};
  for (const auto& [name, clause] : clauses) out["words"][name] = sentence_of(clause);
  for (std::size_t i = 0; i < kSideWords.size(); ++i) {
    const char* const side = name_of(static_cast<Side>(i));
    out["side_words"][side] = Json::array({kSideWords[i].on, kSideWords[i].from});
  }
  const std::vector<std::string> doubts = answer.doubts();
  out["verdict_words"] = verdict_words(answer.verdict(), !answer.warnings.empty());
  out["reason_words"] = Json::array();
  for (const Reason reason : answer.reasons()) {
    out["reason_words"].push_back(
        reason == Reason::kQuestionInDoubt ? doubt_words(doubts) : reason_words(reason, doubts));
  }
}

}  // namespace

std::string json_of(const ReportFacts& facts) {
  const Answer& answer = facts.answer;
  Json out = page_head(facts.options, facts.title);
  out["verdict"] = name_of(answer.verdict());
  out["reasons"] = json_of_fact(answer.reasons());
  out["doubts"] = answer.doubts();
  add_words(out, facts);
  add_budget(out, answer);
  if (answer.seen) out["seen"] = json_of(*answer.seen, facts);
  out["colliding_points"] = facts.result.size();
  out["classified"] = facts.conflicts == nullptr
                          ? classified_words(facts.points.summary.classes, facts.result.size())
                          : classified_words(facts.conflicts->classes,
                                             facts.result.size() + facts.conflicts->near_points);
  out["unit"] = facts.store.length_unit();
  out["touching"] = kTouching / metres_per_unit(facts.result.reader().header());
  out["least_distance"] = json_of_least(facts);
  out["inside"] = json_of_inside(facts);
  out["query"] = json_of_query(facts);
  out["ignored"] = json_of_ignored_points(facts.result.reader().header(), answer);
  out["floor"] = floor_json(answer);
  if (answer.floor_colliding) {
    out["floor"]["words"] =
        floor_words(out["floor"], symbol_of(unit_of(facts.result.reader().header())));
  }
  out["inputs"] = json_of_inputs(facts);
  out["unsearched"] = json_of_unsearched(facts);
  out["on_site"] = on_site(facts);
  out["warnings"] = json_of_warnings(answer.warnings);
  out["classes"] = json_of_classes(facts);
  out["conflicts"] = json_of_conflicts(facts);
  out["stations"] = json_of_stations(facts);
  if (facts.section) out["section"] = facts.section->facts();
  if (facts.options.shifts) out["shifts"] = json_of(*facts.options.shifts);
  if (facts.options.ledger) out["ledger"] = json_of_ledger(facts);
  out["page"] = json_of_page(facts);
  return page_text(out);
}

}  // namespace clearway
