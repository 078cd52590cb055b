#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "io/files/json.hpp"

namespace clearway::campaign {

/// The commands of a task, as bits.
enum Commands : unsigned {
  kSearch = 1,  ///< `clearway run`
  kReread = 2,  ///< `clearway run` after a merge, which finds its result and searches nothing
  kMerge = 4,   ///< `clearway merge`
  kReport = 8,  ///< `clearway report`
  kFind = 16,   ///< `clearway conflicts`
  kRuns = kSearch | kReread,
  kFindings = kReport | kFind,
  kReaders = kRuns | kFindings,
  kAll = kReaders | kMerge
};

/// A command line option that a key of campaign.json stands for.
struct Argument {
  std::string key;     ///< for example "vehicles.truck.unit"
  std::string option;  ///< for example "--model-unit"
  std::string value;   ///< empty: a flag
  unsigned commands;   ///< those that take it

  /// The word of the command line, for example "--model-unit=mm".
  std::string text() const { return value.empty() ? option : option + "=" + value; }
};

using Arguments = std::vector<Argument>;

/// An entry of environments, vehicles or routes, or one match of an entry that is a pattern.
struct Entry {
  std::string name;
  /// The key in campaign.json that names its file, for messages.
  std::string key;
  std::filesystem::path file;
  bool is_match = false;        ///< whether a pattern names the file
  Arguments arguments;          ///< the file and its options
  std::size_t environment = 0;  ///< of a route: index in Campaign::environments
};

/// The contents of a campaign.json with patterns resolved, as far as they can be judged without the
/// inputs.
struct Campaign {
  std::string name;
  std::vector<Entry> environments, vehicles, routes;
  Arguments radii;  ///< one --radius for each radius
  Arguments query;
  std::vector<std::string> conflict_formats;  ///< file name extensions, without dot
  bool report = false;
  Arguments outputs;  ///< options of conflicts and reports
  /// The folder of the ledgers, of which each run has its own; empty: none.
  std::filesystem::path ledgers;
  Arguments limits;
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
