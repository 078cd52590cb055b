#include "cli/support/program.hpp"

#include <malloc.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/advice.hpp"
#include "cli/support/console.hpp"
#include "cli/support/exit_code.hpp"
#include "cli/support/mistyped.hpp"
#include "cli/support/option_groups.hpp"
#include "cli/support/standard_output.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/system/mapped_file.hpp"

namespace clearway::tool {
namespace {

/// CLI11's message on an error; the one on a repeated option is reworded, because it says too
/// little.
std::string failure_text(const CLI::App* program, const CLI::Error& error) {
  constexpr std::string_view kOnce = ": At Most 1 required but received ";
  std::string text = CLI::FailureMessage::simple(program, error);
  const std::size_t at = text.find(kOnce);
  if (at == std::string::npos) return text;
  text.replace(at, kOnce.size(), ": given more than once; expected one, but there are ");
  return text;
}

/// Prints help, version or the error. Help goes to standard output, where a full disk is an error.
int finish(const CLI::App& program, const CLI::ParseError& error) {
  if (program.exit(error) != 0) return kWrongUsage;
  if (!std::cout.flush()) throw ResourceError("standard output: cannot write");
  return kDone;
}

int run(const ProgramText& text, int argc, char** argv, AddCommands add_commands) {
  CLI::App program{text.description};
  program.set_version_flag("--version", CLEARWAY_VERSION);
  program.require_subcommand(1);
  int exit_code = kDone;
  program.failure_message(failure_text);
  show_groups_in_order(program);
  add_commands(program, exit_code);
  group_common_options(program);
  const std::vector<std::string> words = checked_words(program, text.name, argc, argv);
  std::vector<const char*> pointers{argv[0]};
  for (const std::string& word : words) pointers.push_back(word.c_str());
  try {
    program.parse(static_cast<int>(pointers.size()), pointers.data());
  } catch (const CLI::ParseError& error) {
    return finish(program, error);
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
  try {
    return run(text, argc, argv, add_commands);
  } catch (const UsageError& error) {
    spdlog::error("{}{}", error.what(), advice_on(error));
    return kWrongUsage;
  } catch (const InputError& error) {
    spdlog::error("{}{}", error.what(), advice_on(error));
    return kBadInput;
  } catch (const ResourceError& error) {
    spdlog::error("{}{}", error.what(), advice_on(error));
    return kResource;
  } catch (const Interrupted& stopped) {
    spdlog::error("{}", stopped.what());
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory; a smaller --memory or fewer --threads may help");
    return kResource;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kResource;
  }
}

}  // namespace clearway::tool
