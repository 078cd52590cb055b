#include "io/result/result_header.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/geometry/axes.hpp"
#include "core/query/error_budget.hpp"
#include "core/query/ignored_points.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/input_error.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result.hpp"
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

/// Writes what a result of version 4 ignores: the group /ignored and its attributes.
void write_ignored(const hdf5::Id& file, const ResultHeader& header) {
  const hdf5::Id group = hdf5::create_group(file, names::kIgnoredGroup);
  hdf5::write_dataset<std::uint8_t>(group, names::kClassesIgnored, header.ignore_classes);
  hdf5::write_dataset<std::uint64_t>(group, names::kClassPoints, header.ignored.of_classes);
  hdf5::write_dataset<double>(group, names::kBoxes, as_rows(header.ignore_boxes), 6);
  hdf5::write_dataset<std::uint64_t>(group, names::kBoxPoints, header.ignored.in_boxes);
  hdf5::write_number(file, names::kIgnoredPoints, header.ignored.points);
  hdf5::write_number(file, names::kIgnoredHash, hash_of(header));
  if (!header.ignore_classes.empty()) {
    hdf5::write_number(file, names::kClassesHash, header.classes_hash);
  }
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
  if (!header.ignore_classes.empty()) {
    header.classes_hash = hdf5::read_number<std::uint64_t>(file, names::kClassesHash, name);
  }
}

namespace names = result_names;

/// Checks the format and version attributes. Returns whether the file is a part rather than a whole
/// result.
bool read_format(const hdf5::Id& file, const std::string& name) {
  if (hdf5::has_attribute(file, "format", name)) {
    const std::string format = hdf5::read_text_attribute(file, "format", name);
    if (format == names::kFormat) return false;
    if (format == names::kPartFormat) return true;
  }
  throw InputError(name + ": attribute 'format': expected \"" + names::kFormat +
                   "\"; this HDF5 file is not a result of clearway run");
}

std::uint32_t read_version(const hdf5::Id& file, const std::string& name) {
  const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
  if (version < names::kOldestVersion || version > names::kNewestVersion) {
    throw InputError(name + ": attribute 'version' is " + std::to_string(version) + ", expected " +
                     std::to_string(names::kOldestVersion) + " to " +
                     std::to_string(names::kNewestVersion) +
                     "; another release of clearway wrote it");
  }
  if (!hdf5::has_attribute(file, "complete", name) ||
      hdf5::read_number<std::uint8_t>(file, "complete", name) != 1) {
    throw InputError(name + ": not complete: the run that wrote it was interrupted");
  }
  return version;
}

void read_axes(const hdf5::Id& file, const std::string& attribute, const std::string& name,
               double (&out)[3]) {
  const auto values = hdf5::read_attribute<double>(file, attribute, 3, name);
  for (int k = 0; k < 3; ++k) out[k] = values[k];
}

void check_spacing(double spacing, const std::string& name) {
  if (spacing > 0 && std::isfinite(spacing)) return;
  throw InputError(name + ": attribute 'model_spacing' is " + std::to_string(spacing) +
                   ", expected a finite length above 0");
}

/// Whether the file has the attribute. The only valid value is `value`; for another it throws
/// InputError.
bool has_value(const hdf5::Id& file, const char* attribute, const char* value,
               const std::string& name) {
  if (!hdf5::has_attribute(file, attribute, name)) return false;
  const std::string found = hdf5::read_text_attribute(file, attribute, name);
  if (found == value) return true;
  refuse(name,
         std::string("attribute '") + attribute + "' is " + excerpt(found) + ", expected " + value);
}

std::string text_of(const ModelAxes& axes) {
  return std::string(name_of(axes.forward)) + "," + name_of(axes.up);
}

