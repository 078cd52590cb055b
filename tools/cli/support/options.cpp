#include "cli/support/options.hpp"

#include <CLI/CLI.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "cli/support/lengths.hpp"
#include "cli/support/option_groups.hpp"
#include "core/util/format.hpp"
#include "io/formats/text/text_number.hpp"

namespace clearway::tool {

CLI::Validator positive_length() {
  const auto read = [](std::string& text) -> std::string {
    try {
      text = format_number(parse_length("", text).value);
    } catch (const CLI::ValidationError& error) {
      return error.what();
    }
    return "";
  };
  return {read, "", ""};
}

CLI::Validator seconds_up_to(double most) {
  const auto check = [most](const std::string& text) -> std::string {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value);
    if (number && value >= 0 && value <= most) return "";
    return text + ": expected seconds from 0 to " + std::to_string(static_cast<int>(most));
  };
  return {check, ""};
}

std::uint64_t parse_size(const std::string& option, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (unit.ends_with('b')) unit.pop_back();
  if (unit.size() == 2 && unit[1] == 'i') unit.pop_back();
  const std::string units = "kmgt";
  const auto power = unit.empty() ? 0 : units.find(unit) + 1;
  const double bytes = std::ldexp(value, static_cast<int>(10 * power));
  const bool known = unit.empty() || (unit.size() == 1 && power != 0);
  if (error != std::errc() || !known || !(bytes >= 0 && bytes < 0x1p60)) {
    throw CLI::ValidationError(option,
                               text +
                                   ": expected a size in bytes, or with K, M, G or T (powers of "
                                   "1024), for example 512M or 4G");
  }
  return static_cast<std::uint64_t>(bytes);
}

void add_size_option(CLI::App& command, const std::string& name, std::uint64_t& bytes,
                     const std::string& description) {
  command
      .add_option_function<std::string>(
          name, [&bytes, name](const std::string& text) { bytes = parse_size(name, text); },
          description)
      ->type_name("SIZE");
}

void add_count_option(CLI::App& command, const std::string& name, std::uint64_t& count,
                      std::uint64_t least, std::uint64_t most, const std::string& description) {
  command
      .add_option_function<std::string>(
          name,
          [&count, least, most, name](const std::string& text) {
            const auto given = parse_count(text);
            if (!given || *given < least || *given > most) {
              throw CLI::ValidationError(name, text + ": expected a whole number from " +
                                                   format_count(least) + " to " +
                                                   format_count(most));
            }
            count = *given;
          },
          description)
      ->type_name("N")
      ->default_str(std::to_string(count));
}

void add_memory_option(CLI::App& command, std::uint64_t& bytes) {
  add_size_option(
      command, "--memory", bytes,
      "Bound of the working memory, for example 512M or 4G (default: " + format_size(bytes) + ")");
}

void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
}

void add_model_unit(CLI::App& command, const std::string& names, FileUnit& unit) {
  add_unit_option(command, names, unit,
                  "Unit of the model's file; ft is the environment's foot, ift the international "
                  "and us-ft the US survey foot (default: that of the environment)")
      ->group(title_of(OptionGroup::kUnits));
}

void add_model_options(CLI::App& command, ModelOptions& options, LengthOptions& lengths) {
  const GroupScope group(command, OptionGroup::kModel);
  CLI::Option* spacing =
      lengths.add(command, "--model-spacing", options.spacing,
                  "Search points of a mesh, and no place of its surface is farther than this from "
                  "one (default: a quarter of the radius)");
  add_model_unit(command, "--model-unit", options.unit);
  command
      .add_flag("--model-vertices", options.vertices_only,
                "Take the vertices of a mesh alone as the model, not its surface")
      ->excludes(spacing);
  lengths.add(command, "--model-above", options.above,
              "Leave out the model's points whose z is below this, such as wheels on the ground",
              LengthRange::kAny);
}

}  // namespace clearway::tool
