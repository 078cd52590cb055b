#include "campaign/campaign_file.hpp"

#include <glob.h>

#include <algorithm>
#include <array>
#include <map>
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
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/models/model_input.hpp"

namespace clearway::campaign {
namespace {

std::string number_text(const nlohmann::ordered_json& number) {
  return number.is_number_float() ? format_number(number.get<double>()) : number.dump();
}

std::string value_text(const KeyReader& value, ValueKind kind);

/// A text as on a command line, or a list of values of this kind.
std::string list_text(const KeyReader& value, ValueKind element_kind) {
  if (value.value().is_string()) return value.text();
  std::string list;
  for (const KeyReader& element : value.elements()) {
    list += (list.empty() ? "" : ",") + value_text(element, element_kind);
  }
  return list;
}

std::string value_text(const KeyReader& value, ValueKind kind) {
  switch (kind) {
    case ValueKind::kLength:
      return length_text(value);
    case ValueKind::kCount:
      if (!value.value().is_number_unsigned()) {
        value.refuse("expected a whole number, 0 or more");
      }
      return value.value().dump();
    case ValueKind::kNumber:
      if (!value.value().is_number()) value.refuse("expected a number");
      return number_text(value.value());
    case ValueKind::kSize:
      if (value.value().is_number_integer()) return value.value().dump();
      if (!value.value().is_string()) {
        value.refuse("expected bytes as a whole number, or a size in quotes, as \"4G\"");
      }
      return value.text();
    case ValueKind::kLengths:
    case ValueKind::kBoxes:
      return list_text(value, ValueKind::kLength);
    case ValueKind::kCounts:
      return list_text(value, ValueKind::kCount);
    case ValueKind::kTexts:
      return list_text(value, ValueKind::kText);
    default:
      return value.text();
  }
}

}  // namespace

std::string length_text(const KeyReader& value) {
  if (value.value().is_number()) return number_text(value.value());
  if (!value.value().is_string()) {
    value.refuse("expected a length, as 0.1 or \"10cm\"");
  }
  return value.text();
}

Arguments arguments_of(const KeyReader& object, const std::vector<OptionKey>& table) {
  Arguments out;
  for (const auto& [name, option, kind] : table) {
    if (!object.has(name)) continue;
    const KeyReader value = object.at(name);
    if (kind == ValueKind::kFlag) {
      if (value.flag()) out.push_back({value.key(), option, option});
    } else if (kind == ValueKind::kBoxes) {
      for (const KeyReader& one : value.elements()) {
        out.push_back({one.key(), option, option + ("=" + value_text(one, kind))});
      }
    } else {
      out.push_back({value.key(), option, option + ("=" + value_text(value, kind))});
    }
  }
  return out;
}

std::vector<std::string> names_of(const std::vector<OptionKey>& table,
                                  std::vector<std::string> others) {
  for (const OptionKey& key : table) others.emplace_back(key.key);
  return others;
}

namespace {

namespace fs = std::filesystem;

const std::vector<OptionKey> kChainageKeys{
    {"chainage_start", "--chainage-start", ValueKind::kLength}};

/// The kind of value that campaign.json has for a field.
template <typename Struct, typename Value>
ValueKind kind_of(const Field<Struct, Value>& field) {
  if constexpr (std::is_same_v<Value, bool>) {
    return ValueKind::kFlag;
  } else if constexpr (std::is_same_v<Value, double> ||
                       std::is_same_v<Value, std::optional<double>>) {
    const bool is_length = field.unit == FieldUnit::kMetres || field.unit == FieldUnit::kRadians;
    return is_length ? ValueKind::kLength : ValueKind::kNumber;
  } else if constexpr (std::is_same_v<Value, std::vector<Box>>) {
    return ValueKind::kBoxes;
  } else if constexpr (std::is_integral_v<Value>) {
    return field.unit == FieldUnit::kBytes ? ValueKind::kSize : ValueKind::kCount;
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return ValueKind::kLengths;
  } else if constexpr (std::is_enum_v<Value> || std::is_same_v<Value, std::string> ||
                       std::is_same_v<Value, FileUnit>) {
    return ValueKind::kText;
  } else {
    return ValueKind::kCounts;
  }
}

/// Adds the keys of the fields that campaign.json has.
template <typename... Fields>
void add_keys(std::vector<OptionKey>& keys, const std::tuple<Fields...>& fields) {
  for_each_field(fields, [&keys](const auto& field) {
    if (field.is_in_campaigns && *field.option != '\0') {
      keys.push_back({field.name_in_campaigns(), field.option, kind_of(field)});
    }
  });
}

template <typename... Fields>
std::vector<OptionKey> keys_of(const std::tuple<Fields...>& fields) {
  std::vector<OptionKey> keys;
  add_keys(keys, fields);
  return keys;
}

std::vector<OptionKey> trajectory_keys() {
  std::vector<OptionKey> keys = keys_of(std::tuple_cat(kFormatOfTrajectory, kRigidityOfTrajectory));
  keys.push_back({"angles", "--angles", ValueKind::kTexts});
  add_keys(keys, std::tuple_cat(kNumbersOfTrajectory, kPlaceOfTrajectory));
  return keys;
}

const std::vector<OptionKey> kModelKeys = keys_of(kShapeOfModel);
/// Options that only the search takes, because conflicts and reports know the kind of model from
/// the result.
const std::vector<OptionKey> kModelKindKeys = keys_of(kKindOfModel);
const std::vector<OptionKey> kAxisKeys = keys_of(kTurnOfModel);
const std::vector<OptionKey> kTrajectoryKeys = trajectory_keys();
const std::vector<OptionKey> kQueryKeys =
    keys_of(std::tuple_cat(kQueryFields, std::tuple{kStrict<SearchOptions>}));
const std::vector<OptionKey> kConflictKeys{{"gap", "--gap", ValueKind::kLength},
                                           {"min_points", "--min-points", ValueKind::kCount},
                                           {"split", "--split", ValueKind::kLength}};
const std::vector<OptionKey> kLedgerKeys = keys_of(kLedgerFields);
/// What only a search may take of the machine, and what all commands may.
const std::vector<OptionKey> kSearchKeys = keys_of(
    std::tuple_cat(std::tuple{kEngine<SearchOptions>}, kDeviceFields<SearchOptions>, kFileFields));
const std::vector<OptionKey> kLimitKeys =
    keys_of(std::tuple{kMemory<SearchOptions>, kThreads<SearchOptions>});

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

/// The file that is named, or the files that match a pattern, sorted by name. takes_boxes: whether
/// a box that is named by its size may stand instead of a file.
std::vector<fs::path> files_of(const KeyReader& at, const fs::path& folder, bool takes_boxes) {
  const std::string given = at.text();
  if (takes_boxes && names_box(given)) return {given};
  const fs::path path = folder / given;
  std::error_code unknown;
  if (!is_pattern(given) || fs::exists(path, unknown)) {
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

/// Reads the entries of a member such as vehicles.truck, which is either a file name or an object
/// that contains one.
template <typename Kind>
class EntryReader {
 public:
  EntryReader(fs::path folder, const char* file_key, std::vector<std::string> others,
              bool takes_boxes = false)
      : folder_(std::move(folder)),
        file_key_(file_key),
        known_(std::move(others)),
        takes_boxes_(takes_boxes) {
    known_.insert(known_.begin(), file_key);
  }

  template <typename Describe>
  std::vector<Kind> read(const KeyReader& members, const Describe& describe) {
    std::vector<Kind> out;
    for (const KeyReader& member : members.members()) {
      Kind kind{};
      const bool in_short = member.value().is_string();
      if (!in_short) member.allow(known_);
      const KeyReader file = in_short ? member : member.at(file_key_);
      describe(member, kind);
      kind.key = file.key();
      for (const fs::path& path : files_of(file, folder_, takes_boxes_)) {
        kind.name = is_pattern(file.text()) ? path.stem().string() : member.name();
        kind.file = names_box(path) ? path : fs::absolute(path).lexically_normal();
        kind.is_match = is_pattern(file.text()) && path != folder_ / file.text();
        add(file, kind, out);
      }
    }
    return out;
  }

 private:
  void add(const KeyReader& at, const Kind& kind, std::vector<Kind>& out) {
    check_name(at, kind.name);
    check_utf8(at, kind.file);
    const auto [other, is_new] = seen_.emplace(kind.name, kind.key);
    if (!is_new) at.refuse("the name " + kind.name + " is that of " + other->second + " too");
    out.push_back(kind);
  }

  fs::path folder_;
  const char* file_key_;
  std::vector<std::string> known_;
  bool takes_boxes_;
  std::map<std::string, std::string> seen_;
};

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

/// The ending of a file's name in small letters.
std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return ending;
}

/// What stands for the kind of a file that a campaign reads, by the ending of its name: files of
/// one kind can take each other's place.
std::string kind_of(const fs::path& file) {
  static const std::set<std::string> kTables{".txt", ".csv", ".tum", ".pose", ".frames"};
  static const std::set<std::string> kMeshes{".stl", ".obj", ".off", ".ply"};
  const std::string ending = ending_of(file);
  return kTables.contains(ending) ? "table" : kMeshes.contains(ending) ? "mesh" : ending;
}

/// Notes which files a pattern leaves out: those in the folders of its matches that are of their
/// kind by their endings, and that nothing in the campaign names.
class LeftOutFiles {
 public:
  /// campaign: the file itself, which is none of its inputs.
  explicit LeftOutFiles(const fs::path& campaign) { named_.insert(campaign); }

  template <typename Kind>
  void add(const std::vector<Kind>& entries) {
    for (const Entry& entry : entries) {
      named_.insert(entry.file);
      if (entry.is_match) matches_[entry.key].push_back(entry.file);
    }
  }

  std::vector<Message> notes() const {
    std::vector<Message> notes;
    for (const auto& [key, matches] : matches_) {
      const std::vector<std::string> names = beside(matches);
      if (names.empty()) continue;
      notes.push_back(note("unmatched-files",
                           key + ": the pattern matches " + counted(matches.size(), "file") +
                               " and leaves out " + counted(names.size(), "file") +
                               " beside them of the same kind: " + listed(names),
                           {{"matched", static_cast<double>(matches.size())},
                            {"left_out", static_cast<double>(names.size())}}));
    }
    return notes;
  }

 private:
  /// Names of the files beside `matches`, sorted.
  std::vector<std::string> beside(const std::vector<fs::path>& matches) const {
    std::error_code unreadable;
    std::set<std::pair<fs::path, std::string>> kinds;
    for (const fs::path& match : matches) {
      if (!fs::is_regular_file(match, unreadable)) continue;
      kinds.insert({match.parent_path(), kind_of(match)});
    }
    std::set<fs::path> found;
    for (const auto& [folder, kind] : kinds) {
      fs::directory_iterator at(folder, unreadable);
      for (; !unreadable && at != fs::directory_iterator(); at.increment(unreadable)) {
        const fs::path& file = at->path();
        const bool is_hidden = file.filename().string().starts_with('.');
        if (is_hidden || kind_of(file) != kind || named_.contains(file)) continue;
        if (fs::is_regular_file(file, unreadable)) found.insert(file);
      }
    }
    std::vector<std::string> names;
    for (const fs::path& file : found) names.push_back(valid_utf8(file.filename().string()));
    return names;
  }

  static std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
      text += (i == 0 ? "" : ", ") + names[i];
    }
    return names.size() > kMost ? text + " and others" : text;
  }

