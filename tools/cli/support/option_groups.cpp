#include "cli/support/option_groups.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace clearway::tool {
namespace {

constexpr std::array kTitles{"Inputs and output", "What is asked",    "What is ignored",
                             "The store",         "The model",        "The path",
                             "Units and frames",  "Conflicts",        "The page",
                             "Speed and memory",  "Files and resume", "Messages and exit code"};

constexpr std::string_view kNoGroup = "Options";  // CLI11's default group

/// The number of options up to which a help text is one list without groups.
constexpr std::size_t kShortHelp = 10;

constexpr std::array<std::pair<std::string_view, OptionGroup>, 15> kCommonOptions{
    {{"--env", OptionGroup::kInputs},
     {"--model", OptionGroup::kInputs},
     {"--trajectory", OptionGroup::kInputs},
     {"--radius", OptionGroup::kInputs},
     {"--output", OptionGroup::kInputs},
     {"--vehicle", OptionGroup::kInputs},
     {"--threads", OptionGroup::kSpeed},
     {"--memory", OptionGroup::kSpeed},
     {"--force", OptionGroup::kFiles},
     {"--resume", OptionGroup::kFiles},
     {"--json", OptionGroup::kOutput},
     {"--show", OptionGroup::kOutput},
     {"--strict", OptionGroup::kOutput},
     {"--fail-on-collision", OptionGroup::kOutput},
     {"--help", OptionGroup::kOutput}}};

/// The place of a group in a help text; CLI11's own group stands behind the first.
std::size_t place_of(const std::string& title) {
  if (title == kNoGroup) return 1;
  const auto at = std::ranges::find(kTitles, title);
  return 2 * static_cast<std::size_t>(at - kTitles.begin());
}

class HelpInOrder : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return CLI::Formatter::make_help(app, name, mode);
    return make_description(app) + make_usage(app, name) + make_positionals(app) + groups_of(*app) +
           make_subcommands(app, mode) + "\n" + make_footer(app);
  }

 private:
  std::string groups_of(const CLI::App& app) const {
    std::vector<std::string> groups = app.get_groups();
    std::ranges::stable_sort(groups, {}, place_of);
    std::string text;
    for (const std::string& group : groups) {
      const auto options = app.get_options([&group](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional();
      });
      if (!group.empty() && !options.empty()) text += make_group(group, false, options);
    }
    return text;
  }
};

}  // namespace

const char* title_of(OptionGroup group) { return kTitles.at(static_cast<std::size_t>(group)); }

GroupScope::GroupScope(CLI::App& command, OptionGroup group)
    : command_(command), before_(command.option_defaults()->get_group()) {
  command_.option_defaults()->group(title_of(group));
}

GroupScope::~GroupScope() { command_.option_defaults()->group(before_); }

void show_groups_in_order(CLI::App& program) { program.formatter(std::make_shared<HelpInOrder>()); }

void group_common_options(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands({})) group_common_options(*command);
  if (program.get_options().size() <= kShortHelp) return;
  for (const auto& [name, group] : kCommonOptions) {
    CLI::Option* option = program.get_option_no_throw(std::string(name));
    if (option != nullptr && option->get_group() == kNoGroup) option->group(title_of(group));
  }
}

}  // namespace clearway::tool
