#include "campaign/campaign_file.hpp"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <ranges>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/describe/ledger.hpp"
#include "core/describe/model.hpp"
#include "core/describe/query.hpp"
#include "core/describe/search.hpp"
#include "core/describe/trajectory.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/models/model_input.hpp"

namespace clearway::campaign {
namespace {

namespace fs = std::filesystem;

/// The kind of value that a key has. What the value means is for the command line to judge.
enum class ValueKind { kLength, kText, kFlag, kCount, kSize, kNumber };

/// A key and the option that it stands for.
struct OptionKey {
  const char* key;
  const char* option;
  ValueKind kind;
  unsigned commands;  ///< those that take the option
  bool is_list = false;
  bool is_repeated = false;  ///< a list of values, for each of which the option is repeated
};

using Keys = std::vector<OptionKey>;

template <typename Struct, typename Value>
OptionKey key_of(const Field<Struct, Value>& field, unsigned commands) {
  OptionKey key{field.name_in_campaigns(), field.option, ValueKind::kText, commands};
  constexpr bool is_boxes = std::is_same_v<Value, std::vector<Box>>;
  if constexpr (std::is_same_v<Value, bool>) {
    key.kind = ValueKind::kFlag;
  } else if constexpr (std::is_same_v<Value, double> ||
                       std::is_same_v<Value, std::optional<double>>) {
    const bool is_length = field.unit == FieldUnit::kMetres || field.unit == FieldUnit::kRadians;
    key.kind = is_length ? ValueKind::kLength : ValueKind::kNumber;
  } else if constexpr (std::is_integral_v<Value>) {
    key.kind = field.unit == FieldUnit::kBytes ? ValueKind::kSize : ValueKind::kCount;
  } else if constexpr (!std::is_enum_v<Value> && !std::is_same_v<Value, std::string> &&
                       !std::is_same_v<Value, FileUnit>) {
    key.kind = is_boxes || std::is_same_v<Value, Vec3> ? ValueKind::kLength : ValueKind::kCount;
    key.is_list = true;
    key.is_repeated = is_boxes;
  }
  return key;
}

/// The keys of the fields that campaign.json has.
template <typename... Fields>
Keys keys_of(const std::tuple<Fields...>& fields, unsigned commands) {
  Keys keys;
  for_each_field(fields, [&](const auto& field) {
    if (field.is_in_campaigns && *field.option != '\0') keys.push_back(key_of(field, commands));
  });
  return keys;
}

Keys operator+(Keys a, const Keys& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Keys kNoKeys;
const Keys kVehicleKeys = keys_of(kShapeOfModel, kReaders) + keys_of(kKindOfModel, kRuns) +
                          keys_of(kTurnOfModel, kFindings);
const Keys kRouteKeys =
    keys_of(std::tuple_cat(kFormatOfTrajectory, kRigidityOfTrajectory), kReaders) +
    Keys{{"angles", "--angles", ValueKind::kText, kReaders, true}} +
    keys_of(std::tuple_cat(kNumbersOfTrajectory, kPlaceOfTrajectory), kReaders) +
    Keys{{"chainage_start", "--chainage-start", ValueKind::kLength, kFindings}};
const Keys kQueryKeys =
    keys_of(std::tuple_cat(kQueryFields, std::tuple{kStrict<SearchOptions>}), kRuns);
const Keys kOutputKeys = Keys{{"gap", "--gap", ValueKind::kLength, kFindings},
                              {"min_points", "--min-points", ValueKind::kCount, kFindings},
                              {"split", "--split", ValueKind::kLength, kFindings}} +
                         keys_of(kLedgerFields, kFindings);
const Keys kClassKeys{{"classes", "--classes", ValueKind::kLength, kReport, true}};
const Keys kLimitKeys = keys_of(std::tuple_cat(std::tuple{kEngine<SearchOptions>},
                                               kDeviceFields<SearchOptions>, kFileFields),
                                kSearch) +
                        keys_of(std::tuple{kMemory<SearchOptions>, kThreads<SearchOptions>}, kAll);

/// A value as on a command line.
std::string value_text(const KeyReader& value, ValueKind kind) {
  const Json& json = value.value();
  const bool is_number = json.is_number(), is_text = json.is_string();
  const auto expect = [&](ValueKind of, bool holds, const char* what) {
    if (kind == of && !holds) value.refuse(std::string("expected ") + what);
  };
  expect(ValueKind::kLength, is_number || is_text, "a length, as 0.1 or \"10cm\"");
  expect(ValueKind::kCount, json.is_number_unsigned(), "a whole number, 0 or more");
  expect(ValueKind::kNumber, is_number, "a number");
  expect(ValueKind::kSize, json.is_number_integer() || is_text,
         "bytes as a whole number, or a size in quotes, as \"4G\"");
  if (kind == ValueKind::kText || is_text) return value.text();
  return json.is_number_float() ? format_number(json.get<double>()) : json.dump();
}

/// The value of an option, or its list of values, which may be a text too.
std::string option_text(const KeyReader& value, const OptionKey& key) {
  if (!key.is_list) return value_text(value, key.kind);
  if (value.value().is_string()) return value.text();
  std::vector<std::string> values;
  for (const KeyReader& one : value.elements()) values.push_back(value_text(one, key.kind));
  return fmt::format("{}", fmt::join(values, ","));
}

/// The options for the keys that the object has, in the order of the table.
Arguments arguments_of(const KeyReader& object, const Keys& keys) {
  Arguments out;
  for (const OptionKey& key : keys) {
    if (!object.has(key.key)) continue;
    const KeyReader value = object.at(key.key);
    if (key.kind == ValueKind::kFlag) {
      if (value.flag()) out.push_back({value.key(), key.option, "", key.commands});
      continue;
    }
    for (const KeyReader& one : key.is_repeated ? value.elements() : std::vector{value}) {
      out.push_back({one.key(), key.option, option_text(one, key), key.commands});
    }
  }
  return out;
}

/// The given names, and those of the keys of a table.
std::vector<std::string> names_of(const Keys& keys, std::vector<std::string> names) {
  for (const OptionKey& key : keys) names.emplace_back(key.key);
  return names;
}

/// Refuses a name that cannot become a folder and a heading of the page.
void check_name(const KeyReader& at, const std::string& name) {
  constexpr std::size_t kMostBytes = 100;
  const bool control = std::ranges::any_of(
      name, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; });
  if (name.empty() || name.size() > kMostBytes || name[0] == '.' || control ||
      name.find('/') != std::string::npos) {
    at.refuse("\"" + name +
              "\" cannot name a folder: expected 1 to 100 bytes without \"/\" and control "
              "characters, and no dot in front");
  }
}

/// Refuses a path that is not UTF-8, because the plan is a UTF-8 text.
void check_utf8(const KeyReader& at, const fs::path& path) {
  if (valid_utf8(path.string()) != path.string()) {
    at.refuse(valid_utf8(path.string()) + ": expected a name in UTF-8");
  }
}

bool is_pattern(const std::string& text) { return text.find_first_of("*?[") != std::string::npos; }

/// The file that is named, or the files that match a pattern, sorted by name.
std::vector<fs::path> files_of(const KeyReader& at, const fs::path& folder) {
  const fs::path path = folder / at.text();
  std::error_code unknown;
  if (!is_pattern(at.text()) || fs::exists(path, unknown)) {
    if (!fs::exists(path, unknown)) at.refuse(path.string() + ": there is no such file");
    if (fs::is_other(fs::status(path, unknown))) {
      at.refuse(path.string() + ": is a pipe or device; expected a file, which tasks read again");
    }
    return {path};
  }
  glob_t found{};
  const int failed = ::glob(path.c_str(), GLOB_ERR, nullptr, &found);
  std::vector<fs::path> files(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (failed == GLOB_ABORTED || failed == GLOB_NOSPACE) at.refuse(path.string() + ": cannot list");
  if (files.empty()) at.refuse(path.string() + ": no file matches");
  std::ranges::sort(files);
  return files;
}

/// How the entries of a member such as "vehicles" are read.
struct EntryKind {
  const char* file_key;            ///< the key of the file in an entry that is an object
  const char* option;              ///< the option that takes the file
  unsigned commands;               ///< those that take it
  const Keys& keys;                ///< the options beside the file
  std::vector<std::string> known;  ///< other keys that an entry may have
  bool takes_boxes = false;        ///< whether a box that is named by its size may stand for a file
};

/// Reads the entries of a member, each of which is a file name or an object that contains one.
/// describe: reads the other keys.
std::vector<Entry> read_entries(const KeyReader& members, const fs::path& folder,
                                const EntryKind& kind,
                                const std::function<void(const KeyReader&, Entry&)>& describe) {
  std::vector<Entry> out;
  std::map<std::string, std::string> seen;
  std::vector<std::string> known{kind.file_key};
  known.insert(known.end(), kind.known.begin(), kind.known.end());
  for (const KeyReader& member : members.members()) {
    const bool in_short = member.value().is_string();
    if (!in_short) member.allow(names_of(kind.keys, known));
    const KeyReader at = in_short ? member : member.at(kind.file_key);
    Entry of_all;
    of_all.key = at.key();
    of_all.arguments = arguments_of(member, kind.keys);
    describe(member, of_all);
    const bool is_box = kind.takes_boxes && names_box(at.text());
    for (const fs::path& path : is_box ? std::vector<fs::path>{at.text()} : files_of(at, folder)) {
      Entry& entry = out.emplace_back(of_all);
      entry.name = is_pattern(at.text()) ? path.stem().string() : member.name();
      entry.file = is_box ? path : fs::absolute(path).lexically_normal();
      entry.is_match = is_pattern(at.text()) && path != folder / at.text();
      check_name(at, entry.name);
      check_utf8(at, entry.file);
      const auto [other, is_new] = seen.emplace(entry.name, entry.key);
      if (!is_new) at.refuse("the name " + entry.name + " is that of " + other->second + " too");
      const bool has_bodies = kind.takes_boxes && entry.file.extension() == ".json";
      entry.arguments.insert(
          entry.arguments.begin(),
          {entry.key, has_bodies ? "--vehicle" : kind.option, entry.file.string(), kind.commands});
    }
  }
  return out;
}

std::size_t environment_of(const KeyReader& route, const std::vector<Entry>& environments) {
  if (!route.has("environment")) {
    if (environments.size() == 1) return 0;
    route.refuse("environment is missing; it says which of the environments the route is in");
  }
  const KeyReader at = route.at("environment");
  const auto found = std::ranges::find(environments, at.text(), &Entry::name);
  if (found == environments.end()) at.refuse(at.text() + ": no environment has that name");
  return static_cast<std::size_t>(found - environments.begin());
}

/// Lets the search turn a model by its axes, which conflicts and reports know from its result.
void turn(const KeyReader& member, Entry& vehicle) {
  if (!member.has("turn") || !member.at("turn").flag()) return;
  bool has_axes = false;
  for (Argument& one : vehicle.arguments) {
    if (one.commands != kFindings) continue;
    one.commands = kRuns;
    has_axes = true;
  }
  if (!has_axes) member.at("turn").refuse("needs forward or up beside it");
}

/// What stands for the kind of a file that a campaign reads, by the ending of its name: files of
/// one kind can take each other's place.
std::string kind_of(const fs::path& file) {
  static const std::set<std::string> kTables{".txt", ".csv", ".tum", ".pose", ".frames"};
  static const std::set<std::string> kMeshes{".stl", ".obj", ".off", ".ply"};
  const std::string ending = file_ending(file);
  return kTables.contains(ending) ? "table" : kMeshes.contains(ending) ? "mesh" : ending;
}

/// The files in the folders of `matches` that are of their kind by their endings.
std::set<fs::path> files_beside(const std::vector<fs::path>& matches) {
  std::error_code unreadable;
  std::set<fs::path> found;
  std::set<std::pair<fs::path, std::string>> kinds;
  for (const fs::path& match : matches) {
    if (!fs::is_regular_file(match, unreadable)) continue;
    if (!kinds.insert({match.parent_path(), kind_of(match)}).second) continue;
    fs::directory_iterator at(match.parent_path(), unreadable);
    for (; !unreadable && at != fs::directory_iterator(); at.increment(unreadable)) {
      const bool is_hidden = at->path().filename().string().starts_with('.');
      if (is_hidden || kind_of(at->path()) != kind_of(match)) continue;
      if (at->is_regular_file(unreadable)) found.insert(at->path());
    }
  }
  return found;
}

/// Notes which files the patterns leave out that are of the kind of their matches and that nothing
/// in the campaign names. file: the campaign itself, which is none of its inputs.
std::vector<Message> notes_on_patterns(const Campaign& campaign, const fs::path& file) {
  std::set<fs::path> named{file};
  std::map<std::string, std::vector<fs::path>> matches_of;  // by the key of the pattern
  for (const auto* entries : {&campaign.environments, &campaign.vehicles, &campaign.routes}) {
    for (const Entry& entry : *entries) {
      named.insert(entry.file);
      if (entry.is_match) matches_of[entry.key].push_back(entry.file);
    }
  }
  constexpr std::size_t kMostNames = 5;
  std::vector<Message> notes;
  for (const auto& [key, matches] : matches_of) {
    std::vector<std::string> names;
    for (const fs::path& beside : files_beside(matches)) {
      if (!named.contains(beside)) names.push_back(valid_utf8(beside.filename().string()));
    }
    if (names.empty()) continue;
    notes.push_back(
        note("unmatched-files",
             fmt::format("{}: the pattern matches {} and leaves out {} beside them of the same "
                         "kind: {}{}",
                         key, counted(matches.size(), "file"), counted(names.size(), "file"),
                         fmt::join(names | std::views::take(kMostNames), ", "),
                         names.size() > kMostNames ? " and others" : ""),
             {{"matched", static_cast<double>(matches.size())},
              {"left_out", static_cast<double>(names.size())}}));
  }
  return notes;
}

bool has_option(const Arguments& arguments, const std::string& option) {
  return std::ranges::find(arguments, option, &Argument::option) != arguments.end();
}

void read_radii(const KeyReader& radii, Campaign& campaign) {
  for (const KeyReader& radius : radii.elements()) {
    const std::string text = value_text(radius, ValueKind::kLength);
    check_name(radius, text);
    if (std::ranges::find(campaign.radii, text, &Argument::value) != campaign.radii.end()) {
      radius.refuse(text + " stands twice");
    }
    campaign.radii.push_back({radius.key(), "--radius", text, kRuns});
  }
}

void read_conflict_formats(const KeyReader& list, Campaign& campaign) {
  static const std::set<std::string> kFormats{"csv", "json", "geojson", "gpkg", "bcf"};
  for (const KeyReader& format : list.elements()) {
    const std::string name = format.text();
    if (!kFormats.contains(name)) format.refuse("expected csv, json, geojson, gpkg or bcf");
    if (std::ranges::find(campaign.conflict_formats, name) != campaign.conflict_formats.end()) {
      format.refuse(name + " stands twice");
    }
    campaign.conflict_formats.push_back(name);
  }
  if (!has_option(campaign.query, "--first-pose")) {
    list.refuse("needs \"first_pose\": true in query");
  }
}

void read_ledgers(const KeyReader& at, const fs::path& folder, Campaign& campaign) {
  std::vector<std::string>& formats = campaign.conflict_formats;
  if (formats.empty()) at.refuse("needs \"conflicts\" beside it");
  campaign.ledgers = fs::absolute(folder / at.text()).lexically_normal();
  check_utf8(at, campaign.ledgers);
  if (std::ranges::find(formats, "json") == formats.end()) formats.emplace_back("json");
}

void read_outputs(const KeyReader& file, const fs::path& folder, Campaign& campaign) {
  if (file.has("outputs")) {
    const KeyReader outputs = file.at("outputs");
    outputs.allow(names_of(kOutputKeys, {"conflicts", "report", "ledger"}));
    campaign.outputs = arguments_of(outputs, kOutputKeys);
    if (outputs.has("conflicts")) read_conflict_formats(outputs.at("conflicts"), campaign);
    if (outputs.has("ledger")) {
      read_ledgers(outputs.at("ledger"), folder, campaign);
    } else if (outputs.has("worse_by")) {
      outputs.at("worse_by").refuse("needs \"ledger\" beside it");
    }
    campaign.report = outputs.has("report") && outputs.at("report").flag();
  }
  const Arguments classes = arguments_of(file, kClassKeys);
  if (!classes.empty() && !campaign.report) {
    file.at("classes").refuse("needs \"report\": true in outputs");
  }
  campaign.outputs.insert(campaign.outputs.end(), classes.begin(), classes.end());
}

void read_shard_seconds(const KeyReader& at, Campaign& campaign) {
  if (!at.value().is_number() || !(at.value().get<double>() > 0)) {
    at.refuse("expected seconds above 0, as 600");
  }
  if (has_option(campaign.query, "--depth")) {
    at.refuse("depths are not found in shards; leave out \"depth\" of the query, or this limit");
  }
  campaign.shard_seconds = at.value().get<double>();
}

void read_slurm(const KeyReader& list, Campaign& campaign) {
  static constexpr std::array kOfScript{"--array",      "--signal", "--requeue",
                                        "--no-requeue", "--output", "--open-mode",
                                        "--dependency", "--wrap",   "--chdir"};
  for (const KeyReader& option : list.elements()) {
    const std::string text = option.text();
    if (!text.starts_with("--") || text.find_first_of("\n\r") != std::string::npos) {
      option.refuse("expected an option of sbatch, as \"--partition=long\"");
    }
    if (std::ranges::find(kOfScript, text.substr(0, text.find('='))) != kOfScript.end()) {
      option.refuse(text + ": the script sets it itself");
    }
    campaign.slurm.push_back(text);
  }
}

}  // namespace

Campaign read_campaign(const fs::path& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  const KeyReader file = KeyReader::parse(path, text_of_file(path));
  file.allow({"name", "environments", "vehicles", "routes", "radii", "query", "classes", "outputs",
              "limits", "slurm"});
  Campaign campaign;
  campaign.name = file.at("name").text();
  check_name(file.at("name"), campaign.name);
  campaign.environments =
      read_entries(file.at("environments"), folder,
                   {"store", "--env", kRuns | kReport, kNoKeys, {}}, [](const auto&, Entry&) {});
  campaign.vehicles =
      read_entries(file.at("vehicles"), folder,
                   {"model", "--model", kReaders, kVehicleKeys, {"turn"}, true}, turn);
  campaign.routes =
      read_entries(file.at("routes"), folder,
                   {"trajectory", "--trajectory", kReaders, kRouteKeys, {"environment"}},
                   [&](const KeyReader& member, Entry& route) {
                     route.environment = environment_of(member, campaign.environments);
                   });
  campaign.notes = notes_on_patterns(campaign, fs::absolute(path).lexically_normal());
  read_radii(file.at("radii"), campaign);
  if (file.has("query")) {
    file.at("query").allow(names_of(kQueryKeys, {}));
    campaign.query = arguments_of(file.at("query"), kQueryKeys);
  }
  read_outputs(file, folder, campaign);
  if (file.has("limits")) {
    const KeyReader limits = file.at("limits");
    limits.allow(names_of(kLimitKeys, {"shard_seconds"}));
    campaign.limits = arguments_of(limits, kLimitKeys);
    if (limits.has("shard_seconds")) read_shard_seconds(limits.at("shard_seconds"), campaign);
  }
  if (file.has("slurm")) read_slurm(file.at("slurm"), campaign);
  return campaign;
}

}  // namespace clearway::campaign
