#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "campaign/plan.hpp"
#include "clearway/trajectory.hpp"
#include "cli/commands.hpp"
#include "cli/model.hpp"
#include "cli/support/console.hpp"
#include "cli/support/ignored_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/verdict.hpp"
#include "core/describe/section_report.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/point_classes.hpp"
#include "core/util/format.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/file.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/floor_facts.hpp"
#include "io/result/journal.hpp"
#include "io/result/result.hpp"
#include "io/section/section_file.hpp"
#include "io/store/file_kind.hpp"
#include "io/store/inspect_points.hpp"
#include "io/store/store_metadata.hpp"
#include "io/store/store_reader.hpp"
#include "stream/search_journal.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json bounds_of(const StoreReader& store) {
  if (store.tree().empty()) return nullptr;
  return Json(position_box(store.quantisation(), store.tree()[0].box));
}

/// The classes that points have, with their ASPRS names; null where the points have no classes.
ordered_json classes_json(const StoreMetadata& metadata) {
  if (!metadata.classes) return nullptr;
  ordered_json classes = ordered_json::array();
  for (std::size_t i = 0; i < metadata.classes->points.size(); ++i) {
    const std::uint64_t points = metadata.classes->points[i];
    if (points == 0) continue;
    classes.push_back(
        {{"class", i}, {"name", class_name(static_cast<std::uint8_t>(i))}, {"points", points}});
  }
  return classes;
}

ordered_json describe(const StoreReader& store) {
  const StoreMetadata& m = store.metadata();
  std::uint64_t packed = 0;
  for (const std::uint32_t bytes : store.chunks()[0].bytes) packed += bytes;
  ordered_json description{{"kind", "store"},
                           {"version", kStoreKind.version},
                           {"points", m.point_count},
                           {"non_finite_points", m.points_without_place()},
                           {"layout", m.layout},
                           {"cells", store.cells().size()},
                           {"cell_points", m.cell_points},
                           {"packed_bytes", packed},
                           {"scale", m.quantisation.scale},
                           {"steps", m.steps},
                           {"offset", m.quantisation.offset},
                           {"bounds", bounds_of(store)},
                           {"length_unit", to_string(m.unit)},
                           {"crs_wkt", m.crs_wkt},
                           {"classes", classes_json(m)},
                           {"points_hash", hash_text(m.points_hash)},
                           {"fingerprint", hash_text(store.fingerprint())},
                           {"sources", sources_json(m)},
                           {"warnings", store_warnings(m)}};
  if (m.height_unit != 0) description["height_unit"] = m.height_unit;
  if (m.withheld) {
    description["withheld"] = {{"points", m.withheld->points},
                               {"kept", m.withheld->kept},
                               {"cubes", m.withheld->cubes.size()}};
  }
  if (m.near) description["near"] = corridor_json(*m.near);
  if (m.origins) description["origins"] = origins_json(*m.origins);
  if (m.dates.known()) description["dates"] = {m.dates.first, m.dates.last};
  return description;
}

ordered_json describe(const SectionData& section) {
  const SectionParameters& asked = section.parameters;
  const SectionWindow& w = *asked.window;
  ordered_json description{{"kind", "section"},
                           {"x_range", {asked.rear, asked.front}},
                           {"pivots", nullptr},
                           {"window", {w.y_from, w.y_to, w.z_from, w.z_to}},
                           {"cell", asked.cell},
                           {"bin", asked.bin},
                           {"margin", asked.margin},
                           {"between_poses", asked.between_poses},
                           {"blocked", section.cells().size()},
                           {"bins", section.bins.size()},
                           {"rounding", section.rounding},
                           {"motion", or_null(section.motion)},
                           {"environment_points", section.environment_points},
                           {"ignored_points", section.ignored_points},
                           {"poses", section.poses},
                           {"length_unit", section.length_unit},
                           {"crs_wkt", section.crs_wkt},
                           {"environment_hash", hash_text(section.environment_hash)},
                           {"trajectory_hash", hash_text(section.trajectory_hash)},
                           {"warnings", section.warnings}};
  if (asked.pivots) description["pivots"] = {asked.pivots->front, asked.pivots->rear};
  if (section.ignored_cells) description["ignored_cells"] = json_of_fact(*section.ignored_cells);
  if (asked.seen) {
    description["seen_cube"] = asked.seen_cube;
    description["unknown"] = section.unknown_cells().size();
  }
  return description;
}

