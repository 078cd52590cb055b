#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/campaign_file.hpp"
#include "clearway/shard.hpp"

namespace clearway::campaign {

/// The command lines of one task, without the program's name; "out.h5" and so on are in its folder.
using Command = std::vector<std::string>;

inline constexpr const char* kResultName = "out.h5";
inline constexpr const char* kPartName = "part.h5";  ///< of a shard
inline constexpr const char* kReportName = "report.html";

/// What one process does: a run and its outputs; a shard of one; or, of a run that is divided, the
/// merge of its shards and the outputs.
// NOLINTNEXTLINE(bugprone-exception-escape): of JSON that is moved
struct Task {
  std::size_t number = 0;
  std::string vehicle, route, environment, radius;
  std::string unit;  ///< of lengths, for people: "m"
  nlohmann::ordered_json question;
  std::optional<Shard> shard;        ///< of a shard
  std::uint32_t shards = 0;          ///< of a merge: the tasks before it
  std::string store;                 ///< of a merge: the fingerprint that its shards are of
  std::vector<std::string> outputs;  ///< names of the files beside the result
  std::vector<Command> commands;     ///< the first one makes the result
  std::string outputs_id;            ///< of how the outputs are made, whatever the limits

  /// "truck/north/0.1", "truck/north/0.1/shards/2": it and its folder below the campaign's.
  std::string name() const {
    return vehicle + "/" + route + "/" + radius +
           (shard ? "/shards/" + std::to_string(shard->number) : "");
  }
  std::filesystem::path folder() const { return std::filesystem::path("runs") / name(); }
  const char* result() const { return shard ? kPartName : kResultName; }
  std::string question_id() const;
};

struct Plan {
  std::string name;
  std::vector<Task> tasks;
};

/// Of a merge: a task that it waits for, with all but its commands. number: from 1.
Task shard_of(const Task& merge, std::uint32_t number);

/// Of a shard: its run, as far as the result goes: without outputs and commands.
Task run_of(const Task& shard);

/// A run as it is to be asked.
struct PlannedRun {
  const Vehicle& vehicle;
  const Route& route;
  const Argument& radius;
  const Entry& environment;
  Arguments arguments;                                 ///< all of its command line
  std::vector<std::pair<Command, Arguments>> outputs;  ///< the other command lines, for messages
};

/// What reading the inputs of a run tells.
struct RunFacts {
  nlohmann::ordered_json question;
  std::string unit;
  std::uint32_t shards = 1;  ///< that it is divided into
  std::string store;         ///< its fingerprint, as text
};

/// Vehicles, routes and radii in the order of the file, radii innermost. The shards of a run come
/// before their merge. facts_of reads what a task would read, and refuses what that would refuse.
Plan make_plan(const Campaign& campaign,
               const std::function<RunFacts(const PlannedRun&)>& facts_of);

}  // namespace clearway::campaign
