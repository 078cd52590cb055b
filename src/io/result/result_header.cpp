#include "io/result/result_header.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/geometry/axes.hpp"
#include "core/geometry/floor.hpp"
#include "core/query/error_budget.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/input_error.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result_names.hpp"

namespace clearway {
namespace {

namespace names = result_names;

std::vector<double> as_rows(const std::vector<Box>& boxes) {
  std::vector<double> rows;
  for (const Box& box : boxes) {
    rows.insert(rows.end(), {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  return rows;
}

std::vector<Box> as_boxes(const std::vector<double>& rows) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < rows.size(); i += 6) {
    boxes.push_back({{rows[i], rows[i + 1], rows[i + 2]}, {rows[i + 3], rows[i + 4], rows[i + 5]}});
  }
  return boxes;
}

std::uint64_t hash_of(const ResultHeader& header) {
  ColumnHashes hashes;
  hashes.add(header.ignore_classes);
  hashes.add(header.ignored.of_classes);
  hashes.add(as_rows(header.ignore_boxes));
  hashes.add(header.ignored.in_boxes);
  return hashes.digest();
}

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
  if (!header.ignores_points() || !boxes || sorted.ignore_classes != header.ignore_classes ||
      sorted.ignore_boxes != header.ignore_boxes) {
    refuse(name, "group 'ignored': expected classes and boxes in ascending order, one at least");
  }
  const std::uint64_t most = header.environment_points;
  const auto is_too_many = [most](std::uint64_t points) { return points > most; };
  const IgnoredPointCounts& counts = header.ignored;
  if (is_too_many(counts.points) ||
      std::any_of(counts.of_classes.begin(), counts.of_classes.end(), is_too_many) ||
      std::any_of(counts.in_boxes.begin(), counts.in_boxes.end(), is_too_many)) {
    refuse(name,
           "group 'ignored' counts more points than the environment has, " + std::to_string(most));
  }
}

/// Writes what a result ignores: the group /ignored and its attributes.
void write_ignored(const hdf5::Id& file, const ResultHeader& header) {
  const hdf5::Id group = hdf5::create_group(file, names::kIgnoredGroup);
  hdf5::write_dataset<std::uint8_t>(group, names::kClassesIgnored, header.ignore_classes);
  hdf5::write_dataset<std::uint64_t>(group, names::kClassPoints, header.ignored.of_classes);
  hdf5::write_dataset<double>(group, names::kBoxes, as_rows(header.ignore_boxes), 6);
  hdf5::write_dataset<std::uint64_t>(group, names::kBoxPoints, header.ignored.in_boxes);
  hdf5::write_number(file, names::kIgnoredPoints, header.ignored.points);
  hdf5::write_number(file, names::kIgnoredHash, hash_of(header));
}

/// Reads the group /ignored and its attributes into `header`. name: the file's, for messages.
/// Throws InputError where the group is damaged or has contents that no run writes.
void read_ignored(const hdf5::Id& file, const std::string& name, ResultHeader& header) {
  const hdf5::Id group = hdf5::open_group(file, names::kIgnoredGroup, name);
  const std::uint64_t classes = hdf5::dataset_rows(group, names::kClassesIgnored, name);
  const std::uint64_t boxes = hdf5::dataset_rows(group, names::kBoxes, name);
  header.ignore_classes =
      hdf5::read_dataset<std::uint8_t>(group, names::kClassesIgnored, classes, 0, name);
  header.ignored.of_classes =
      hdf5::read_dataset<std::uint64_t>(group, names::kClassPoints, classes, 0, name);
  header.ignore_boxes = as_boxes(hdf5::read_dataset<double>(group, names::kBoxes, boxes, 6, name));
  header.ignored.in_boxes =
      hdf5::read_dataset<std::uint64_t>(group, names::kBoxPoints, boxes, 0, name);
  header.ignored.points = hdf5::read_number<std::uint64_t>(file, names::kIgnoredPoints, name);
  if (hash_of(header) != hdf5::read_number<std::uint64_t>(file, names::kIgnoredHash, name)) {
    refuse(name, "group 'ignored' is damaged (its hash is not the one recorded)");
  }
  check_lists(header, name);
}

/// Checks the attributes `format`, `version` and `complete`. Returns whether the file is a part
/// rather than a whole result.
bool read_format(const hdf5::Id& file, const std::string& name) {
  const std::string format = hdf5::has_attribute(file, "format", name)
                                 ? hdf5::read_text_attribute(file, "format", name)
                                 : "";
  if (format != names::kFormat && format != names::kPartFormat) {
    throw InputError(name + ": attribute 'format': expected \"" + names::kFormat +
                     "\"; this HDF5 file is not a result of clearway run");
  }
  const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
  if (version != names::kVersion) {
    throw InputError(name + ": is a result of version " + std::to_string(version) +
                     " of another release; run it again");
  }
  if (!hdf5::has_attribute(file, "complete", name) ||
      hdf5::read_number<std::uint8_t>(file, "complete", name) != 1) {
    throw InputError(name + ": not complete: the run that wrote it was interrupted");
  }
  return format == names::kPartFormat;
}

// How values of every type are kept as an attribute. name: the file's, for messages.

template <typename Number>
requires std::is_arithmetic_v<Number>
void write_value(const hdf5::Id& file, const char* attribute, Number value) {
  using Kept = std::conditional_t<std::is_same_v<Number, bool>, std::uint8_t, Number>;
  hdf5::write_number(file, attribute, static_cast<Kept>(value));
}

template <typename Number>
requires std::is_arithmetic_v<Number>
void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                Number& value) {
  using Kept = std::conditional_t<std::is_same_v<Number, bool>, std::uint8_t, Number>;
  value = static_cast<Number>(hdf5::read_number<Kept>(file, attribute, name));
}

/// An error that was not given has no attribute.
void write_value(const hdf5::Id& file, const char* attribute, const std::optional<double>& value) {
  if (value) hdf5::write_number(file, attribute, *value);
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                std::optional<double>& value) {
  if (!hdf5::has_attribute(file, attribute, name)) return;
  value = hdf5::read_number<double>(file, attribute, name);
}

void write_value(const hdf5::Id& file, const char* attribute, const std::string& text) {
  hdf5::write_attribute(file, attribute, text);
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                std::string& text) {
  text = hdf5::read_text_attribute(file, attribute, name);
}

void write_value(const hdf5::Id& file, const char* attribute, const double (&axes)[3]) {
  hdf5::write_attribute(file, attribute, std::span<const double>(axes));
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                double (&axes)[3]) {
  std::ranges::copy(hdf5::read_attribute<double>(file, attribute, 3, name), axes);
}

void write_value(const hdf5::Id& file, const char* attribute, const Box& box) {
  const Vec3 corners[]{box.lo, box.hi};
  hdf5::write_attribute(file, attribute, as_numbers(std::span(corners)), 3);
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name, Box& box) {
  const auto n = hdf5::read_attribute<double>(file, attribute, 6, name);
  box = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

void write_value(const hdf5::Id& file, const char* attribute, const Shard& shard) {
  const std::uint32_t numbers[]{shard.number, shard.count};
  hdf5::write_attribute(file, attribute, std::span<const std::uint32_t>(numbers));
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                Shard& shard) {
  const auto numbers = hdf5::read_attribute<std::uint32_t>(file, attribute, 2, name);
  shard = {numbers[0], numbers[1]};
}

std::string text_of(const ModelAxes& axes) {
  return std::string(name_of(axes.forward)) + "," + name_of(axes.up);
}

/// "+y,+z" for a model whose y axis pointed ahead and whose z axis up.
void write_value(const hdf5::Id& file, const char* attribute, const ModelAxes& axes) {
  hdf5::write_attribute(file, attribute, text_of(axes));
}

void read_value(const hdf5::Id& file, const char* attribute, const std::string& name,
                ModelAxes& axes) {
  const std::string found = hdf5::read_text_attribute(file, attribute, name);
  for (int forward = 0; forward < 6; ++forward) {
    for (int up = 0; up < 6; ++up) {
      axes = {static_cast<Axis>(forward), static_cast<Axis>(up)};
      if (!along_one_line(axes.forward, axes.up) && text_of(axes) == found) return;
    }
  }
  refuse(name, "attribute '" + std::string(attribute) + "' is " + excerpt(found) +
                   ", expected the axes that point ahead and up, for example +y,+z");
}

using Q = ResultQuestion;

/// The attributes of the file beside the values of the query: the members that they keep, and their
/// names.
constexpr std::tuple kQuestion{Field{&Q::environment_points, "environment_points"},
                               Field{&Q::environment_hash, "environment_hash"},
                               Field{&Q::classes_hash, "classes_hash"},
                               Field{&Q::model_points, "model_points"},
                               Field{&Q::model_hash, "model_hash"},
                               Field{&Q::model_triangles, "model_triangles"},
                               Field{&Q::model_solids, "model_solids"},
                               Field{&Q::model_box, "model_box"},
                               Field{&Q::poses, "poses"},
                               Field{&Q::trajectory_hash, "trajectory_hash"},
                               Field{&Q::crs_wkt, "crs_wkt"}};
constexpr std::tuple kQuantisation{Field{&Quantisation::scale, "scale"},
                                   Field{&Quantisation::offset, "offset"}};
constexpr std::tuple kNotes{Field{&ResultNotes::model_spacing, "model_spacing"},
                            Field{&ResultNotes::model_axes, "model_axes"},
                            Field{&ResultNotes::length_unit, "length_unit"},
                            Field{&ResultNotes::inputs_hash, "inputs_hash"}};
constexpr std::tuple kPart{Field{&ResultPart::shard, "shard"},
                           Field{&ResultPart::division, "division"},
                           Field{&ResultPart::store, "store"}};
/// What a budget has besides the parameters of the query.
constexpr std::tuple kBudget{
    Field{&ErrorBudget::step, "budget_step"}, Field{&ErrorBudget::lever, "budget_lever"},
    Field{&ErrorBudget::motion, "budget_motion"}, Field{&ErrorBudget::chord, "budget_chord"},
    Field{&ErrorBudget::spacing, "budget_spacing"}};
constexpr std::tuple kWithheld{Field{&ResultFindings::withheld_points, "withheld_points"}};
constexpr std::tuple kIgnoredColliding{
    Field{&ResultFindings::ignored_colliding, "ignored_colliding"},
    Field{&ResultFindings::ignored_colliding_high, "ignored_colliding_high"}};
constexpr std::tuple kSeen{Field{&SeenSummary::cube, "unseen_cube_side"},
                           Field{&SeenSummary::swept, "swept_cubes"},
                           Field{&SeenSummary::unseen, "unseen_cubes"},
                           Field{&SeenSummary::groups, "unseen_groups"},
                           Field{&SeenSummary::listed_groups, "unseen_listed_groups"},
                           Field{&SeenSummary::listed_cubes, "unseen_listed_cubes"},
                           Field{&SeenSummary::not_scanned_length, "not_scanned_length"}};
constexpr std::tuple kCertain{Field{&CertainPoints::points, "certain_points"},
                              Field{&CertainPoints::has_group, "certain_group"}};
constexpr std::tuple kSearched{Field{&SearchedLength::path, "path_length"},
                               Field{&SearchedLength::whole, "searched_length"},
                               Field{&SearchedLength::part, "partly_searched_length"}};

template <typename Struct, typename... Fields>
void write_all(const hdf5::Id& file, const std::tuple<Fields...>& list, const Struct& from) {
  for_each_field(list, [&](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    if constexpr (!std::is_array_v<Value>) {
      if (field.is_kept_if_set && field.is_default(from)) return;
    }
    write_value(file, field.key, field.of(from));
  });
}

template <typename Struct, typename... Fields>
void read_all(const hdf5::Id& file, const std::string& name, const std::tuple<Fields...>& list,
              Struct& to) {
  for_each_field(list, [&](const auto& field) {
    if (field.is_kept_if_set && !hdf5::has_attribute(file, field.key, name)) return;
    read_value(file, field.key, name, field.of(to));
  });
}

std::string lines_of(const std::vector<std::string>& texts) {
  std::string lines;
  for (const std::string& text : texts) lines += (lines.empty() ? "" : "\n") + text;
  return lines;
}

/// Reads an attribute that holds strings, one per line: at least one, at most `most`, and none of
/// them empty. what: their name in messages, such as "names".
std::vector<std::string> read_lines(const hdf5::Id& file, const std::string& name,
                                    const char* attribute, const char* what, std::size_t most) {
  const std::string lines = hdf5::read_text_attribute(file, attribute, name);
  std::vector<std::string> texts;
  for (std::size_t begin = 0; begin <= lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    texts.push_back(lines.substr(begin, end - begin));
    if (texts.back().empty() || texts.size() > most) {
      refuse(name, "attribute '" + std::string(attribute) + "': expected 1 to " +
                       std::to_string(most) + " " + what + ", a line each");
    }
    begin = end + 1;
  }
  return texts;
}

// Most runs of poses in an attribute, for which HDF5 allows 64 KiB.
constexpr std::size_t kMostRuns = 4000;

std::vector<std::array<std::uint32_t, 2>> read_runs(const hdf5::Id& file, const std::string& name,
                                                    const ResultHeader& header) {
  std::vector<std::array<std::uint32_t, 2>> runs;
  if (!hdf5::has_attribute(file, names::kRunsWithoutBodies, name)) return runs;
  const auto count = hdf5::read_number<std::uint64_t>(file, names::kRunsWithoutBodies, name);
  if (count > kMostRuns) {
    refuse(name, "attribute 'runs_without_bodies' is " + std::to_string(count) +
                     ", expected at most " + std::to_string(kMostRuns));
  }
  const auto ends =
      hdf5::read_attribute<std::uint32_t>(file, names::kPosesWithoutBodies, 2 * count, name);
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const bool ascends = ends[i] <= ends[i + 1] && (i == 0 || ends[i - 1] < ends[i]);
    if (!ascends || ends[i + 1] >= header.poses) {
      refuse(name, "attribute 'poses_without_bodies': expected runs of poses that ascend");
    }
    runs.push_back({ends[i], ends[i + 1]});
  }
  return runs;
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
  refuse(name, "attributes 'searched_length' and 'partly_searched_length' are " +
                   format_number(read.whole) + " and " + format_number(read.part) +
                   ", expected lengths up to that of the path, which is " +
                   format_number(read.path));
}

void check_seen(const SeenSummary& seen, const std::string& name) {
  if (seen.unseen > seen.swept || seen.groups > seen.unseen || seen.listed_groups > seen.groups ||
      seen.listed_cubes > seen.unseen || !(seen.cube > 0) || !(seen.not_scanned_length >= 0)) {
    refuse(name, "the numbers of swept and unseen cubes contradict each other");
  }
}

void check_at_most(std::uint64_t count, std::uint64_t most, const char* attribute,
                   const std::string& name) {
  if (count <= most) return;
  refuse(name, "attribute '" + std::string(attribute) + "' is " + std::to_string(count) +
                   ", expected at most " + std::to_string(most));
}

void write_body_floors(const hdf5::Id& file, const ResultHeader& header) {
  std::vector<double> floors;
  for (const auto& floor : header.body_floors) floors.push_back(floor.value_or(kNoFloor));
  hdf5::write_attribute(file, names::kBodyFloors, std::span<const double>(floors));
}

void read_body_floors(const hdf5::Id& file, const std::string& name, ResultHeader& header) {
  if (!hdf5::has_attribute(file, names::kBodyFloors, name)) return;
  for (const double floor :
       hdf5::read_attribute<double>(file, names::kBodyFloors, header.bodies.size(), name)) {
    if (!std::isfinite(floor) && floor != kNoFloor) {
      refuse(name, std::string("attribute '") + names::kBodyFloors +
                       "': expected finite heights, or -inf for a body without a floor");
    }
    header.body_floors.push_back(floor == kNoFloor ? std::nullopt : std::optional(floor));
  }
}

void check_header(const ResultHeader& header, const std::string& name) {
  check_length(header.profile, "attribute 'profile'", name);
  check_length(header.notes.model_spacing, "attribute 'model_spacing'", name);
  if (!is_box(header.model_box)) {
    refuse(name, "attribute 'model_box': expected two finite corners, the least x, y, z first");
  }
  if (header.budget) check_budget(*header.budget, header.gap, name);
  if (header.part && !header.part->shard.is_valid()) {
    refuse(name, "attribute 'shard' is " + to_string(header.part->shard) +
                     ", expected a part of at most " + std::to_string(Shard::kMost));
  }
}

}  // namespace

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

