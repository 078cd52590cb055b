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
/// their order, without empty groups. Options without a group come behind the inputs.
void show_groups_in_order(CLI::App& program);

/// Puts the options that many commands have, such as --force and --json, into their groups, in
/// every command whose help is long enough to need groups. To be called after all commands are
/// added.
void group_common_options(CLI::App& program);

}  // namespace clearway::tool
