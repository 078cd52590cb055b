#include "io/result/result_header.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/geometry/axes.hpp"
#include "core/geometry/floor.hpp"
#include "core/query/error_budget.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/table_file.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

/// Whether a query may have this box: its corners are finite and in order.
bool is_box(const Box& box) {
  for (int k = 0; k < 3; ++k) {
    if (!(box.lo[k] <= box.hi[k]) || !std::isfinite(box.lo[k]) || !std::isfinite(box.hi[k])) {
      return false;
    }
  }
  return true;
}

void check_lists(const ResultHeader& header, const std::string& name) {
  QueryParameters sorted = header;
  sort_ignored(sorted);
  const bool boxes = std::all_of(header.ignore_boxes.begin(), header.ignore_boxes.end(), is_box);
  if (!boxes || sorted.ignore_classes != header.ignore_classes ||
      sorted.ignore_boxes != header.ignore_boxes ||
      header.ignored.of_classes.size() != header.ignore_classes.size() ||
      header.ignored.in_boxes.size() != header.ignore_boxes.size()) {
    refuse(name, "'ignored': expected classes and boxes in ascending order, and points of each");
  }
  const std::uint64_t most = header.environment_points;
  const auto is_too_many = [most](std::uint64_t points) { return points > most; };
  const IgnoredPointCounts& counts = header.ignored;
  if (is_too_many(counts.points) ||
      std::any_of(counts.of_classes.begin(), counts.of_classes.end(), is_too_many) ||
      std::any_of(counts.in_boxes.begin(), counts.in_boxes.end(), is_too_many)) {
    refuse(name, "'ignored' counts more points than the environment has, " + std::to_string(most));
  }
}

std::string text_of(const ModelAxes& axes) {
  return std::string(name_of(axes.forward)) + "," + name_of(axes.up);
}

/// "+y,+z" for a model whose y axis pointed ahead and whose z axis up.
ModelAxes axes_of(const std::string& text, const HeaderValues& values) {
  for (int forward = 0; forward < 6; ++forward) {
    for (int up = 0; up < 6; ++up) {
      const ModelAxes axes{static_cast<Axis>(forward), static_cast<Axis>(up)};
      if (!along_one_line(axes.forward, axes.up) && text_of(axes) == text) return axes;
    }
  }
  values.refuse_fact("model_axes",
                     "the axes that point ahead and up, for example +y,+z, found " + excerpt(text));
}

/// A number that has to be finite and 0 or above.
void check_length(double length, const char* what, const std::string& name) {
  if (length >= 0 && std::isfinite(length)) return;
  refuse(name, std::string(what) + " is " + format_number(length) +
                   ", expected a finite number, 0 or above");
}

void check_budget(const ErrorBudget& b, double gap, const std::string& name) {
  for (const double number : {b.scan, b.registration, b.pose, b.angle, b.model, b.sigmas, b.step,
                              b.lever, b.motion, b.chord, b.spacing}) {
    check_length(number, "a number of the error budget", name);
  }
  if (!(gap > 0) || !std::isfinite(gap)) {
    refuse(name, "the error budget has the gap " + format_number(gap) + ", expected one above 0");
  }
}

void check_searched(const SearchedLength& read, const std::string& name) {
  const bool sound = std::isfinite(read.path) && read.whole >= 0 && read.whole <= read.path &&
                     read.part >= 0 && read.part <= read.path;
  if (sound) return;
  refuse(name, "the searched lengths are " + format_number(read.whole) + " and " +
                   format_number(read.part) +
                   ", expected lengths up to that of the path, which is " +
                   format_number(read.path));
}

void check_seen(const SeenSummary& seen, const std::string& name) {
  if (seen.unseen > seen.swept || seen.groups > seen.unseen || seen.listed_groups > seen.groups ||
      seen.listed_cubes > seen.unseen || !(seen.cube > 0) || !(seen.not_scanned_length >= 0)) {
    refuse(name, "the numbers of swept and unseen cubes contradict each other");
  }
}

