#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "io/files/json.hpp"

namespace clearway::campaign {

/// A command line option that a key of campaign.json stands for.
struct Argument {
  std::string key;     ///< for example "vehicles.truck.unit"
  std::string option;  ///< for example "--model-unit"
  /// The word of the command line, for example "--model-unit=mm".
  std::string text;
};

using Arguments = std::vector<Argument>;

/// The kind of value that a key of campaign.json has. What the value means is for the command line
/// to judge.
enum class ValueKind {
  kLength,
  kText,
  kFlag,
  kCount,
  kSize,
  kNumber,
  kTexts,
  kLengths,
  kCounts,
  kBoxes  ///< a list of lists of lengths: the option is repeated for each inner list
};

/// A key and the option that it stands for.
struct OptionKey {
  const char* key;
  const char* option;
  ValueKind kind;
};

/// The options for the keys that the object has, in the order of the table.
Arguments arguments_of(const KeyReader& object, const std::vector<OptionKey>& table);

/// The keys of the table after the names in `others`.
std::vector<std::string> names_of(const std::vector<OptionKey>& table,
                                  std::vector<std::string> others);

/// A number or a string, as on a command line. Refuses any other value.
std::string length_text(const KeyReader& value);

/// An entry of environments, vehicles or routes, or one match of an entry that is a pattern.
struct Entry {
  std::string name;
  /// The key in campaign.json that names its file, for messages.
  std::string key;
  std::filesystem::path file;
  bool is_match = false;  ///< whether a pattern names the file
  Arguments arguments;
};

struct Vehicle : Entry {
  /// Whether the vehicle's file is a JSON file of several bodies rather than a model.
  bool has_bodies() const { return file.extension() == ".json"; }

  /// The option that says whether the model is searched as points, surface or solid; only the
  /// search takes it.
  Arguments kind;
  /// Options for the model's axes, which only conflicts and reports take.
  Arguments axes;
};

struct Route : Entry {
  std::size_t environment = 0;  ///< index in Campaign::environments
  Arguments chainage;           ///< options that only conflicts and reports take
};

/// The contents of a campaign.json with patterns resolved, as far as they can be judged without the
/// inputs.
struct Campaign {
  std::string name;
  std::vector<Entry> environments;
  std::vector<Vehicle> vehicles;
  std::vector<Route> routes;
  Arguments radii;  ///< one --radius for each radius
  std::vector<std::string> radius_names;
  Arguments query;
  std::vector<std::string> conflict_formats;  ///< file name extensions, without dot
  bool report = false;
  Arguments conflicts;  ///< options that both conflicts and reports take
  /// The folder of the ledgers, of which each run has its own; empty: none.
  std::filesystem::path ledgers;
  Arguments classes;
  /// Options that only `clearway run` takes, and those that all commands take.
  Arguments search_limits, limits;
  /// A run that is estimated to take longer is divided into shards; 0: no run is.
  double shard_seconds = 0;
  std::vector<std::string> slurm;  ///< options of sbatch
  /// Notes on files that the patterns may be meant to match, and do not.
  std::vector<Message> notes;
};

/// Reads a campaign.json. Paths in it are relative to its folder. Throws InputError that names the
/// key.
Campaign read_campaign(const std::filesystem::path& file);

}  // namespace clearway::campaign