void write_result_header(const hdf5::Id& file, const ResultHeader& header) {
  hdf5::write_attribute(file, "format",
                        std::string(header.part ? names::kPartFormat : names::kFormat));
  hdf5::write_number(file, "version", names::kVersion);
  write_all(file, kQuestion, header.question());
  write_all(file, kQuantisation, header.quantisation);
  write_all(file, kQueryValues, header);
  write_all(file, kNotes, header.notes);
  if (!header.bodies.empty()) {
    hdf5::write_attribute(file, names::kBodies, lines_of(header.bodies));
    if (!header.body_floors.empty()) write_body_floors(file, header);
  }
  if (header.budget) write_all(file, kBudget, *header.budget);
  if (header.ignores_points()) write_ignored(file, header);
  if (!header.part) return;
  write_all(file, kPart, *header.part);
}

ResultHeader read_result_header(const hdf5::Id& file, const std::string& name) {
  const bool is_part = read_format(file, name);
  ResultHeader header;
  read_all(file, name, kQuestion, static_cast<ResultQuestion&>(header));
  read_all(file, name, kQuantisation, header.quantisation);
  read_all(file, name, kQueryValues, header);
  read_all(file, name, kNotes, header.notes);
  if (hdf5::has_attribute(file, names::kBodies, name)) {
    header.bodies = read_lines(file, name, names::kBodies, "names", kMostBodies);
    read_body_floors(file, name, header);
  }
  header.budget = given_errors(header);
  if (header.budget) read_all(file, name, kBudget, *header.budget);
  if (hdf5::has_attribute(file, names::kIgnoredPoints, name)) read_ignored(file, name, header);
  if (is_part) {
    read_all(file, name, kPart, header.part.emplace());
  }
  check_header(header, name);
  return header;
}