  std::set<fs::path> named_;
  std::map<std::string, std::vector<fs::path>> matches_;  ///< by the key of the pattern
};

void read_entries(const KeyReader& file, const fs::path& folder, Campaign& campaign) {
  EntryReader<Entry> environments(folder, "store", {});
  campaign.environments =
      environments.read(file.at("environments"), [](const KeyReader&, Entry&) {});
  EntryReader<Vehicle> vehicles(
      folder, "model",
      names_of(kModelKeys, names_of(kModelKindKeys, names_of(kAxisKeys, {"turn"}))), true);
  campaign.vehicles =
      vehicles.read(file.at("vehicles"), [](const KeyReader& member, Vehicle& vehicle) {
        vehicle.arguments = arguments_of(member, kModelKeys);
        vehicle.kind = arguments_of(member, kModelKindKeys);
        vehicle.axes = arguments_of(member, kAxisKeys);
        if (!member.has("turn") || !member.at("turn").flag()) return;
        if (vehicle.axes.empty()) member.at("turn").refuse("needs forward or up beside it");
        // The search turns the model, and conflicts and reports know that from its result.
        vehicle.kind.insert(vehicle.kind.end(), vehicle.axes.begin(), vehicle.axes.end());
        vehicle.axes.clear();
      });
  EntryReader<Route> routes(folder, "trajectory",
                            names_of(kTrajectoryKeys, names_of(kChainageKeys, {"environment"})));
  campaign.routes = routes.read(file.at("routes"), [&](const KeyReader& member, Route& route) {
    route.arguments = arguments_of(member, kTrajectoryKeys);
    route.chainage = arguments_of(member, kChainageKeys);
    route.environment = environment_of(member, campaign.environments);
  });
}

void read_radii(const KeyReader& radii, Campaign& campaign) {
  std::set<std::string> seen;
  for (const KeyReader& radius : radii.elements()) {
    const std::string text = length_text(radius);
    check_name(radius, text);
    if (!seen.insert(text).second) radius.refuse(text + " stands twice");
    campaign.radii.push_back({radius.key(), "--radius", "--radius=" + text});
    campaign.radius_names.push_back(text);
  }
}

void read_conflict_formats(const KeyReader& outputs, Campaign& campaign) {
  static const std::set<std::string> kFormats{"csv", "json", "geojson", "gpkg", "bcf"};
  if (!outputs.has("conflicts")) return;
  const KeyReader list = outputs.at("conflicts");
  for (const KeyReader& format : list.elements()) {
    const std::string name = format.text();
    if (!kFormats.contains(name)) format.refuse("expected csv, json, geojson, gpkg or bcf");
    if (std::ranges::find(campaign.conflict_formats, name) != campaign.conflict_formats.end()) {
      format.refuse(name + " stands twice");
    }
    campaign.conflict_formats.push_back(name);
  }
  const bool first_pose = std::ranges::any_of(
      campaign.query, [](const Argument& one) { return one.option == "--first-pose"; });
  if (!first_pose) list.refuse("needs \"first_pose\": true in query");
}

/// Reads where the ledgers are. What the runs find of them is taken from the conflicts as JSON.
void read_ledgers(const KeyReader& outputs, const fs::path& folder, Campaign& campaign) {
  const Arguments options = arguments_of(outputs, kLedgerKeys);
  if (!outputs.has("ledger")) {
    if (!options.empty()) outputs.at("worse_by").refuse("needs \"ledger\" beside it");
    return;
  }
  const KeyReader at = outputs.at("ledger");
  if (campaign.conflict_formats.empty()) at.refuse("needs \"conflicts\" beside it");
  campaign.ledgers = fs::absolute(folder / at.text()).lexically_normal();
  check_utf8(at, campaign.ledgers);
  campaign.conflicts.insert(campaign.conflicts.end(), options.begin(), options.end());
  std::vector<std::string>& formats = campaign.conflict_formats;
  if (std::ranges::find(formats, "json") == formats.end()) formats.emplace_back("json");
}

void read_outputs(const KeyReader& file, const fs::path& folder, Campaign& campaign) {
  if (file.has("outputs")) {
    const KeyReader outputs = file.at("outputs");
    outputs.allow(
        names_of(kLedgerKeys, names_of(kConflictKeys, {"conflicts", "report", "ledger"})));
    campaign.conflicts = arguments_of(outputs, kConflictKeys);
    read_conflict_formats(outputs, campaign);
    read_ledgers(outputs, folder, campaign);
    campaign.report = outputs.has("report") && outputs.at("report").flag();
  }
  campaign.classes = arguments_of(file, {{"classes", "--classes", ValueKind::kLengths}});
  if (!campaign.classes.empty() && !campaign.report) {
    file.at("classes").refuse("needs \"report\": true in outputs");
  }
}

void read_shard_seconds(const KeyReader& limits, Campaign& campaign) {
  if (!limits.has("shard_seconds")) return;
  const KeyReader at = limits.at("shard_seconds");
  if (!at.value().is_number() || !(at.value().get<double>() > 0)) {
    at.refuse("expected seconds above 0, as 600");
  }
  const bool asks_for_depths = std::ranges::any_of(
      campaign.query, [](const Argument& argument) { return argument.text == "--depth"; });
  if (asks_for_depths) {
    at.refuse("depths are not found in shards; leave out \"depth\" of the query, or this limit");
  }
  campaign.shard_seconds = at.value().get<double>();
}

/// Whether an option of sbatch is one that the script sets itself.
bool is_of_script(const std::string& option) {
  static constexpr std::array kOwn{"--array",      "--signal", "--requeue",
                                   "--no-requeue", "--output", "--open-mode",
                                   "--dependency", "--wrap",   "--chdir"};
  const std::string name = option.substr(0, option.find('='));
  return std::ranges::any_of(kOwn, [&](const char* own) { return name == own; });
}

void read_slurm(const KeyReader& list, Campaign& campaign) {
  for (const KeyReader& option : list.elements()) {
    const std::string text = option.text();
    if (!text.starts_with("--") || text.find_first_of("\n\r") != std::string::npos) {
      option.refuse("expected an option of sbatch, as \"--partition=long\"");
    }
    if (is_of_script(text)) option.refuse(text + ": the script sets it itself");
    campaign.slurm.push_back(text);
  }
}

}  // namespace