void check_at_most(std::uint64_t count, std::uint64_t most, const char* fact,
                   const std::string& name) {
  if (count <= most) return;
  refuse(name, "'" + std::string(fact) + "' is " + std::to_string(count) + ", expected at most " +
                   std::to_string(most));
}

void check_header(const ResultHeader& header, const std::string& name) {
  if (header.bodies.size() > kMostBodies || std::ranges::count(header.bodies, "") > 0 ||
      (!header.body_floors.empty() && header.body_floors.size() != header.bodies.size())) {
    refuse(name, "'bodies': expected at most " + std::to_string(kMostBodies) +
                     " names, and a floor of each or of none");
  }
  if (header.ignores_points()) check_lists(header, name);
  check_length(header.profile, "'profile'", name);
  check_length(header.notes.model_spacing, "'model_spacing'", name);
  if (!is_box(header.model_box)) {
    refuse(name, "'model_box': expected two finite corners, the least x, y, z first");
  }
  if (header.budget) check_budget(*header.budget, header.gap, name);
  if (header.part && !header.part->shard.is_valid()) {
    refuse(name, "'shard' is " + to_string(header.part->shard) + ", expected a part of at most " +
                     std::to_string(Shard::kMost));
  }
}

void check_findings(const ResultFindings& findings, const ResultHeader& header,
                    const std::string& name) {
  check_at_most(findings.ignored_colliding, header.ignored.points, "ignored_colliding", name);
  check_at_most(findings.ignored_colliding_high, findings.ignored_colliding,
                "ignored_colliding_high", name);
  check_at_most(findings.floor_colliding.value_or(0), header.environment_points, "floor_colliding",
                name);
  if ((header.floor || !header.body_floors.empty()) && !findings.floor_colliding) {
    refuse(name, "'floor_colliding' is missing");
  }
  if (findings.floor_colliding && !header.bodies.empty() && header.body_floors.empty()) {
    refuse(name, "'body_floors' is missing; run it again");
  }
  if (findings.seen.has_value() != header.seen ||
      findings.certain.has_value() != header.budget.has_value() ||
      findings.searched.has_value() == header.bodies.empty()) {
    refuse(name, "its findings are not those of its question");
  }
  if (findings.seen) check_seen(*findings.seen, name);
  if (findings.searched) check_searched(*findings.searched, name);
  std::int64_t last = -1;
  for (const auto& [first, end] : findings.without_bodies) {
    if (first <= last || end < first || end >= header.poses) {
      refuse(name, "'poses_without_bodies': expected runs of poses that ascend");
    }
    last = end;
  }
}

}  // namespace

// What the header of a file keeps of each part of a result, found by HeaderValues.

/// What a question ignores, and how much that is.
struct IgnoredFacts {
  ResultHeader& of;
};

static void keep_facts(HeaderValues& values, IgnoredFacts& ignored) {
  values.add("classes", ignored.of.ignore_classes);
  values.add("class_points", ignored.of.ignored.of_classes);
  values.add("boxes", ignored.of.ignore_boxes);
  values.add("box_points", ignored.of.ignored.in_boxes);
  values.add("points", ignored.of.ignored.points);
}

static void keep_facts(HeaderValues& values, Shard& shard) {
  values.add("number", shard.number);
  values.add("count", shard.count);
}

static void keep_facts(HeaderValues& values, ResultPart& part) {
  values.add("shard", part.shard);
  values.add("division", part.division);
  values.add("store", part.store);
}

static void keep_facts(HeaderValues& values, SeenSummary& seen) {
  values.add("cube_side", seen.cube);
  values.add("swept_cubes", seen.swept);
  values.add("unseen_cubes", seen.unseen);
  values.add("unseen_groups", seen.groups);
  values.add("listed_groups", seen.listed_groups);
  values.add("listed_cubes", seen.listed_cubes);
  values.add("not_scanned_length", seen.not_scanned_length);
  seen.seen = seen.swept - seen.unseen;
}