/// Reads the attribute "+y,+z" of a model whose y axis pointed ahead and whose z axis up.
ModelAxes read_model_axes(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, names::kModelAxes, name)) return {};
  const std::string found = hdf5::read_text_attribute(file, names::kModelAxes, name);
  for (int forward = 0; forward < 6; ++forward) {
    for (int up = 0; up < 6; ++up) {
      const ModelAxes axes{static_cast<Axis>(forward), static_cast<Axis>(up)};
      if (!along_one_line(axes.forward, axes.up) && text_of(axes) == found) return axes;
    }
  }
  refuse(name, "attribute 'model_axes' is " + excerpt(found) +
                   ", expected the axes that point ahead and up, for example +y,+z");
}

void read_model_box(const hdf5::Id& file, const std::string& name, Box& box) {
  const auto numbers = hdf5::read_attribute<double>(file, names::kModelBox, 6, name);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(numbers[k] <= numbers[3 + k]) || !std::isfinite(numbers[k]) ||
        !std::isfinite(numbers[3 + k])) {
      refuse(name, "attribute 'model_box' goes from " + shown(numbers[k]) + " to " +
                       shown(numbers[3 + k]) + ", expected two finite numbers that ascend");
    }
    box.lo[static_cast<int>(k)] = numbers[k];
    box.hi[static_cast<int>(k)] = numbers[3 + k];
  }
}

void check_profile(const ResultHeader& header, const std::string& name) {
  if (header.profile >= 0 && std::isfinite(header.profile)) return;
  refuse(name,
         "attribute 'profile' is " + shown(header.profile) + ", expected a length, or 0 for none");
}

/// Writes a parameter as a number; one that need not be given has to be there.
template <typename Value>
void write_field(const hdf5::Id& file, const Field<QueryParameters, Value>& field,
                 const QueryParameters& query) {
  if constexpr (std::is_same_v<Value, bool>) {
    hdf5::write_number(file, field.key, static_cast<std::uint8_t>(field.of(query)));
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    hdf5::write_number(file, field.key, *field.of(query));
  } else {
    hdf5::write_number(file, field.key, field.of(query));
  }
}

template <typename Value>
void read_field(const hdf5::Id& file, const Field<QueryParameters, Value>& field,
                const std::string& name, QueryParameters& query) {
  if constexpr (std::is_same_v<Value, bool>) {
    field.of(query) = hdf5::read_number<std::uint8_t>(file, field.key, name) != 0;
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    field.of(query) = hdf5::read_number<double>(file, field.key, name);
  } else {
    field.of(query) = hdf5::read_number<Value>(file, field.key, name);
  }
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

ResultPart read_part(const hdf5::Id& file, const std::string& name) {
  const auto shard = hdf5::read_attribute<std::uint32_t>(file, names::kShard, 2, name);
  ResultPart part{{shard[0], shard[1]},
                  hdf5::read_number<std::uint64_t>(file, names::kDivision, name),
                  hdf5::read_number<std::uint64_t>(file, names::kStore, name),
                  hdf5::read_text_attribute(file, names::kLengthUnit, name)};
  if (!part.shard.is_valid()) {
    refuse(name, "attribute 'shard' is " + to_string(part.shard) + ", expected a part of at most " +
                     std::to_string(Shard::kMost));
  }
  part.model_is_cut = hdf5::has_attribute(file, names::kModelIsCut, name);
  return part;
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

/// Reads three attributes of which a file has all or none.
std::optional<SearchedLength> read_searched(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, names::kSearchedLength, name)) return {};
  const SearchedLength read{hdf5::read_number<double>(file, names::kPathLength, name),
                            hdf5::read_number<double>(file, names::kSearchedLength, name),
                            hdf5::read_number<double>(file, names::kPartlySearchedLength, name)};
  const bool sound = std::isfinite(read.path) && read.whole >= 0 && read.whole <= read.path &&
                     read.part >= 0 && read.part <= read.path;
  if (sound) return read;
  refuse(name, "attributes 'searched_length' and 'partly_searched_length' are " +
                   shown(read.whole) + " and " + shown(read.part) +
                   ", expected lengths up to that of the path, which is " + shown(read.path));
}