/// What a result was asked, and of which inputs.
ordered_json question_json(const ResultReader& result) {
  const ResultHeader& h = result.header();
  ordered_json description{
      {"kind", "result"},
      {"version", kResultVersion},
      {"colliding_points", result.collisions()},
      {"environment_points", h.environment_points},
      {"radius", h.radius},
      {"model_as", model_as(h.model_solids, h.model_triangles)},
      {"model_points", h.model_points},
      {"model_triangles", h.model_triangles},
      {"model_solids", h.model_solids},
      {"model_spacing", h.notes.model_spacing > 0 ? Json(h.notes.model_spacing) : Json()},
      {"model_box", h.model_box},
      {"poses", h.poses},
      {"first_pose", h.first_pose},
      {"clearance", h.clearance},
      {"clearance_points", result.clearances()},
      {"profile", h.profile},
      {"between_poses", h.between_poses},
      {"depth", h.depth},
      {"scale", h.quantisation.scale},
      {"offset", h.quantisation.offset},
      {"crs_wkt", h.crs_wkt}};
  description["parameters"] = campaign::parameters_json(h);
  add_hashes(description, h);
  if (const ModelAxes axes = h.notes.model_axes; axes.need_turn()) {
    description["model_axes"] = {{"forward", name_of(axes.forward)}, {"up", name_of(axes.up)}};
  }
  if (!h.bodies.empty()) description["bodies"] = h.bodies;
  return description;
}

/// Adds the verdict, what it rests on, and its warnings.
void add_verdict(ordered_json& description, const ResultHeader& h, const Answer& answer) {
  description["verdict"] = name_of(answer.verdict());
  if (answer.budget) {
    description["reasons"] = json_of_fact(answer.reasons());
    description["margins"] = margins_json(answer);
    description["budget"] = budget_json(*answer.budget);
    description["near_points"] = answer.near_points;
    description["certain_points"] = answer.certain.points;
    description["gap"] = h.gap;
  }
  if (answer.seen) description["seen"] = seen_json(answer);
  if (const auto doubts = answer.doubts(); !doubts.empty()) description["doubts"] = doubts;
  if (const auto codes = answer.warned_of(); !codes.empty()) description["warned_of"] = codes;
  description["warnings"] = answer.warnings;
  if (h.model_solids > 0) add_inside(answer, description);
  if (answer.searched) add_searched(*answer.searched, description);
}

ordered_json describe(const ResultReader& result) {
  const ResultHeader& h = result.header();
  ordered_json description = question_json(result);
  const Answer answer = h.model_solids > 0 ? answer_of(result) : counted_answer(result);
  add_verdict(description, h, answer);
  if (h.ignores_points()) {
    description["ignored"] = ignored_json(answer);
    if (!h.ignore_classes.empty()) description["classes_hash"] = hash_text(h.classes_hash);
  }
  if (answer.floor_colliding) description["floor"] = floor_json(answer);
  if (h.part) {
    description["kind"] = "part of a result";
    description["shard"] = to_string(h.part->shard);
    description["division"] = hash_text(h.part->division);
    description["store"] = hash_text(h.part->store);
  }
  if (const ScanDates& dates = result.findings().scanned; dates.known()) {
    description["dates"] = {dates.first, dates.last};
  }
  if (const std::uint64_t withheld = result.findings().withheld_points; withheld > 0) {
    description["withheld_points"] = withheld;
  }
  return description;
}

ordered_json describe(const JournalReader& journal) {
  const std::array cells = answered_cells(journal);
  ordered_json description{{"kind", "journal"},
                           {"version", kJournalVersion},
                           {"records", journal.records()},
                           {"finished_cells", cells[index_of(PointQuestion::kHits)]},
                           {"answered_cells", ordered_json::object()},
                           {"torn", journal.torn()}};
  for (std::size_t i = 0; i < kQuestions; ++i) {
    if (cells[i] == 0) continue;
    description["answered_cells"][name_of(static_cast<PointQuestion>(i))] = cells[i];
  }
  if (journal.identity()) {
    for (const auto& [name, value] : *journal.identity()) description[name] = value;
  }
  return description;
}

ordered_json describe_points(const std::filesystem::path& file) {
  const PointsDescription points = inspect_points(file);
  ordered_json remarks = ordered_json::array();
  for (const Message& remark : points.info.remarks) remarks.push_back(remark.text);
  ordered_json description{{"kind", "scan"},
                           {"format", point_format_name(file)},
                           {"points", points.points},
                           {"absent_points", points.absent},
                           {"non_finite_points", points.non_finite},
                           {"faces", points.info.faces},
                           {"scale", nullptr},
                           {"offset", nullptr},
                           {"bounds", points.points > 0 ? Json(points.box) : Json()},
                           {"length_unit", to_string(points.info.unit)},
                           {"crs_wkt", points.info.crs_wkt},
                           {"spacing", or_null(points.spacing)},
                           {"remarks", remarks}};
  if (points.info.quantisation) {
    description["scale"] = points.info.quantisation->scale;
    description["offset"] = points.info.quantisation->offset;
  }
  if (points.info.height_unit != 0) description["height_unit"] = points.info.height_unit;
  if (points.flags) {
    description["flags"] = {{"synthetic", points.flags->synthetic},
                            {"key_point", points.flags->key_point},
                            {"withheld", points.flags->withheld},
                            {"overlap", points.flags->overlap}};
  }
  return description;
}

ordered_json describe_trajectory(const std::filesystem::path& file) {
  const std::vector<Pose> poses = read_trajectory(file);
  std::vector<Vec3> positions;
  for (const Pose& pose : poses) positions.push_back(pose.position());
  return {{"kind", "trajectory"},
          {"poses", poses.size()},
          {"bounds", poses.empty() ? Json() : Json(box_of(positions))},
          {"more", "clearway trajectory info " + file.filename().string()}};
}

