#include "cli/run_again.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include "cli/run_options.hpp"
#include "cli/support/options.hpp"
#include "core/describe/query.hpp"
#include "core/util/format.hpp"
#include "core/util/shell_words.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

/// The long name of an option with its hyphens; empty for a positional argument.
std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

/// The value that the command was given for an option; empty without one, or without that option.
std::string given(const CLI::App& command, const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  return option == nullptr || option->empty() ? "" : option->results().back();
}

/// The options that say how a model and a trajectory are read, as the command was given them.
std::string reading_options(const CLI::App& command) {
  CLI::App run;
  RunOptions unused;
  add_run_options(run, unused);
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = name_of(*option);
    const CLI::Option* same = name.empty() ? nullptr : run.get_option_no_throw(name);
    if (same == nullptr || !is_given(*option) || name == "--vehicle") continue;
    // Here they say how the model is seen, and to a run how it is turned.
    if (name == "--forward" || name == "--up") continue;
    constexpr std::array kGroups{OptionGroup::kModel, OptionGroup::kPath, OptionGroup::kUnits};
    const bool reads = std::ranges::any_of(
        kGroups, [same](OptionGroup group) { return same->get_group() == title_of(group); });
    if (!reads) continue;
    text += " " + name;
    if (is_flag(*option)) continue;
    for (const std::string& value : option->results()) text += " " + shell_word(value);
  }
  return text;
}

std::string model_words(const ResultHeader& header, const CLI::App& command) {
  const bool one = header.bodies.empty();
  const std::string name = one ? "--model" : "--vehicle";
  const std::string file = given(command, name);
  std::string text = " " + name + " " +
                     (!file.empty() ? shell_word(file)
                      : one         ? "MODEL"
                                    : "VEHICLE.json");
  if (const ModelAxes axes = header.notes.model_axes; axes.need_turn()) {
    text += std::string(" --forward ") + name_of(axes.forward) + " --up " + name_of(axes.up);
  }
  // No single kind holds for a vehicle, whose bodies may differ.
  if (!one) return text;
  return text + " --model-as " +
         (header.model_solids > 0      ? "solid"
          : header.model_triangles > 0 ? "surface"
                                       : "points");
}

/// A distance that is worth asking for: `factor` times the radius, in round numbers.
double times_radius(const ResultHeader& header, double factor) {
  return std::stod(fmt::format("{:.2g}", factor * header.radius));
}

std::string value_words(const std::string& option, bool value) { return value ? option : ""; }
template <typename Number>
requires std::is_arithmetic_v<Number> std::string value_words(const std::string& option,
                                                              Number value) {
  return option + " " + format_number(static_cast<double>(value));
}
template <typename Value>
std::string value_words(const std::string& option, const std::optional<Value>& value) {
  return value ? value_words(option, *value) : "";
}
std::string value_words(const std::string& option, const std::vector<std::uint8_t>& classes) {
  std::string text;
  for (const std::uint8_t number : classes) {
    text += (text.empty() ? option + " " : ",") + std::to_string(number);
  }
  return text;
}
std::string value_words(const std::string& option, const std::vector<Box>& boxes) {
  std::string text;
  for (const Box& box : boxes) {
    text += option + " ";
    for (const double number : {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}) {
      text += format_number(number) + ",";
    }
    text.pop_back();
  }
  return text;
}

/// The parameters of a result, and beside them what is missing in it.
QueryParameters asked_again(const ResultHeader& header, Remedy missing) {
  QueryParameters asked = header;
  if (missing == Remedy::kAskForFirstPose) asked.first_pose = true;
  if (missing == Remedy::kAskForClearance) asked.clearance = times_radius(header, 3);
  if (missing == Remedy::kAskForProfile) asked.profile = times_radius(header, 5);
  return asked;
}

/// Something that a result can lack, and the ending of the name of a result that has it.
struct Missing {
  const char* name;
  const char* ending;
};

/// Whether a search with this header found nothing of what the remedy asks for.
bool lacks(const ResultHeader& header, Remedy missing) {
  return (missing == Remedy::kAskForFirstPose && !header.first_pose) ||
         (missing == Remedy::kAskForClearance && !(header.clearance > 0)) ||
         (missing == Remedy::kAskForProfile && !(header.profile > 0));
}

std::optional<Missing> missing_of(Remedy remedy) {
  switch (remedy) {
    case Remedy::kAskForFirstPose:
      return Missing{"first poses", "-first-poses.h5"};
    case Remedy::kAskForClearance:
      return Missing{"clearances", "-clearances.h5"};
    case Remedy::kAskForProfile:
      return Missing{"a profile", "-profile.h5"};
    default:
      return std::nullopt;
  }
}

std::string advice(const Missing& missing, const std::string& run) {
  const bool has_capitals =
      run.find(" SITE.h5") != std::string::npos || run.find(" MODEL ") != std::string::npos ||
      run.find(" VEHICLE.json ") != std::string::npos || run.find(" PATH ") != std::string::npos;
  return std::string("This command makes a result with ") + missing.name +
         (has_capitals ? "; give the files of the first run for the words in capitals, "
                         "and its options of model and path where it had some"
                       : "") +
         ":\n  " + run;
}

}  // namespace

std::string query_words(const QueryParameters& query) {
  std::string text;
  for_each_field(kQueryFields, [&](const auto& field) {
    if (field.is_default(query)) return;
    text += value_words(std::string(" ") + field.option, field.of(query));
  });
  return text;
}

std::string run_again(const ResultReader& result, const CLI::App& command,
                      const std::filesystem::path& trajectory, Remedy missing) {
  const ResultHeader& header = result.header();
  const auto lacking = missing_of(missing);
  const bool between = header.between_poses && missing != Remedy::kAskForFirstPose;
  if (!lacking || between) return "";
  const std::string environment = given(command, "--env");
  std::filesystem::path output = result.name();
  output.replace_filename(output.stem().string() + lacking->ending);
  return "clearway run --env " + (environment.empty() ? "SITE.h5" : shell_word(environment)) +
         model_words(header, command) + " --trajectory " +
         (trajectory.empty() ? "PATH" : shell_word(trajectory)) + reading_options(command) +
         query_words(asked_again(header, missing)) + " -o " + shell_word(output);
}

void advising_to_run_again(const CLI::App& command, const std::vector<ReadResult>& results,
                           const std::function<void()>& work) {
  try {
    work();
  } catch (const UsageError& error) {
    const auto missing = missing_of(error.remedy());
    if (!missing) throw;
    for (const ReadResult& read : results) {
      const ResultReader result(read.path);
      if (results.size() > 1 && !lacks(result.header(), error.remedy())) continue;
      const std::string run = run_again(result, command, read.trajectory, error.remedy());
      if (!run.empty()) throw UsageError(error.what() + (". " + advice(*missing, run)));
      break;
    }
    throw;
  }
}

}  // namespace clearway::tool
