#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/report.hpp"
#include "core/describe/field.hpp"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace clearway::tool {

/// The heading of a group, for example "The model". For CLI::Option::group.
const char* title_of(OptionGroup group);

/// Puts the options that are added to the command during its lifetime into one group, unless they
/// name another.
class GroupScope {
 public:
  GroupScope(CLI::App& command, OptionGroup group);
  GroupScope(const GroupScope&) = delete;
  GroupScope& operator=(const GroupScope&) = delete;
  ~GroupScope();

 private:
  CLI::App& command_;
  std::string before_;
};

/// Makes the help of the program, and of all commands that are added later, show the groups in
/// their order, without empty groups. Options without a group come after the inputs.
void show_groups_in_order(CLI::App& program);

/// Puts the options that many commands have, such as --force and --json, into their groups, in
/// every command whose help is long enough to need groups. To be called after all commands are
/// added.
void group_common_options(CLI::App& program);

/// Makes every flag of the program and its commands refuse values other than true, false, 1 and 0.
/// To be called after all commands are added.
void check_flags(CLI::App& program);

/// Whether an option takes no value, other than those of check_flags().
bool is_flag(const CLI::Option& option);

/// Whether an option was given, and a flag was not switched off by "=false" or "=0".
bool is_given(const CLI::Option& option);

class LengthOptions;

/// Accepts a finite length above 0 and turns it into metres. For Option::transform.
CLI::Validator positive_length();

/// Accepts a number of seconds from 0 to `most`.
CLI::Validator seconds_up_to(double most);

/// Adds an option that takes a size in bytes; "512M" and "4G" are multiples of powers of 1024.
CLI::Option* add_size_option(CLI::App& command, const std::string& name, std::uint64_t& bytes,
                             const std::string& description);

/// Adds an option for an angle such as "0.002", in radians, or "0.1deg".
CLI::Option* add_angle_option(CLI::App& command, const std::string& name,
                              std::optional<double>& angle, const std::string& description);

/// Adds an option, or an argument, that takes the name of a file, or of several.
CLI::Option* add_file(CLI::App& command, const std::string& names, std::filesystem::path& file,
                      const std::string& description);
CLI::Option* add_file(CLI::App& command, const std::string& names,
                      std::vector<std::filesystem::path>& files, const std::string& description);

/// Adds an option that takes a whole number from `least` to `most`.
CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::uint64_t& count,
                              std::uint64_t least, std::uint64_t most,
                              const std::string& description);

/// Adds --memory, in bytes.
void add_memory_option(CLI::App& command, std::uint64_t& bytes);

/// Adds --threads; 0 stands for all cores.
void add_threads_option(CLI::App& command, int& threads);

/// Adds --model-unit.
void add_model_unit(CLI::App& command, FileUnit& unit);

/// Adds the unit of a file to a command that has no environment, under all of `names`.
void add_unit_alone(CLI::App& command, const std::string& names, FileUnit& unit);

/// Adds the unit of an outline's file to a command that has an environment.
void add_outline_unit(CLI::App& command, FileUnit& unit);

/// Adds an option that takes an axis of the model, such as "+y" or "z".
CLI::Option* add_axis_option(CLI::App& command, const std::string& name, Axis& axis,
                             const std::string& description);

/// Adds --forward and --up, which turn the model when it is read.
void add_turn_options(CLI::App& command, Axis& forward, Axis& up);

/// Adds --model-spacing, --model-unit and --model-vertices.
void add_model_options(CLI::App& command, ModelOptions& options, LengthOptions& lengths);

/// Adds --title, --project, --client, --author and --date, the texts in the head of a page.
void add_page_texts(CLI::App& command, PageTexts& texts);

/// The bytes of "512M", "1.5G", "4GiB" or "300000000". Throws CLI::ValidationError naming the
/// option.
std::uint64_t parse_size(const std::string& option, const std::string& text);

}  // namespace clearway::tool