/// The first of two readings that succeeds. Where neither does, the first one's error is thrown,
/// because it is about the kind of file that this looks like.
template <typename First, typename Second>
ordered_json either(const std::filesystem::path& file, First first, Second second) {
  try {
    return first(file);
  } catch (const InputError&) {
    const std::exception_ptr complaint = std::current_exception();
    try {
      return second(file);
    } catch (const Error&) {
      std::rethrow_exception(complaint);
    }
  }
}

ordered_json describe(const std::filesystem::path& file) {
  switch (describe_file(file).kind) {
    case FileKind::kJournal:
      return describe(JournalReader(file));
    case FileKind::kResult:
      return describe(ResultReader(file, Parts::kAccepted));
    case FileKind::kSection:
      return describe(read_section(file));
    case FileKind::kStore:
    case FileKind::kOtherHdf5:
      return describe(StoreReader(file));
    case FileKind::kPoints:
      return describe_points(file);
    case FileKind::kMesh:
      return either(file, description_of_model, describe_points);
    case FileKind::kTrajectory:
      return either(file, describe_trajectory, describe_points);
    default:
      return either(file, describe_points, describe_trajectory);
  }
}

/// The description in lines. Lists have a line for each entry.
std::string text_of(const ordered_json& description) {
  const auto number = [](const ordered_json& of) { return of.get<std::uint64_t>(); };
  const auto words = [](const ordered_json& of) { return of.get<std::string>(); };
  const auto points = [&](const ordered_json& of) { return counted(number(of), "point"); };
  std::size_t width = 0;
  for (const auto& [key, value] : description.items()) width = std::max(width, key.size());
  std::string text;
  const auto line = [&](const std::string& name, const std::string& what) {
    text += fmt::format("{:<{}}  {}\n", name, width, what);
  };
  for (const auto& [key, value] : description.items()) {
    if (key == "classes" && value.is_array()) {
      for (const auto& one : value) {
        const std::string name = words(one["name"]);
        line("class", std::to_string(number(one["class"])) +
                          (name.empty() ? "" : " (" + name + ")") + ": " + points(one["points"]));
      }
    } else if (key == "origins" && value.is_object()) {
      line(key, format_count(number(value["distinct"])) + " distinct; " +
                    points(value["points_without"]) + " without");
      for (const auto& one : value["rest_on"]) {
        line(key, words(one["what"]) + ": " + points(one["points"]));
      }
    } else if (key == "withheld" && value.is_object()) {
      const std::string cubes = counted(number(value["cubes"]), "cube of 1 m", "cubes of 1 m");
      line(key, points(value["points"]) +
                    (value["kept"].get<bool>() ? ", kept" : ", left out, in " + cubes));
    } else if (key == "near" && value.is_object()) {
      std::string what = "within " + format_number(value["within"].get<double>()) +
                         " of a path of " + counted(number(value["path_poses"]), "pose") + "; " +
                         points(value["points_left_out"]) + " left out";
      if (const auto unread = number(value["points_unread"]); unread > 0) {
        what += fmt::format(", {} of them not read ({})", format_count(unread),
                            format_size(number(value["bytes_unread"])));
      }
      if (const auto files = number(value["files_passed_over"]); files > 0) {
        what += "; " + counted(files, "file") + " passed over";
      }
      line(key, what);
    } else if (key == "flags") {
      for (const auto& [flag, count] : value.items()) line("flag", flag + ": " + points(count));
    } else if (key == "warnings") {
      for (const auto& one : value)
        line("warning", words(one["code"]) + ": " + words(one["message"]));
    } else if (key == "sources") {
      for (const auto& one : value) {
        std::string what = fmt::format("{} ({} bytes, xxh64 {})", words(one["name"]),
                                       number(one["bytes"]), words(one["xxh64"]));
        if (one["points"] == 0) {
          what += ", no points";
        } else if (!one["points"].is_null()) {
          const std::uint64_t first = number(one["first_source"]);
          what +=
              fmt::format(", source indices {} to {}", first, first + number(one["points"]) - 1);
        }
        line("source", what);
      }
    } else {
      line(key, value.is_string() ? words(value) : value.dump());
    }
  }
  return text;
}

struct InfoOptions {
  std::filesystem::path file;
  bool json = false;
};

void run_info(const InfoOptions& options) {
  File::open_regular(options.file);  // opening a pipe without a writer would wait for ever
  const ordered_json description = describe(options.file);
  // File names need not be UTF-8.
  print(options.json ? indented_text(description) : text_of(description));
}

}  // namespace

void add_info(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = program.add_subcommand(
      "info",
      "Print what is in a file: store, result, section, journal, scan, model or trajectory");
  add_file(*command, "FILE", options->file, "Any file that Clearway reads or writes")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Lengths are in the file's unit, normally metres. Scans and models are read to their end.\n"
      "Example: clearway info site.h5");
  command->callback([options] { run_info(*options); });
}

}  // namespace clearway::tool
