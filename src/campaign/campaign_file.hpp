#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/option_keys.hpp"

namespace clearway::campaign {

/// An entry of environments, vehicles or routes; of a pattern, one of its matches.
struct Entry {
  std::string name;
  std::string key;  ///< of its file in campaign.json, for messages
  std::filesystem::path file;
  Arguments arguments;
};

struct Vehicle : Entry {
  /// A JSON file of several bodies, not a model.
  bool has_bodies() const { return file.extension() == ".json"; }

  Arguments kind;  ///< what the model is searched as: for the search alone
  Arguments axes;  ///< for conflicts and reports alone
};

struct Route : Entry {
  std::size_t environment = 0;  ///< its index
  Arguments chainage;           ///< for conflicts and reports alone
};

/// A campaign.json, patterns resolved, as far as it can be judged without its inputs.
struct Campaign {
  std::string name;
  std::vector<Entry> environments;
  std::vector<Vehicle> vehicles;
  std::vector<Route> routes;
  Arguments radii;  ///< --radius, one each
  std::vector<std::string> radius_names;
  Arguments query;
  std::vector<std::string> conflict_formats;  ///< endings, without dot
  bool report = false;
  Arguments conflicts;  ///< options of conflicts and reports alike
  Arguments classes;
  Arguments search_limits, limits;  ///< of clearway run alone, of all commands
  double shard_seconds = 0;         ///< a run that is estimated longer is divided; 0: none is
  std::vector<std::string> slurm;   ///< options of sbatch
};

/// Paths of the file are those from its folder. Throws InputError that names the key.
Campaign read_campaign(const std::filesystem::path& file);

}  // namespace clearway::campaign