void write_part(const hdf5::Id& file, const ResultHeader& header) {
  const ResultPart& part = *header.part;
  const std::uint32_t shard[]{part.shard.number, part.shard.count};
  hdf5::write_attribute(file, names::kShard, std::span<const std::uint32_t>(shard));
  hdf5::write_number(file, names::kDivision, part.division);
  hdf5::write_number(file, names::kStore, part.store);
  hdf5::write_attribute(file, names::kLengthUnit, part.length_unit);
  if (part.model_is_cut) hdf5::write_number(file, names::kModelIsCut, std::uint8_t{1});
}

/// Calls visit(attribute, number) for what a budget has besides the parameters of the query.
template <typename Budget, typename Visit>
void for_each_derived(Budget& budget, Visit visit) {
  visit(names::kBudgetStep, budget.step);
  visit(names::kBudgetLever, budget.lever);
  visit(names::kBudgetMotion, budget.motion);
  visit(names::kBudgetChord, budget.chord);
  visit(names::kBudgetSpacing, budget.spacing);
}

/// Reads the error budget, which only version 5 has.
void read_budget(const hdf5::Id& file, const std::string& name, ResultHeader& header) {
  header.budget = given_errors(header);
  if (!header.budget) return;
  if (header.version < 5) {
    refuse(name, "has an error budget, which version " + std::to_string(header.version) +
                     " does not have");
  }
  for_each_derived(*header.budget, [&](const char* attribute, double& number) {
    number = hdf5::read_number<double>(file, attribute, name);
  });
  const ErrorBudget& b = *header.budget;
  for (const double number : {b.scan, b.registration, b.pose, b.angle, b.model, b.sigmas, b.step,
                              b.lever, b.motion, b.chord, b.spacing}) {
    if (std::isfinite(number) && number >= 0) continue;
    refuse(name, "the error budget has the number " + shown(number) + ", expected 0 or above");
  }
  if (!(header.gap > 0) || !std::isfinite(header.gap)) {
    refuse(name, "the error budget has the gap " + shown(header.gap) + ", expected one above 0");
  }
}

/// Reads what versions before 4 do not have: bodies, ignored points, or both.
void read_more(const hdf5::Id& file, const std::string& name, ResultHeader& header) {
  const bool bodies = hdf5::has_attribute(file, names::kBodies, name);
  if (header.version < 4) {
    if (!bodies) return;
    refuse(name, "has bodies, which version " + std::to_string(header.version) + " does not have");
  }
  if (bodies) header.bodies = read_lines(file, name, names::kBodies, "names", kMostBodies);
  const bool ignores = header.version == 4 && !bodies;
  if (ignores || hdf5::has_attribute(file, names::kIgnoredPoints, name)) {
    read_ignored(file, name, header);
  }
}

}  // namespace

std::string environment_text(const ResultHeader& header) {
  return std::to_string(header.environment_points) + " points, hash " +
         hash_text(header.environment_hash);
}

