#include "cli/run_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/ignored_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/geometry/angle.hpp"
#include "core/query/query_fields.hpp"
#include "io/files/text_number.hpp"
#include "io/models/model_input.hpp"
#include "search/check_query.hpp"

namespace clearway::tool {
namespace {

CLI::Option* add_field(CLI::App& command, const QueryField<double>& field, RunOptions& options) {
  if (field.unit == QueryField<double>::Unit::kNone) {
    return command.add_option(field.option, options.query.*field.member, field.help)
        ->type_name("NUMBER");
  }
  return options.lengths.add(command, field.option, options.query.*field.member, field.help);
}

/// Reads an angle such as "0.002", in radians, or "0.1deg". Throws CLI::ValidationError naming the
/// option.
double parse_angle(const std::string& option, const std::string& text) {
  const bool degrees = text.ends_with("deg");
  const std::string number = degrees ? text.substr(0, text.size() - 3) : text;
  const char* at = number.data();
  const char* const end = at + number.size();
  double value = 0;
  if (!number.empty() && parse_number(at, end, value) && at == end && std::isfinite(value) &&
      value >= 0) {
    return degrees ? value * kDegree : value;
  }
  throw CLI::ValidationError(
      option, text +
                  ": expected an angle in radians, 0 or more, for example 0.002, or in degrees, "
                  "for example 0.1deg");
}

CLI::Option* add_field(CLI::App& command, const QueryField<std::optional<double>>& field,
                       RunOptions& options) {
  std::optional<double>& value = options.query.*field.member;
  if (field.unit == QueryField<std::optional<double>>::Unit::kMetres) {
    return options.lengths.add(command, field.option, value, field.help, LengthRange::kFromZero);
  }
  return command
      .add_option_function<std::string>(
          field.option,
          [&value, option = std::string(field.option)](const std::string& text) {
            value = parse_angle(option, text);
          },
          field.help)
      ->type_name("ANGLE");
}

CLI::Option* add_field(CLI::App& command, const QueryField<bool>& field, RunOptions& options) {
  return command.add_flag(field.option, options.query.*field.member, field.help);
}

CLI::Option* add_field(CLI::App& command, const QueryField<std::uint32_t>& field,
                       RunOptions& options) {
  return command.add_option(field.option, options.query.*field.member, field.help)
      ->type_name("N")
      ->check(CLI::Range(1U, 1000000000U));
}

CLI::Option* add_field(CLI::App& command, const QueryField<std::vector<std::uint8_t>>& field,
                       RunOptions& options) {
  return command
      .add_option_function<std::vector<std::string>>(
          field.option,
          [&classes = options.query.*field.member](const std::vector<std::string>& lists) {
            classes = parse_classes(lists);
          },
          field.help)
      ->allow_extra_args(false)
      ->type_name("N,...");
}

CLI::Option* add_field(CLI::App& command, const QueryField<std::vector<Box>>& field,
                       RunOptions& options) {
  return command
      .add_option_function<std::vector<std::string>>(
          field.option,
          [&boxes = options.query.*field.member](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) boxes.push_back(parse_box(text));
          },
          field.help)
      ->allow_extra_args(false)
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
}

void add_inputs(CLI::App& command, RunOptions& options) {
  const GroupScope group(command, OptionGroup::kInputs);
  command.add_option("--env", options.environment, "The environment: a store of clearway convert")
      ->type_name("FILE")
      ->required();
  CLI::Option* model =
      command
          .add_option("--model", options.model,
                      "The model: a mesh in STL, OBJ, PLY or OFF, or points in a scan's format")
          ->type_name("FILE");
  command
      .add_option("--vehicle", options.vehicle,
                  "Instead of --model: a JSON file of several bodies that follow the "
                  "trajectory, each in its own way; engine sweep only")
      ->group(title_of(OptionGroup::kModel))
      ->type_name("FILE")
      ->excludes(model);
  command.add_option("--trajectory", options.trajectory, kTrajectoryHelp)
      ->type_name("FILE")
      ->required();
  for_each_value_field([&](const auto& field) {
    if (field.is_required()) add_field(command, field, options)->required();
  });
  command.add_option("-o,--output", options.output, "The result, an HDF5 file")
      ->type_name("FILE")
      ->required();
  command
      .add_option_function<std::string>(
          "--model-as",
          [&options](const std::string& name) {
            options.model_options.as = name == "solid"     ? ModelAs::kSolid
                                       : name == "surface" ? ModelAs::kSurface
                                       : name == "points"  ? ModelAs::kPoints
                                                           : ModelAs::kAuto;
          },
          "surface: search the triangles of a mesh as they are. solid: and what its closed parts "
          "enclose. points: search points on its surface; the answer says how far they are apart. "
          "auto: surface for a mesh, points for other files (default)")
      ->group(title_of(OptionGroup::kModel))
      ->type_name("KIND")
      ->check(CLI::IsMember({"auto", "surface", "solid", "points"}));
  add_model_options(command, options.model_options, options.lengths);
  add_turn_options(command, options.model_options.forward, options.model_options.up);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
}

void add_query(CLI::App& command, RunOptions& options) {
  for (const OptionGroup title : {OptionGroup::kAsked, OptionGroup::kCertainty}) {
    const GroupScope group(command, title);
    for_each_value_field([&](const auto& field) {
      const bool here = field.is_of_certainty() == (title == OptionGroup::kCertainty);
      if (here && !field.is_required()) add_field(command, field, options);
    });
  }
  const GroupScope group(command, OptionGroup::kIgnored);
  for_each_list_field([&](const auto& field) { add_field(command, field, options); });
}

/// Adds an option that takes the name of one of the values.
template <typename Value>
void add_choice(CLI::App& command, const std::string& option, Value& chosen,
                const std::vector<Value>& values, const std::string& description) {
  std::vector<std::string> names;
  names.reserve(values.size());
  for (const Value value : values) names.emplace_back(name_of(value));
  command
      .add_option_function<std::string>(
          option,
          [&chosen, values](const std::string& name) {
            chosen = *std::ranges::find_if(values,
                                           [&name](Value value) { return name == name_of(value); });
          },
          description)
      ->check(CLI::IsMember(names))
      ->default_str(name_of(chosen));
}

void add_engine(CLI::App& command, SearchOptions& options) {
  const GroupScope group(command, OptionGroup::kSpeed);
  add_choice(
      command, "--engine", options.engine,
      {Engine::kAuto, Engine::kSweep, Engine::kGrid, Engine::kKdtree},
      "sweep, grid or kdtree; auto takes sweep or kdtree, whichever will be faster by estimate");
  add_device_options(command, options.device, options.gpus, options.device_memory_bytes);
  add_threads_option(command, options.threads);
  add_memory_option(command, options.memory_bytes);
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

void add_device_options(CLI::App& command, Device& device, std::vector<int>& gpus,
                        std::uint64_t& device_memory_bytes) {
  add_choice(command, "--device", device, {Device::kAuto, Device::kCpu, Device::kCuda},
             "cpu or cuda; auto takes a GPU where the engine and the machine have one");
  command
      .add_option("--gpus", gpus,
                  "Numbers of the GPUs to use, for example 0,1 (default: the first with room)")
      ->delimiter(',')
      ->type_name("N,...")
      ->check(CLI::Range(0, 1023));
  add_size_option(command, "--device-memory", device_memory_bytes,
                  "Memory bound of each GPU, without CUDA's own (default: 2G, or what is free)");
}

void add_run_options(CLI::App& command, RunOptions& options) {
  add_inputs(command, options);
  add_query(command, options);
  add_engine(command, options.search);
  add_shard(command, options.search);
  CLI::Option* force =
      command.add_flag("--force", options.search.overwrite,
                       "Overwrite an existing result; remove the journal of an earlier run");
  command
      .add_flag("--resume", options.search.resume,
                "Go on with a run of the same query that was interrupted or killed")
      ->excludes(force);
  command
      .add_option(
          "--journal-interval", options.search.journal_interval_seconds,
          "Seconds between two syncs of the journal to the disk; a system crash can cost that much "
          "work")
      ->group(title_of(OptionGroup::kFiles))
      ->type_name("SECONDS")
      ->check(seconds_up_to(3600))
      ->capture_default_str();
  command.add_flag("--strict", options.search.strict,
                   "Treat warnings as errors: nothing is searched (exit code 3)");
  command.add_flag("--fail-on-collision", options.fail_on_collision,
                   "Exit with code 1 where a point collides, and 6 where the verdict is undecided");
  command.add_flag("--json", options.json, "Print one JSON object about the run");
}

}  // namespace clearway::tool
