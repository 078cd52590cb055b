#include "cli/support/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/support/field_options.hpp"
#include "cli/support/lengths.hpp"
#include "core/describe/model.hpp"
#include "core/describe/search.hpp"
#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "io/files/text_number.hpp"

namespace clearway::tool {
namespace {

constexpr std::array kTitles{"Inputs and output",
                             "The question",
                             "How sure the answer is",
                             "Ignored points",
                             "Only what is near a path",
                             "The store",
                             "The model",
                             "The path",
                             "Units and frames",
                             "Conflicts",
                             "The page",
                             "The page of a section",
                             "Speed and memory",
                             "Files and resume",
                             "Messages and exit code"};

constexpr std::string_view kNoGroup = "Options";  // CLI11's default group

/// The number of options up to which a help text is one list without groups.
constexpr std::size_t kShortHelp = 11;

/// The number of options up to which --help shows all of them.
constexpr std::size_t kMostShown = 17;

/// What --help shows of a command that has more options, besides those that are required: the
/// options that a first use needs, of every command and of single ones.
constexpr std::pair<std::string_view, std::string_view> kFirstUse[]{
    {"",
     "--env --model --vehicle --trajectory --radius --output --floor --model-unit --forward --up "
     "--title --force"},
    {"check", "--near --open"},
    {"run", "--first-pose --clearance --profile"},
    {"convert", "--near --within --unit"},
    {"conflicts", "--ledger --update"},
    {"stations", "--every"},
    {"shift", "--lateral"},
    {"compare", "--conflicts"},
    {"report", "--shifts --section --outline"},
    {"find", "--pivots --margin"},
    {"follow", "--body --at --pivots"}};

/// Columns of a help text, and the one in which the texts of options begin.
constexpr std::size_t kHelpWidth = 80, kTextColumn = 30;

constexpr std::array<std::pair<std::string_view, OptionGroup>, 16> kCommonOptions{
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
     {"--help", OptionGroup::kOutput},
     {"--help-all", OptionGroup::kOutput}}};

/// The place of a group in a help text; CLI11's own group stands after the first.
std::size_t place_of(const std::string& title) {
  if (title == kNoGroup) return 1;
  const auto at = std::ranges::find(kTitles, title);
  return 2 * static_cast<std::size_t>(at - kTitles.begin());
}

bool is_of_first_use(const CLI::App& command, const CLI::Option& option) {
  if (option.get_required()) return true;
  if (option.get_lnames().empty()) return false;
  const std::string name = "--" + option.get_lnames().front();
  return std::ranges::any_of(kFirstUse, [&](const auto& of) {
    const std::vector<std::string> names = CLI::detail::split(std::string(of.second), ' ');
    return (of.first.empty() || of.first == command.get_name()) &&
           std::ranges::find(names, name) != names.end();
  });
}

/// Breaks a paragraph at blanks into lines of at most `width` columns; a longer word has a line of
/// its own.
std::string wrapped(std::string_view text, std::size_t width) {
  std::string out;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (column > 0 && column + 1 + word.size() > width) {
      out += '\n';
      column = 0;
    }
    if (column > 0) out += ' ', ++column;
    out += word;
    column += word.size();
  }
  return out;
}

/// Breaks a line that shows what to type, as a shell reads it, and leaves options and their values
/// together.
std::string wrapped_command(std::string line) {
  constexpr char kTied = '\1';
  for (std::size_t at = line.find(" -"); at != std::string::npos; at = line.find(" -", at + 1)) {
    const std::size_t value = line.find(' ', at + 1);
    if (value != std::string::npos && line[value + 1] != '-') line[value] = kTied;
  }
  std::string out;
  for (const char c : wrapped(line, kHelpWidth - 2)) {
    c == '\n' ? out += " \\\n    " : out += c == kTied ? ' ' : c;
  }
  return out;
}

/// Breaks the paragraphs of a text. Lines that begin with a blank stay as they are, those that
/// begin with "Example" show what to type.
std::string wrapped_paragraphs(const std::string& text) {
  std::string out, paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) out += wrapped(paragraph, kHelpWidth) + "\n";
    paragraph.clear();
  };
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_example = line.starts_with("Example");
    if (is_example || line.empty() || line.starts_with(' ')) {
      end_paragraph();
      out += (is_example ? wrapped_command(line) : line) + "\n";
    } else {
      paragraph += (paragraph.empty() ? "" : " ") + line;
    }
  }
  end_paragraph();
  return out;
}