void write_result_header(const hdf5::Id& file, const ResultHeader& header) {
  const Vec3 model_box[2] = {header.model_box.lo, header.model_box.hi};
  hdf5::write_attribute(file, "format",
                        std::string(header.part ? names::kPartFormat : names::kFormat));
  hdf5::write_number(file, "version", header.written_version());
  hdf5::write_number(file, "environment_points", header.environment_points);
  hdf5::write_number(file, "environment_hash", header.environment_hash);
  hdf5::write_number(file, "model_points", header.model_points);
  hdf5::write_number(file, "model_hash", header.model_hash);
  hdf5::write_number(file, "poses", header.poses);
  hdf5::write_number(file, "trajectory_hash", header.trajectory_hash);
  for_each_field(kQueryValues, [&](const auto& field) {
    if (field.is_always_listed) write_field(file, field, header);
  });
  hdf5::write_attribute(file, names::kModelBox, as_numbers(std::span(model_box)), 3);
  hdf5::write_attribute(file, "scale", std::span<const double>(header.quantisation.scale));
  hdf5::write_attribute(file, "offset", std::span<const double>(header.quantisation.offset));
  hdf5::write_attribute(file, "crs_wkt", header.crs_wkt);
  for_each_field(kQueryValues, [&](const auto& field) {
    if (!field.is_always_listed && !field.is_default(header)) write_field(file, field, header);
  });
  if (header.has_poses_of_ways() && !header.ways_without_ends) {
    hdf5::write_attribute(file, names::kFirstPoseOf, names::kClosedWay);
  }
  if (header.model_triangles > 0) {
    hdf5::write_number(file, names::kModelTriangles, header.model_triangles);
  }
  if (header.model_solids > 0) {
    hdf5::write_number(file, names::kModelSolids, header.model_solids);
  }
  if (header.model_spacing.metres > 0) {
    hdf5::write_number(file, names::kModelSpacing, header.model_spacing.metres);
  }
  if (header.model_axes.axes.need_turn()) {
    hdf5::write_attribute(file, names::kModelAxes, text_of(header.model_axes.axes));
  }
  if (header.budget) {
    for_each_derived(*header.budget, [&](const char* attribute, const double& number) {
      hdf5::write_number(file, attribute, number);
    });
  }
  if (header.ignores_points()) write_ignored(file, header);
  if (!header.bodies.empty()) {
    hdf5::write_attribute(file, names::kBodies, lines_of(header.bodies));
  }
  if (header.part) write_part(file, header);
}

ResultHeader read_result_header(const hdf5::Id& file, const std::string& name) {
  ResultHeader header;
  const bool is_part = read_format(file, name);
  header.version = read_version(file, name);
  header.environment_points = hdf5::read_number<std::uint64_t>(file, "environment_points", name);
  header.environment_hash = hdf5::read_number<std::uint64_t>(file, "environment_hash", name);
  header.model_points = hdf5::read_number<std::uint64_t>(file, "model_points", name);
  header.model_hash = hdf5::read_number<std::uint64_t>(file, "model_hash", name);
  header.poses = hdf5::read_number<std::uint64_t>(file, "poses", name);
  header.trajectory_hash = hdf5::read_number<std::uint64_t>(file, "trajectory_hash", name);
  for_each_field(kQueryValues, [&](const auto& field) {
    const bool always = field.is_always_listed && header.version > 2;
    if (always || hdf5::has_attribute(file, field.key, name)) {
      read_field(file, field, name, header);
    }
  });
  read_axes(file, "scale", name, header.quantisation.scale);
  read_axes(file, "offset", name, header.quantisation.offset);
  header.crs_wkt = hdf5::read_text_attribute(file, "crs_wkt", name);
  header.last_pose = header.first_pose && hdf5::has_attribute(file, names::kLastPoseHash, name);
  if (hdf5::has_attribute(file, names::kModelTriangles, name)) {
    header.model_triangles = hdf5::read_number<std::uint64_t>(file, names::kModelTriangles, name);
  }
  if (hdf5::has_attribute(file, names::kModelSolids, name)) {
    header.model_solids = hdf5::read_number<std::uint64_t>(file, names::kModelSolids, name);
  }
  if (hdf5::has_attribute(file, names::kModelSpacing, name)) {
    header.model_spacing.metres = hdf5::read_number<double>(file, names::kModelSpacing, name);
    check_spacing(header.model_spacing.metres, name);
  }
  header.model_axes.axes = read_model_axes(file, name);
  header.ways_without_ends =
      header.has_poses_of_ways() && !has_value(file, names::kFirstPoseOf, names::kClosedWay, name);
  if (header.version >= 3) {
    read_model_box(file, name, header.model_box);
    check_profile(header, name);
  }
  read_budget(file, name, header);
  read_more(file, name, header);
  if (is_part) {
    if (header.version < 3) refuse(name, "is a part of version 2, which has none");
    header.part = read_part(file, name);
  }
  return header;
}

