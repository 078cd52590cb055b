#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

/// The options that `clearway check` takes for its steps. They are those of the commands that the
/// steps are, so that a new option of such a command is one of check as well.
namespace clearway::tool {

/// How check deals with the options of one step.
struct StepOptions {
  /// Long names of the options that check does not offer, because it sets them itself or because
  /// they make no sense for it.
  std::vector<std::string> without;
  /// Options that check offers under another name: that of the step, and that of check.
  std::vector<std::pair<std::string, std::string>> renamed = {};

  /// The name under which check offers an option; empty where it does not.
  std::string name_in_check(const std::string& name) const;
};

/// Adds to `check` the options of a step that it does not have yet. Their values are checked where
/// the step's command line is parsed.
void offer_options(CLI::App& check, const CLI::App& step, const StepOptions& how);

/// The options of a step that `check` was given, as words of a command line.
std::vector<std::string> given_words(const CLI::App& check, const CLI::App& step,
                                     const StepOptions& how);

/// Parses words, such as those of given_words(), as the options of a command. Throws
/// CLI::ParseError.
void parse_words(CLI::App& command, const std::vector<std::string>& words);

}  // namespace clearway::tool