Campaign read_campaign(const fs::path& path) {
  const KeyReader file = KeyReader::parse(path, text_of_file(path));
  file.allow({"name", "environments", "vehicles", "routes", "radii", "query", "classes", "outputs",
              "limits", "slurm"});
  Campaign campaign;
  campaign.name = file.at("name").text();
  check_name(file.at("name"), campaign.name);
  read_entries(file, fs::absolute(path).parent_path(), campaign);
  LeftOutFiles left_out(fs::absolute(path).lexically_normal());
  left_out.add(campaign.environments);
  left_out.add(campaign.vehicles);
  left_out.add(campaign.routes);
  campaign.notes = left_out.notes();
  read_radii(file.at("radii"), campaign);
  if (file.has("query")) {
    file.at("query").allow(names_of(kQueryKeys, {}));
    campaign.query = arguments_of(file.at("query"), kQueryKeys);
  }
  read_outputs(file, fs::absolute(path).parent_path(), campaign);
  if (file.has("limits")) {
    file.at("limits").allow(names_of(kLimitKeys, names_of(kSearchKeys, {"shard_seconds"})));
    campaign.search_limits = arguments_of(file.at("limits"), kSearchKeys);
    campaign.limits = arguments_of(file.at("limits"), kLimitKeys);
    read_shard_seconds(file.at("limits"), campaign);
  }
  if (file.has("slurm")) read_slurm(file.at("slurm"), campaign);
  return campaign;
}

}  // namespace clearway::campaign