namespace {

void write_seen(const hdf5::Id& file, const SeenSummary& seen) {
  hdf5::write_number(file, names::kCubeSide, seen.cube);
  hdf5::write_number(file, names::kSweptCubes, seen.swept);
  hdf5::write_number(file, names::kUnseenCubes, seen.unseen);
  hdf5::write_number(file, names::kUnseenGroups, seen.groups);
  hdf5::write_number(file, names::kListedGroups, seen.listed_groups);
  hdf5::write_number(file, names::kListedCubes, seen.listed_cubes);
  hdf5::write_number(file, names::kNotScanned, seen.not_scanned_length);
}

SeenSummary read_seen(const hdf5::Id& file, const std::string& name) {
  const auto count = [&](const char* attribute) {
    return hdf5::read_number<std::uint64_t>(file, attribute, name);
  };
  SeenSummary seen;
  seen.cube = hdf5::read_number<double>(file, names::kCubeSide, name);
  seen.swept = count(names::kSweptCubes);
  seen.unseen = count(names::kUnseenCubes);
  seen.groups = count(names::kUnseenGroups);
  seen.listed_groups = count(names::kListedGroups);
  seen.listed_cubes = count(names::kListedCubes);
  seen.not_scanned_length = hdf5::read_number<double>(file, names::kNotScanned, name);
  if (seen.unseen > seen.swept || seen.groups > seen.unseen || seen.listed_groups > seen.groups ||
      seen.listed_cubes > seen.unseen || !(seen.cube > 0) || !(seen.not_scanned_length >= 0)) {
    refuse(name, "the numbers of swept and unseen cubes contradict each other");
  }
  seen.seen = seen.swept - seen.unseen;
  return seen;
}

}  // namespace

void write_result_findings(const hdf5::Id& file, const ResultFindings& findings) {
  write_warnings(file, findings.warnings);
  write_scan_dates(file, findings.scanned);
  if (findings.withheld_points > 0) {
    hdf5::write_number(file, names::kWithheldPoints, findings.withheld_points);
  }
  if (findings.ignored_colliding) {
    hdf5::write_number(file, names::kIgnoredColliding, *findings.ignored_colliding);
  }
  if (findings.ignored_colliding_high) {
    hdf5::write_number(file, names::kIgnoredHigh, *findings.ignored_colliding_high);
  }
  if (findings.seen) write_seen(file, *findings.seen);
  if (findings.certain) {
    hdf5::write_number(file, names::kCertainPoints, findings.certain->points);
    hdf5::write_number(file, names::kCertainGroup,
                       static_cast<std::uint8_t>(findings.certain->has_group));
  }
  if (findings.searched) {
    hdf5::write_number(file, names::kPathLength, findings.searched->path);
    hdf5::write_number(file, names::kSearchedLength, findings.searched->whole);
    hdf5::write_number(file, names::kPartlySearchedLength, findings.searched->part);
  }
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
  const auto read_count = [&](const char* attribute, std::uint64_t most) {
    std::optional<std::uint64_t> count;
    if (!hdf5::has_attribute(file, attribute, name)) return count;
    count = hdf5::read_number<std::uint64_t>(file, attribute, name);
    if (*count > most) {
      refuse(name, "attribute '" + std::string(attribute) + "' is " + std::to_string(*count) +
                       ", expected at most " + std::to_string(most));
    }
    return count;
  };
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  findings.withheld_points = read_count(names::kWithheldPoints, kAny).value_or(0);
  findings.ignored_colliding = read_count(names::kIgnoredColliding, header.ignored.points);
  findings.ignored_colliding_high =
      read_count(names::kIgnoredHigh, findings.ignored_colliding.value_or(0));
  if (header.seen) findings.seen = read_seen(file, name);
  if (header.budget) {
    findings.certain =
        CertainPoints{hdf5::read_number<std::uint64_t>(file, names::kCertainPoints, name),
                      hdf5::read_number<std::uint8_t>(file, names::kCertainGroup, name) != 0};
  }
  findings.searched = read_searched(file, name);
  findings.without_bodies = read_runs(file, name, header);
  return findings;
}

}  // namespace clearway