static void keep_facts(HeaderValues& values, CertainPoints& certain) {
  values.add("points", certain.points);
  values.add("has_group", certain.has_group);
}

static void keep_facts(HeaderValues& values, SearchedLength& searched) {
  values.add("path", searched.path);
  values.add("whole", searched.whole);
  values.add("part", searched.part);
}

static void keep_facts(HeaderValues& values, ResultHeader& header) {
  values.add("environment_points", header.environment_points);
  values.add("environment_hash", header.environment_hash);
  values.add("classes_hash", header.classes_hash);
  values.add("model_points", header.model_points);
  values.add("model_hash", header.model_hash);
  values.add("model_triangles", header.model_triangles);
  values.add("model_solids", header.model_solids);
  values.add("model_box", header.model_box);
  values.add("poses", header.poses);
  values.add("trajectory_hash", header.trajectory_hash);
  values.add("crs_wkt", header.crs_wkt);
  values.add("scale", header.quantisation.scale);
  values.add("offset", header.quantisation.offset);
  values.add_fields(kQueryValues, static_cast<QueryParameters&>(header));
  values.add("model_spacing", header.notes.model_spacing);
  std::string axes = text_of(header.notes.model_axes);
  values.add("model_axes", axes);
  if (values.reads()) header.notes.model_axes = axes_of(axes, values);
  values.add("length_unit", header.notes.length_unit);
  values.add("inputs_hash", header.notes.inputs_hash);
  values.add_if(!header.bodies.empty(), "bodies", header.bodies);
  values.add_if(!header.body_floors.empty(), "body_floors", header.body_floors);
  if (values.reads()) header.budget = given_errors(header);
  if (header.budget) {
    values.add("budget_step", header.budget->step);
    values.add("budget_lever", header.budget->lever);
    values.add("budget_motion", header.budget->motion);
    values.add("budget_chord", header.budget->chord);
    values.add("budget_spacing", header.budget->spacing);
  }
  IgnoredFacts ignored{header};
  values.add_if(header.ignores_points(), "ignored", ignored);
  values.add("part", header.part);
}

static void keep_facts(HeaderValues& values, ResultFindings& findings) {
  values.add("warnings", findings.warnings);
  values.add_if(findings.scanned.known(), "scanned", findings.scanned);
  values.add("withheld_points", findings.withheld_points);
  values.add("ignored_colliding", findings.ignored_colliding);
  values.add("ignored_colliding_high", findings.ignored_colliding_high);
  values.add("floor_colliding", findings.floor_colliding);
  values.add("certain", findings.certain);
  values.add("seen_space", findings.seen);
  values.add("searched", findings.searched);
  values.add_if(!findings.without_bodies.empty(), "poses_without_bodies", findings.without_bodies);
}

LengthUnit unit_of(const ResultHeader& header) { return length_unit_of(header.notes.length_unit); }

double metres_per_unit(const ResultHeader& header) {
  const double metres = metres_of(unit_of(header));
  return metres > 0 ? metres : 1;
}

std::string environment_text(const ResultHeader& header) {
  return std::to_string(header.environment_points) + " points, hash " +
         hash_text(header.environment_hash);
}

const char* model_as(std::uint64_t solids, std::uint64_t triangles) {
  return solids > 0 ? "solid" : triangles > 0 ? "surface" : "points";
}

Json result_facts(ResultHeader header, ResultFindings findings) {
  if (!header.bodies.empty() && !findings.searched) findings.searched.emplace();
  Json facts = Json::object();
  HeaderValues values(facts);
  keep_facts(values, header);
  keep_facts(values, findings);
  return facts;
}

void read_result_facts(const TableFile& file, ResultHeader& header, ResultFindings& findings) {
  HeaderValues values(file.header(), file.name());
  keep_facts(values, header);
  check_header(header, file.name());
  keep_facts(values, findings);
  check_findings(findings, header, file.name());
}

}  // namespace clearway