/// The choices of an option, with what stands before and after them on its left side in a help
/// text, if that is too long for a line.
struct LongChoices {
  std::string before, after;
  std::vector<std::string> choices;

  static std::optional<LongChoices> in(const std::string& name, const std::string& values) {
    const std::size_t begin = values.find(":{"), end = values.find('}', begin);
    if (end == std::string::npos || name.size() + values.size() + 2 <= kHelpWidth) return {};
    return LongChoices{values.substr(0, begin), values.substr(end + 1),
                       CLI::detail::split(values.substr(begin + 2, end - begin - 2), ',')};
  }
};

/// Help in groups. --help shows those that a first use needs, --help-all shows all.
class HelpInOrder : public CLI::Formatter {
 public:
  HelpInOrder() { column_width(kTextColumn); }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return CLI::Formatter::make_help(app, name, mode);
    return make_description(app) + make_usage(app, name) + make_positionals(app) +
           groups_of(*app, mode == CLI::AppFormatMode::All) +
           make_subcommands(app, CLI::AppFormatMode::Normal) + "\n" + make_footer(app);
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped_paragraphs(CLI::Formatter::make_description(app));
  }
  std::string make_footer(const CLI::App* app) const override {
    return wrapped_paragraphs(CLI::Formatter::make_footer(app));
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    const auto choices = choices_of(option);
    return choices ? choices->before + choices->after : values_of(option);
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_desc(option);
    const auto choices = choices_of(option);
    const auto is_unnamed = [&](const std::string& choice) {
      return text.find(choice) == std::string::npos;
    };
    if (choices && std::ranges::any_of(choices->choices, is_unnamed)) {
      text += ": " + CLI::detail::join(choices->choices, ", ");
    }
    return wrapped(text, kHelpWidth - kTextColumn);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::stringstream out;
    const std::string text = command->get_description();
    CLI::detail::format_help(out, command->get_display_name(true),
                             wrapped(text, kHelpWidth - kTextColumn), kTextColumn);
    return out.str();
  }

 private:
  std::optional<LongChoices> choices_of(const CLI::Option* option) const {
    return LongChoices::in(make_option_name(option, false), values_of(option));
  }

  /// What stands behind an option's name. CLI11 2.4 writes a default as " [5] " where 2.1 has "=5",
  /// which is what is shown with either.
  std::string values_of(const CLI::Option* option) const {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string newer = " [" + option->get_default_str() + "]";
    const std::size_t at = text.find(newer);
    if (option->get_default_str().empty() || at == std::string::npos) return text;
    text.replace(at, newer.size(), "=" + option->get_default_str());
    while (text.ends_with(' ')) text.pop_back();
    return text;
  }

  std::string groups_of(const CLI::App& app, bool all) const {
    std::vector<std::string> groups = app.get_groups();
    std::ranges::stable_sort(groups, {}, place_of);
    const std::size_t options = app.get_options(is_listed).size();
    all = all || options <= kMostShown;
    std::string text;
    std::size_t shown = 0;
    for (const std::string& group : groups) {
      const auto of_group = app.get_options([&](const CLI::Option* option) {
        return is_listed(option) && option->get_group() == group &&
               (all || is_of_first_use(app, *option));
      });
      if (of_group.empty()) continue;
      text += make_group(group, false, of_group);
      shown += of_group.size();
    }
    if (shown == options) return text;
    return text + "\n" + std::to_string(options - shown) + " more options: --help-all\n";
  }

  /// Whether a help text has the option among its groups; an empty group hides one.
  static bool is_listed(const CLI::Option* option) {
    return option->nonpositional() && !option->get_group().empty();
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

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

bool is_given(const CLI::Option& option) {
  return !option.empty() && (!is_flag(option) || option.as<bool>());
}

void check_flags(CLI::App& program) {
  // CLI11 itself also takes words such as "on" and all numbers, of which 0.5 would be 0.
  const auto check = [](const std::string& value) -> std::string {
    const bool known = value == "true" || value == "false" || value == "1" || value == "0";
    return known ? "" : value + ": expected true, false, 1, 0 or no value";
  };
  for (CLI::App* command : program.get_subcommands({})) check_flags(*command);
  for (CLI::Option* option : program.get_options()) {
    if (is_flag(*option)) option->check(CLI::Validator(check, ""));
  }
}

CLI::Validator positive_length() {
  const auto read = [](std::string& text) -> std::string {
    const auto length = length_of(text);
    if (!length || !(length->value > 0)) return text + ": " + expected_length();
    text = format_number(length->value);
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

void add_page_texts(CLI::App& command, PageTexts& texts) {
  command.add_option("--title", texts.title, "Title of the page (default: names of the files)")
      ->type_name("TEXT");
  command.add_option("--project", texts.project, "Name of the project, in the head of the page")
      ->type_name("TEXT");
  command.add_option("--client", texts.client, "Who the page is for")->type_name("TEXT");
  command.add_option("--author", texts.author, "Who made it")->type_name("TEXT");
  command.add_option("--date", texts.date, "Date on the page (default: now, in UTC)")
      ->type_name("TEXT");
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

CLI::Option* add_size_option(CLI::App& command, const std::string& name, std::uint64_t& bytes,
                             const std::string& description) {
  return command
      .add_option_function<std::string>(
          name, [&bytes, name](const std::string& text) { bytes = parse_size(name, text); },
          description)
      ->type_name("SIZE");
}

namespace {

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

}  // namespace

CLI::Option* add_angle_option(CLI::App& command, const std::string& name,
                              std::optional<double>& angle, const std::string& description) {
  return command
      .add_option_function<std::string>(
          name, [&angle, name](const std::string& text) { angle = parse_angle(name, text); },
          description)
      ->type_name("ANGLE");
}

CLI::Option* add_file(CLI::App& command, const std::string& names, std::filesystem::path& file,
                      const std::string& description) {
  return command.add_option(names, file, description)->type_name("FILE");
}

CLI::Option* add_file(CLI::App& command, const std::string& names,
                      std::vector<std::filesystem::path>& files, const std::string& description) {
  return command.add_option(names, files, description)->type_name("FILE");
}

CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::uint64_t& count,
                              std::uint64_t least, std::uint64_t most,
                              const std::string& description) {
  return command
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
  add_size_option(command, kMemory<SearchOptions>.option, bytes,
                  kMemory<SearchOptions>.help_with_default());
}

void add_threads_option(CLI::App& command, int& threads) {
  const auto& field = kThreads<SearchOptions>;
  command.add_option(field.option, threads, field.help_with_default())
      ->type_name("N")
      ->check(CLI::Range(static_cast<int>(field.least), static_cast<int>(field.most)));
}

void add_model_unit(CLI::App& command, FileUnit& unit) {
  const auto& field = std::get<0>(kShapeOfModel);
  add_unit_option(command, field.option, unit, field.help_with_default())
      ->group(title_of(field.group));
}

void add_unit_alone(CLI::App& command, const std::string& names, FileUnit& unit) {
  add_unit_option(command, names, unit, kUnitWithoutEnvironment.help_with_default())
      ->group(title_of(kUnitWithoutEnvironment.group));
}

void add_outline_unit(CLI::App& command, FileUnit& unit) {
  add_unit_option(command, "--unit", unit,
                  "Unit of the outline's file; ft is the environment's foot, ift the international "
                  "and us-ft the US survey foot (default: that of the environment)")
      ->group(title_of(OptionGroup::kUnits));
}

CLI::Option* add_axis_option(CLI::App& command, const std::string& name, Axis& axis,
                             const std::string& description) {
  return add_choice<Axis>(command, name, axis, "AXIS", description, kChoices<Axis>, true);
}

void add_turn_options(CLI::App& command, Axis& forward, Axis& up) {
  const GroupScope group(command, OptionGroup::kUnits);
  const auto& [ahead, upward] = kTurnOfModel;
  add_axis_option(command, ahead.option, forward, ahead.help_with_default());
  add_axis_option(command, upward.option, up, upward.help_with_default());
}

void add_model_options(CLI::App& command, ModelOptions& options, LengthOptions& lengths) {
  add_fields(command, kShapeOfModel, options, lengths);
  command.get_option("--model-vertices")->excludes("--model-spacing");
}

}  // namespace clearway::tool
