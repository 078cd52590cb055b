#pragma once

#include <string>

namespace CLI {
class App;
}

namespace clearway::tool {

/// The groups of options in a help text, in the order in which it shows them.
enum class OptionGroup {
  kInputs,
  kAsked,
  kIgnored,
  kStore,
  kModel,
  kPath,
  kUnits,
  kConflicts,
  kPage,
  kSpeed,
  kFiles,
  kOutput
};

/// The heading of a group, for example "The model". For CLI::Option::group.
const char* title_of(OptionGroup group);

/// Options that are added to the command during its lifetime are of this group, unless they say
/// otherwise.
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

/// Makes the help of the program and of all commands that are added to it later show the groups in
/// their order, those without options left out. Options without a group come behind the inputs.
void show_groups_in_order(CLI::App& program);

/// Gives the options that many commands have, such as --force and --json, their groups in every
/// command whose help is long enough to need them. To be called when all commands are there.
void group_common_options(CLI::App& program);

}  // namespace clearway::tool
