#include "cli/support/program.hpp"

#include <malloc.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/mistyped.hpp"
#include "cli/support/options.hpp"
#include "core/messages/remedies.hpp"
#include "core/util/format.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/mapped_file.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::tool {
namespace {

/// The name in options of a unit of length, or UNIT where it has none.
std::string option_of_length(double metres) {
  for (const std::string& name : file_unit_names()) {
    const double named = FileUnit::named(name).metres();
    if (std::abs(named - metres) < 1e-6 * named) return name;
  }
  return "UNIT";
}

/// Three columns from `first` on, counted from 1, as --columns takes them.
std::string columns_from(double first) {
  const auto x = static_cast<unsigned>(first);
  return std::to_string(x) + "," + std::to_string(x + 1) + "," + std::to_string(x + 2);
}

/// The amount of a remedy in a form that options take.
std::string text_of(double amount, RemedyAmount kind) {
  switch (kind) {
    case RemedyAmount::kBytes:
      return std::to_string(static_cast<std::uint64_t>(amount));
    case RemedyAmount::kColumn:
      return columns_from(amount);
    case RemedyAmount::kLengthUnit:
      return option_of_length(amount);
    case RemedyAmount::kNumber:
    case RemedyAmount::kNothing:
      break;
  }
  return format_number(amount);
}

}  // namespace

std::string advice_on(const Error& error) {
  const RemedyKind& kind = kind_of(error.remedy());
  if (kind.words_with_amount.empty() || !(error.amount() > 0)) return std::string(kind.words);
  std::string words(kind.words_with_amount);
  return words.replace(words.find("{}"), 2, text_of(error.amount(), kind.amount));
}

namespace {

bool has_number(const Message& message, std::string_view name) {
  return std::ranges::any_of(message.numbers, [&](const auto& n) { return n.first == name; });
}

}  // namespace

std::string advice_on(const Message& message) {
  if (message.code == "large-steps") {
    if (has_number(message, "turn_degrees")) {  // the ways between poses are searched

      return message.severity == Message::Severity::kNote
                 ? ""
                 : ". More poses of the recording help; where none are missing, clearway "
                   "trajectory "
                   "resample adds poses on a smooth curve";
    }
    return has_number(message, "of_mesh") ? ". clearway trajectory resample adds poses"
                                          : ". clearway trajectory resample adds poses, or "
                                            "--between-poses searches the way too";
  }
  if (message.code == "line-curved") {
    return "; --corner-radius keeps legs straight and rounds their corners";
  }
  if (message.code == "half-outline") {
    return "; --mirror completes a half, as rows of height,half_width";
  }
  if (message.code == "loose-vertices") {
    return ", or search all vertices, and nothing else of the file, with --model-vertices";
  }
  if (message.code == "withheld-points") {
    const bool kept = std::ranges::any_of(message.numbers, [](const auto& n) {
      return n == std::pair{std::string("kept"), 1.0};
    });
    return kept ? "" : "; --keep-withheld keeps them";
  }
  if (message.code == "below-ground" || message.code == "sideways") {
    const bool of_model =
        has_number(message, "model_height") || has_number(message, "model_longest");
    return of_model ? ". clearway run --forward and --up turn the model when it is read" : "";
  }
  if (message.code == "one-long-conflict" && has_number(message, "ground")) {
    return ". clearway run --floor, or a higher one, judges only what lies at that height of the "
           "vehicle or above";
  }
  if (message.code == "one-long-conflict" && has_number(message, "inside")) {
    return ". If it is that vehicle, leave it out where the scans are exported, or give its points "
           "a class, which clearway run --ignore-class leaves out";
  }
  return "";
}

namespace {

/// The first option for one value that the command line gives several times; nullptr without one.
const CLI::Option* repeated_option(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    if (const CLI::Option* option = repeated_option(*command)) return option;
  }
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 1 && option->count() > 1) return option;
  }
  return nullptr;
}

