#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/convert.hpp"
#include "clearway/report.hpp"
#include "clearway/search.hpp"
#include "clearway/stations.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/run_options.hpp"
#include "cli/support/lengths.hpp"
#include "findings/found_conflicts.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace CLI {
class App;
}

/// The steps from scans to a report, as functions: what the commands of the same names do, without
/// what these print on standard output. add_options() adds the options of a step to a command, and
/// perform() does the step and logs what it did. The options outlive the command.
namespace clearway::tool {

/// The options of `clearway convert`.
struct ConvertCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;
  ConvertOptions conversion;
  LengthOptions lengths;
  std::string layout = "adaptive";
  bool json = false;
};

void add_options(CLI::App& command, ConvertCommand& options);
ConvertReport perform(ConvertCommand& options);

/// The options of the commands that write poses; each adds its own.
struct PoseCommand {
  std::filesystem::path input, output, environment;
  TrajectoryOptions trajectory;  ///< how a path is read
  LengthOptions lengths;
  std::string unit = "m";  ///< the symbol of the unit of lengths, for messages
  bool force = false;
  bool json = false;
};

/// The options of `clearway trajectory resample` and thin.
struct ChangeCommand : PoseCommand {
  std::filesystem::path model;  ///< or the file of a vehicle
  double max_motion = 0;
  FileUnit model_unit = {};
  ModelAxes model_axes;
};

/// Adds the options of `clearway trajectory resample`.
void add_options(CLI::App& command, ChangeCommand& options);
/// Writes a path with poses in between.
void perform(ChangeCommand& options);
/// The largest motion of the model from one pose to the next where it exceeds max_motion and poses
/// in between can be added: not where the path has jumps, between which nobody knows the way, and
/// not where millions of poses would be needed. Otherwise 0. The options are not to be used again.
double motion_to_fill(ChangeCommand& options);

/// What a run found.
struct RunOutcome {
  SearchReport report;
  std::string sentence;         ///< the verdict in words
  nlohmann::ordered_json json;  ///< the report as JSON, where options.json asks for it
};

inline void add_options(CLI::App& command, RunOptions& options) {
  add_run_options(command, options);
}
RunOutcome perform(RunOptions& options);

/// The options of `clearway conflicts`.
struct ConflictsCommand : ConflictCommand {
  std::string date = ConflictFile::kNoDate;
  LedgerCommand ledger;
  bool fail_on_collision = false;
};

/// The conflicts in words.
struct ConflictsOutcome {
  std::string text;     ///< a table of the worst conflicts
  std::string worst;    ///< a sentence about the worst one; empty where none is listed
  std::string json;     ///< the summary as one JSON object
  std::string verdict;  ///< the verdict of the result, where the table alone does not show it
  /// What the ledger accepts, in a sentence; empty without a ledger or conflicts
  std::string accepted;
  /// The verdict that decides about success: with a ledger what is left without its accepted
  /// conflicts.
  Verdict outside = Verdict::kUnknown;
};

void add_options(CLI::App& command, ConflictsCommand& options);
/// found: gets the conflicts, for later steps; or null.
ConflictsOutcome perform(ConflictsCommand& options, FoundConflicts* found = nullptr);

/// The options of `clearway stations`.
struct StationsCommand : ConflictCommand {
  double every = StationOptions{}.every;
};

/// The stretches of the path in words.
struct StationsOutcome {
  std::string text;  ///< a table of the first stretches
  std::string json;  ///< the summary as one JSON object
};

void add_options(CLI::App& command, StationsCommand& options);
StationsOutcome perform(StationsCommand& options);

/// The options of `clearway report` for the page of a result.
/// It has one output, but the page of a section may also have a picture.
struct ReportCommand : ConflictCommand {
  std::filesystem::path environment, section, shifts;
  ReportOptions report;
  LedgerCommand ledger;
  std::vector<ParsedLength> classes;
  const CLI::App* command = nullptr;  ///< the command that has these options
};

/// The time in UTC, as a report shows the date of its making.
std::string now_in_utc();

void add_options(CLI::App& command, ReportCommand& options);
/// found: conflicts that an earlier step found, which are taken where they are those of the page;
/// or null.
ReportSummary perform(ReportCommand& options, const FoundConflicts* found = nullptr);

}  // namespace clearway::tool
