#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/ledger.hpp"
#include "clearway/model.hpp"
#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/lengths.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway::tool {

/// The options that commands which find conflicts take besides the results.
struct ConflictCommand {
  ConflictOptions find;
  TrajectoryOptions trajectory_options;
  LengthOptions lengths;
  std::array<const CLI::Option*, 2> axes{};  ///< --forward and --up, where the command has them
};

/// Adds --gap, --min-points, --split, --chainage-start, --memory and --threads.
void add_conflict_options(CLI::App& command, ConflictCommand& options);

/// The ledger that conflicts are compared with.
struct LedgerCommand {
  LedgerOptions options;              ///< without table, no ledger
  std::filesystem::path environment;  ///< the store; empty: not given

  bool is_given() const { return !options.table.empty(); }
};

/// Adds --ledger and --worse-by.
void add_ledger_options(CLI::App& command, LedgerCommand& ledger, LengthOptions& lengths);

/// Adds --update, which needs --ledger.
void add_update_option(CLI::App& command, LedgerCommand& ledger, LengthOptions& lengths);

/// Compares the conflicts with the ledger of the command. store: that was searched, where it is
/// open; null: it is opened where the command names it.
Ledger apply_ledger_of(const LedgerCommand& ledger, const GroupedResult& found,
                       const ConflictOptions& find, const Store* store = nullptr);

/// Adds --forward and --up, which say how the model is seen. `options` outlive the command.
void add_axis_options(CLI::App& command, ConflictCommand& options);

/// Throws UsageError where --forward or --up is given for a result whose run turned the model.
void check_axes(const Result& result, const ConflictCommand& options);

/// Adds --vehicle to a command that takes --model, which is the option `model`.
void add_vehicle_option(CLI::App& command, std::filesystem::path& vehicle,
                        const std::string& description, CLI::Option* model);

/// Adds RESULT, described by `about_result`, and what was searched for it: --env, --model,
/// --vehicle and --trajectory.
void add_searched_inputs(CLI::App& command, const std::string& about_result,
                         std::filesystem::path& result, std::filesystem::path& environment,
                         std::filesystem::path& model, std::filesystem::path& vehicle,
                         std::filesystem::path& trajectory);

/// Reads the poses of a result's trajectory and logs the warnings. labels: where given, becomes
/// what the file says of its poses.
std::vector<Pose> read_poses(const std::filesystem::path& path, TrajectoryOptions options,
                             const Result& result, PoseLabels* labels = nullptr);

/// Options that read the model of a result again as it was read for the search, and turn it as its
/// run did.
ModelOptions model_options_of(const Result& result, ModelOptions options);

/// Throws InputError where a vehicle is given for the result of one model, or a model for the
/// result of a vehicle.
void check_kind_of_model(const Result& result, const std::filesystem::path& model,
                         const std::filesystem::path& vehicle);

/// Reads the bodies of the vehicle that a result is of, at the poses of its path. Throws as
/// read_vehicle.
std::vector<Body> read_bodies_of(const std::filesystem::path& vehicle, const ModelOptions& model,
                                 const ConflictCommand& options, const std::vector<Pose>& path,
                                 const Result& result, std::vector<Message>& warnings);

/// Reads the model that a result is of. Throws InputError for another model.
Model read_model_of(const std::filesystem::path& path, const ModelOptions& options,
                    const Result& result);

}  // namespace clearway::tool