void write_result_findings(const hdf5::Id& file, const ResultFindings& findings,
                           const ResultHeader& header) {
  write_warnings(file, findings.warnings);
  write_scan_dates(file, findings.scanned);
  write_all(file, kWithheld, findings);
  if (header.ignores_points()) write_all(file, kIgnoredColliding, findings);
  if (findings.floor_colliding) {
    hdf5::write_number(file, names::kFloorColliding, *findings.floor_colliding);
  }
  if (findings.seen) write_all(file, kSeen, *findings.seen);
  if (findings.certain) write_all(file, kCertain, *findings.certain);
  if (!header.bodies.empty())
    write_all(file, kSearched, findings.searched.value_or(SearchedLength{}));
  if (!findings.without_bodies.empty() && findings.without_bodies.size() <= kMostRuns) {
    std::vector<std::uint32_t> ends;
    for (const auto& run : findings.without_bodies) ends.insert(ends.end(), run.begin(), run.end());
    hdf5::write_number(file, names::kRunsWithoutBodies, std::uint64_t{ends.size() / 2});
    hdf5::write_attribute(file, names::kPosesWithoutBodies, std::span<const std::uint32_t>(ends),
                          2);
  }
}

ResultFindings read_result_findings(const hdf5::Id& file, const std::string& name,
                                    const ResultHeader& header) {
  ResultFindings findings;
  findings.warnings = read_warnings(file, name);
  findings.scanned = read_scan_dates(file, name);
  read_all(file, name, kWithheld, findings);
  if (header.ignores_points()) {
    read_all(file, name, kIgnoredColliding, findings);
    check_at_most(findings.ignored_colliding, header.ignored.points, "ignored_colliding", name);
    check_at_most(findings.ignored_colliding_high, findings.ignored_colliding,
                  "ignored_colliding_high", name);
  }
  if (hdf5::has_attribute(file, names::kFloorColliding, name)) {
    read_value(file, names::kFloorColliding, name, findings.floor_colliding.emplace());
    check_at_most(*findings.floor_colliding, header.environment_points, names::kFloorColliding,
                  name);
    if (!header.bodies.empty() && header.body_floors.empty()) {
      refuse(name, std::string("attribute '") + names::kBodyFloors + "' is missing; run it again");
    }
  } else if (header.floor || !header.body_floors.empty()) {
    refuse(name, std::string("attribute '") + names::kFloorColliding + "' is missing");
  }
  if (header.seen) {
    SeenSummary& seen = findings.seen.emplace();
    read_all(file, name, kSeen, seen);
    check_seen(seen, name);
    seen.seen = seen.swept - seen.unseen;
  }
  if (header.budget) read_all(file, name, kCertain, findings.certain.emplace());
  if (!header.bodies.empty()) {
    read_all(file, name, kSearched, findings.searched.emplace());
    check_searched(*findings.searched, name);
  }
  findings.without_bodies = read_runs(file, name, header);
  return findings;
}

}  // namespace clearway
