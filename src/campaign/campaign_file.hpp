#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/option_keys.hpp"

namespace clearway::campaign {

/// An entry of environments, vehicles or routes, or one match of an entry that is a pattern.
struct Entry {
  std::string name;
  /// The key in campaign.json that names its file, for messages.
  std::string key;
  std::filesystem::path file;
  Arguments arguments;
};

struct Vehicle : Entry {
  /// Whether the vehicle's file is a JSON file of several bodies rather than a model.
  bool has_bodies() const { return file.extension() == ".json"; }

  /// Options for what the model is searched as, which only the search takes.
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
  Arguments classes;
  /// Options that only `clearway run` takes, and those that all commands take.
  Arguments search_limits, limits;
  /// A run that is estimated to take longer is divided into shards; 0: no run is.
  double shard_seconds = 0;
  std::vector<std::string> slurm;  ///< options of sbatch
};

/// Reads a campaign.json. Paths in it are relative to its folder. Throws InputError that names the
/// key.
Campaign read_campaign(const std::filesystem::path& file);

}  // namespace clearway::campaign
