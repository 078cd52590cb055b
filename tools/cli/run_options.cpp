#include "cli/run_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/describe/model.hpp"
#include "core/describe/query.hpp"
#include "core/describe/search.hpp"
#include "io/files/text_number.hpp"
#include "io/models/model_input.hpp"
#include "search/check_query.hpp"

namespace clearway::tool {
namespace {

void add_inputs(CLI::App& command, RunOptions& options) {
  const GroupScope group(command, OptionGroup::kInputs);
  add_file(command, "--env", options.environment, "The environment: a store of clearway convert")
      ->required();
  CLI::Option* model =
      add_file(command, "--model", options.model,
               "The model: a mesh in STL, OBJ, PLY or OFF, or points in a scan's format");
  command
      .add_option("--vehicle", options.vehicle,
                  "Instead of --model: a JSON file of several bodies that follow the "
                  "trajectory, each in its own way; engine sweep only")
      ->group(title_of(OptionGroup::kModel))
      ->type_name("FILE")
      ->excludes(model);
  add_file(command, "--trajectory", options.trajectory, kTrajectoryHelp)->required();
  add_required_fields(command, kQueryFields, options.query, options.lengths);
  add_file(command, "-o,--output", options.output, "The result, an HDF5 file")->required();
  add_fields(command, kKindOfModel, options.model_options, options.lengths);
  add_model_options(command, options.model_options, options.lengths);
  add_turn_options(command, options.model_options.forward, options.model_options.up);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
}

/// The shard that "2/7" names; for any other text a shard that is not valid.
Shard parse_shard(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = parse_count(text.substr(0, slash));
  const auto count = parse_count(text.substr(std::min(slash + 1, text.size())));
  constexpr std::uint64_t kTooMany = Shard::kMost + 1;
  return {static_cast<std::uint32_t>(std::min(number.value_or(0), kTooMany)),
          static_cast<std::uint32_t>(std::min(count.value_or(0), kTooMany))};
}

void add_shard(CLI::App& command, SearchOptions& options) {
  const GroupScope group(command, OptionGroup::kFiles);
  command
      .add_option_function<std::string>(
          "--shard",
          [&options](const std::string& text) {
            const Shard shard = parse_shard(text);
            if (!shard.is_valid()) {
              throw CLI::ValidationError(
                  "--shard", text + ": expected a part and the number of parts, at most " +
                                 std::to_string(Shard::kMost) + ", for example 1/16 to 16/16");
            }
            options.shard = shard;
          },
          "Search one part of the work alone, for example 1/16 to 16/16; clearway merge makes the "
          "result of all parts")
      ->type_name("I/N");
}

}  // namespace

ModelOptions model_options_of(const RunOptions& options) {
  ModelOptions how = options.model_options;
  check_model_options(how);
  if (how.as == ModelAs::kSurface || how.as == ModelAs::kSolid) {
    check_surface(options.query, options.search);
  }
  how.radius = options.query.radius;
  return how;
}

void add_run_options(CLI::App& command, RunOptions& options) {
  add_inputs(command, options);
  add_fields(command, kQueryFields, options.query, options.lengths);
  add_fields(command, kEngineFields, options.search, options.lengths);
  add_shard(command, options.search);
  add_fields(command, kFileFields, options.search, options.lengths);
  command.get_option("--resume")->excludes("--force");
  add_field(command, kStrict<SearchOptions>, options.search, options.lengths);
  command.add_flag("--fail-on-collision", options.fail_on_collision,
                   "Exit with code 1 where a point collides, and 6 where the verdict is undecided");
  command.add_flag("--json", options.json, "Print one JSON object about the run");
}

}  // namespace clearway::tool
