#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/support/options.hpp"
#include "cli/support/standard_output.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/journal/journal.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "io/system/xxh64.hpp"
#include "stream/journalled_work.hpp"
#include "stream/search_journal.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json box_json(const StoreReader& store) {
  if (store.tree().empty()) return nullptr;
  const Box box = position_box(store.quantisation(), store.tree()[0].box);
  return {{"lo", {box.lo.x, box.lo.y, box.lo.z}}, {"hi", {box.hi.x, box.hi.y, box.hi.z}}};
}

ordered_json describe(const StoreReader& store) {
  const StoreMetadata& m = store.metadata();
  std::uint64_t packed = 0;
  for (const std::uint32_t bytes : store.index().bytes) packed += bytes;
  ordered_json sources = ordered_json::array();
  for (const SourceFile& source : m.sources) {
    sources.push_back(
        {{"name", source.name}, {"bytes", source.bytes}, {"xxh64", hash_text(source.xxh64)}});
  }
  return {{"kind", "store"},
          {"version", kStoreVersion},
          {"points", m.point_count},
          {"non_finite_points", m.input_points - m.point_count},
          {"layout", m.layout},
          {"cells", store.cells().size()},
          {"cell_points", m.cell_points},
          {"packed_bytes", packed},
          {"scale", m.quantisation.scale},
          {"offset", m.quantisation.offset},
          {"bounds", box_json(store)},
          {"length_unit", to_string(m.unit)},
          {"crs_wkt", m.crs_wkt},
          {"points_hash", hash_text(m.points_hash)},
          {"fingerprint", hash_text(store.fingerprint())},
          {"sources", sources}};
}

ordered_json describe(const ResultReader& result) {
  const ResultHeader& h = result.header();
  ordered_json description{{"kind", "result"},
                           {"colliding_points", result.collisions()},
                           {"environment_points", h.environment_points},
                           {"radius", h.radius},
                           {"model_points", h.model_points},
                           {"poses", h.poses},
                           {"first_pose", h.first_pose},
                           {"clearance", h.clearance},
                           {"clearance_points", result.clearances()},
                           {"between_poses", h.between_poses},
                           {"scale", h.quantisation.scale},
                           {"offset", h.quantisation.offset},
                           {"crs_wkt", h.crs_wkt},
                           {"environment_hash", hash_text(h.environment_hash)},
                           {"model_hash", hash_text(h.model_hash)},
                           {"trajectory_hash", hash_text(h.trajectory_hash)}};
  if (h.tolerance > 0) {
    description["tolerance"] = h.tolerance;
    description["engine"] = h.engine;
  }
  if (h.float_precision) description["precision"] = "float";
  if (h.has_poses_of_ways()) {
    description["first_pose_of"] =
        h.ways_without_ends ? "way without its end (version 0.1.0)" : "closed way";
  }
  return description;
}

ordered_json describe(const JournalReader& journal) {
  const JournalledWork work = journalled_work(journal);
  ordered_json description{{"kind", "journal"},
                           {"version", kJournalVersion},
                           {"records", journal.records()},
                           {"finished_cells", work.cells},
                           {"finished_poses", work.poses},
                           {"torn", journal.torn()}};
  if (journal.identity()) {
    for (const auto& [name, value] : *journal.identity()) description[name] = value;
  }
  return description;
}

ordered_json describe_file(const std::filesystem::path& file) {
  if (is_journal(file)) return describe(JournalReader(file));
  if (hdf5::holds(file, "collisions")) return describe(ResultReader(file));
  return describe(StoreReader(file));
}

std::string text_of(const ordered_json& description) {
  std::size_t width = 0;
  for (const auto& [key, value] : description.items()) width = std::max(width, key.size());
  std::string text;
  for (const auto& [key, value] : description.items()) {
    if (key == "sources") {
      for (const auto& source : value) {
        text += fmt::format("{:<{}}  {} ({} bytes, xxh64 {})\n", "source", width,
                            source["name"].get<std::string>(), source["bytes"].get<std::uint64_t>(),
                            source["xxh64"].get<std::string>());
      }
    } else {
      text += fmt::format("{:<{}}  {}\n", key, width,
                          value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return text;
}

struct InfoOptions {
  std::filesystem::path file;
  bool json = false;
};

void run_info(const InfoOptions& options) {
  const ordered_json description = describe_file(options.file);
  // Names of files need not be UTF-8.
  constexpr auto kReplace = ordered_json::error_handler_t::replace;
  print(options.json ? description.dump(2, ' ', false, kReplace) + "\n" : text_of(description));
}

}  // namespace

void add_info(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      program.add_subcommand("info", "Print what is in a store, a result or a journal");
  command->add_option("FILE", options->file, "Store, result or journal")
      ->type_name("FILE")
      ->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Lengths are in the environment's unit, normally metres.\n"
      "Example: clearway info site.h5");
  command->callback([options] { run_info(*options); });
}

}  // namespace clearway::tool