/// CLI11's message on an error; the one on a repeated option is reworded, because it says too
/// little.
std::string failure_text(const CLI::App& program, const CLI::Error& error) {
  const bool mismatch = dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr;
  const CLI::Option* option = mismatch ? repeated_option(program) : nullptr;
  if (option == nullptr) return error.what();
  return option->get_name() + ": given more than once; expected one, but there are " +
         std::to_string(option->count());
}

/// The words of the command that was called, such as "clearway section find".
std::string name_of_command(const CLI::App& program, std::string name) {
  for (const CLI::App* command : program.get_subcommands()) {
    return name_of_command(*command, name + " " + command->get_name());
  }
  return name;
}

/// Prints help, version or the error. Help goes to standard output, where a full disk is an error.
int finish(const CLI::App& program, const std::string& name, const CLI::ParseError& error) {
  if (error.get_exit_code() != 0) {
    spdlog::error("{} ({} --help explains it)", failure_text(program, error),
                  name_of_command(program, name));
    return kWrongUsage;
  }
  program.exit(error);
  if (!std::cout.flush()) throw ResourceError("standard output: cannot write");
  return kDone;
}

/// Whether the words name the program, or a command, that has commands of its own, and nothing
/// else.
bool is_group_alone(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* command = &program;
  for (const std::string& word : words) {
    const auto named =
        command->get_subcommands([&](const CLI::App* below) { return below->get_name() == word; });
    if (named.empty()) return false;
    command = named.front();
  }
  return !command->get_subcommands({}).empty();
}

int run(const ProgramText& text, int argc, char** argv, AddCommands add_commands) {
  CLI::App program{text.description};
  program.set_version_flag("--version", CLEARWAY_VERSION);
  program.set_help_flag("-h,--help", "Print what a first use needs, and exit");
  program.set_help_all_flag("--help-all", "Print all options, and exit");
  program.require_subcommand(1);
  int exit_code = kDone;
  show_groups_in_order(program);
  add_commands(program, exit_code);
  group_common_options(program);
  check_flags(program);
  std::vector<std::string> words = checked_words(program, text.name, argc, argv);
  if (words.empty() && *text.first_steps != '\0') {
    print(text.first_steps);
    return kDone;
  }
  if (is_group_alone(program, words)) words.emplace_back("--help");
  std::vector<const char*> pointers{argv[0]};
  for (const std::string& word : words) pointers.push_back(word.c_str());
  try {
    program.parse(static_cast<int>(pointers.size()), pointers.data());
  } catch (const CLI::ParseError& error) {
    return finish(program, text.name, error);
  }
  return exit_code;
}

/// Sets what belongs to the process as a whole and is not for a library to change.
void prepare_process() {
  start_log();
  hdf5::silence_for_good();
  install_map_fault_handler(kResource);
  ::signal(SIGXFSZ, SIG_IGN);  // exceeding the limit of file sizes becomes a write error
  ::signal(SIGPIPE, SIG_IGN);  // a closed pipe becomes a write error
  // Large blocks go back to the system when they are freed, so that --memory bounds what the system
  // sees.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

}  // namespace

int run_program(const ProgramText& text, int argc, char** argv, AddCommands add_commands) {
  try {
    occupy_standard_descriptors();
  } catch (const ResourceError&) {
    return kResource;
  }
  prepare_process();
  const auto fail = [](ExitCode code, const Error& error) {
    spdlog::error("{}{}", error.what(), advice_on(error));
    return code;
  };
  try {
    return run(text, argc, argv, add_commands);
  } catch (const UsageError& error) {
    return fail(kWrongUsage, error);
  } catch (const InputError& error) {
    return fail(kBadInput, error);
  } catch (const ResourceError& error) {
    return fail(kResource, error);
  } catch (const Interrupted& error) {
    return fail(kInterrupted, error);
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory; a smaller --memory or fewer --threads may help");
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  return kResource;
}

}  // namespace clearway::tool
