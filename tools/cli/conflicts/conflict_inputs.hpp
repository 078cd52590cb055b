#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/ledger.hpp"
#include "clearway/model.hpp"
#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway::tool {

/// A result, and the files that were searched for it; empty where they are not given.
struct SearchedFiles {
  std::filesystem::path result, trajectory, model, vehicle;

  /// All of them with the files that the vehicle names, and `others`.
  std::vector<std::filesystem::path> with(std::vector<std::filesystem::path> others) const;
};

/// What commands about the conflicts of a result have in common.
struct ConflictCommand : SearchedFiles {
  std::vector<std::filesystem::path> outputs;
  ConflictOptions find;
  ModelOptions model_options;
  TrajectoryOptions trajectory_options;
  LengthOptions lengths;
  std::array<const CLI::Option*, 2> axes{};  ///< --forward and --up, where the command has them
  std::uint64_t show = 20;
  bool force = false, json = false;
};

/// Adds RESULT and --trajectory.
void add_result_inputs(CLI::App& command, ConflictCommand& options);

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

/// Does `work`, the work of a command about one result, which a signal may stop. Where the result
/// lacks what another run would give, the message has its command line.
void work_on_result(const CLI::App& command, const ConflictCommand& options,
                    const std::function<void()>& work);

/// Adds --forward and --up, which say how the model is seen. `options` outlive the command.
void add_axis_options(CLI::App& command, ConflictCommand& options);

/// Adds --vehicle to a command that takes --model, which is the option `model`.
void add_vehicle_option(CLI::App& command, std::filesystem::path& vehicle,
                        const std::string& description, CLI::Option* model);

/// A result with the path, and the model or the bodies, that were searched for it.
class OpenedResult {
 public:
  /// Opens the result of some files. Throws InputError where a vehicle is given for the result of
  /// one model, or a model for that of a vehicle, and UsageError where --forward or --up is given
  /// for a result whose run turned the model. All arguments outlive this object.
  OpenedResult(ConflictCommand& options, const SearchedFiles& files);
  OpenedResult(const OpenedResult&) = delete;
  OpenedResult& operator=(const OpenedResult&) = delete;

  /// Reads the files that are given, with lengths in the unit of the store or else of the result,
  /// and sets in the options what finding conflicts needs to know of them. Throws InputError for
  /// another model than that of the result. store: that was searched, where it is open.
  void read(const Store* store = nullptr);
  /// Logs the messages of read(), of bodies the warnings alone.
  void log_messages() const;

  Result result;
  std::vector<Pose> poses;
  PoseLabels labels;
  Model model;
  std::vector<Body> bodies;
  std::vector<Message> messages;     ///< of reading, those of the path first
  std::size_t messages_of_path = 0;  ///< how many of them are

 private:
  void read_model_again(const ModelOptions& again);
  void read_bodies_again(const ModelOptions& again);

  ConflictCommand& options_;
  const SearchedFiles& files_;
  ConsoleProgress progress_;
};

/// Outputs that do not exist yet, with their formats.
template <typename Format>
class NewOutputs {
 public:
  /// format_of: throws UsageError for an unknown ending. inputs: must not be overwritten.
  NewOutputs(const ConflictCommand& options, Format (*format_of)(const std::filesystem::path&),
             const std::vector<std::filesystem::path>& inputs) {
    for (const std::filesystem::path& path : options.outputs) formats_.push_back(format_of(path));
    for (const std::filesystem::path& path : options.outputs) {
      refuse_overwriting(path, inputs);
      files_.emplace_back(path, options.force);
    }
  }

  bool has(Format format) const { return std::ranges::find(formats_, format) != formats_.end(); }

  /// Calls write(format, path) for each, and then publishes all.
  template <typename Write>
  void write(const Write& write) {
    for (std::size_t i = 0; i < files_.size(); ++i) write(formats_[i], files_[i].partial());
    for (PendingFile& file : files_) file.publish();
  }

 private:
  std::vector<Format> formats_;
  std::deque<PendingFile> files_;
};

/// A column of a table on the terminal.
template <typename Row>
struct TextColumn {
  std::string title;
  std::size_t least_width;
  std::function<std::string(const Row&)> cell;
  bool to_left = false;  ///< as words are at the end of a line
};

/// The titles in a line, and each row in one.
template <typename Row>
std::string table_text(const std::vector<TextColumn<Row>>& columns,
                       const std::vector<const Row*>& rows) {
  std::vector<std::string> lines(1 + rows.size());
  for (const auto& [title, least_width, cell_of, to_left] : columns) {
    std::vector<std::string> cells{title};
    for (const Row* row : rows) cells.push_back(cell_of(*row));
    std::size_t width = to_left ? 0 : least_width;
    for (const std::string& cell : cells) width = std::max(width, to_left ? 0 : cell.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      lines[i] += fmt::format("{}{:>{}}", lines[i].empty() ? "" : "  ", cells[i], width);
    }
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

/// A range of chainages or stations.
std::string range_text(double from, double to);

/// The first `most` rows as a table, and how many more there are; empty without rows. The columns
/// of their chainages and stations stand before the column `at`.
template <typename Row>
std::string stretches_text(std::vector<TextColumn<Row>> columns, std::ptrdiff_t at,
                           const std::vector<Row>& rows, std::size_t most, const std::string& unit,
                           const char* one, const char* many) {
  std::vector<const Row*> shown;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i) shown.push_back(&rows[i]);
  if (shown.empty()) return "";
  if (rows.front().station_from) {
    columns.insert(columns.begin() + at, {"station (m)", 23, [](const Row& row) {
                                            return range_text(*row.station_from, *row.station_to);
                                          }});
  }
  columns.insert(columns.begin() + at, {"chainage (" + unit + ")", 19, [](const Row& row) {
                                          return range_text(row.chainage_from, row.chainage_to);
                                        }});
  const std::size_t more = rows.size() - shown.size();
  return table_text(columns, shown) + (more == 0 ? ""
                                                 : "and " + counted(more, one, many) +
                                                       " more, which --show or an output shows\n");
}

}  // namespace clearway::tool
