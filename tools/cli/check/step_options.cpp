#include "cli/check/step_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/support/options.hpp"

namespace clearway::tool {
namespace {

/// The long name of an option with its hyphens; empty for a positional argument.
std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

/// Adds an option that takes what another one takes, and keeps it as text.
void add_like(CLI::App& check, const CLI::Option& original, const std::string& name) {
  const bool renamed = name != long_name(original);
  const std::string description =
      original.get_description() + (renamed ? "; of --origins-path" : "");
  const std::string group =
      renamed ? std::string(title_of(OptionGroup::kStore)) : original.get_group();
  if (is_flag(original)) {
    check.add_flag(name, description)->group(group);
    return;
  }
  CLI::Option* option = check.add_option(name, CLI::callback_t(), description);
  option->type_name(original.get_type_name())->group(group);
  if (!original.get_default_str().empty()) option->default_str(original.get_default_str());
  if (original.get_required()) option->required();
  if (original.get_items_expected_max() > 1) {
    option->expected(1, CLI::detail::expected_max_vector_size)
        ->allow_extra_args(original.get_allow_extra_args())
        ->take_all();
  }
}

}  // namespace

std::string StepOptions::name_in_check(const std::string& name) const {
  if (std::ranges::find(without, name) != without.end()) return "";
  for (const auto& [of_step, of_check] : renamed) {
    if (of_step == name) return of_check;
  }
  return name;
}

void offer_options(CLI::App& check, const CLI::App& step, const StepOptions& how) {
  for (const CLI::Option* option : step.get_options()) {
    const std::string name = how.name_in_check(long_name(*option));
    if (name.empty() || check.get_option_no_throw(name) != nullptr) continue;
    add_like(check, *option, name);
  }
}

std::vector<std::string> given_words(const CLI::App& check, const CLI::App& step,
                                     const StepOptions& how) {
  std::vector<std::string> words;
  for (const CLI::Option* option : step.get_options()) {
    const std::string of_step = long_name(*option), name = how.name_in_check(of_step);
    const CLI::Option* given = name.empty() ? nullptr : check.get_option_no_throw(name);
    if (given == nullptr || !is_given(*given)) continue;
    if (is_flag(*option)) {
      words.push_back(of_step);
      continue;
    }
    for (const std::string& value : given->results()) {
      if (value.starts_with('-') || value.empty()) {
        words.push_back(of_step + "=" + value);
      } else {
        words.insert(words.end(), {of_step, value});
      }
    }
  }
  return words;
}

void parse_words(CLI::App& command, const std::vector<std::string>& words) {
  command.parse(std::vector<std::string>(words.rbegin(), words.rend()));
}

}  // namespace clearway::tool
