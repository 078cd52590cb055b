#include <malloc.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <iostream>
#include <new>
#include <string>

#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/console.hpp"
#include "cli/exit_code.hpp"
#include "cli/standard_output.hpp"
#include "io/system/mapped_file.hpp"

namespace {

using namespace clearway::tool;

void check_command(const CLI::App& program, int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "--help";
  if (name == "-h" || name == "--help" || name == "--version") return;
  std::string commands;
  for (const CLI::App* command : program.get_subcommands({})) {
    if (command->get_name() == name) return;
    commands += (commands.empty() ? "" : ", ") + command->get_name();
  }
  throw clearway::UsageError(name + ": no such command; expected one of " + commands +
                             " (clearway --help explains them)");
}

/// Help goes to standard output too: a disk that is full there is an error.
int finish(const CLI::App& program, const CLI::ParseError& error) {
  if (program.exit(error) != 0) return kWrongUsage;
  if (!std::cout.flush()) throw clearway::ResourceError("standard output: cannot write");
  return kDone;
}

int run_command_line(int argc, char** argv) {
  CLI::App program{
      "Clearway: does this vehicle, machine or car body pass through this scanned environment "
      "without touching it?"};
  program.set_version_flag("--version", CLEARWAY_VERSION);
  program.require_subcommand(1);
  int exit_code = kDone;
  clearway::tool::add_convert(program);
  clearway::tool::add_run(program);
  clearway::tool::add_export(program);
  clearway::tool::add_compare(program, exit_code);
  clearway::tool::add_info(program);
  clearway::tool::add_verify(program, exit_code);
  clearway::tool::add_scene(program);
  clearway::tool::add_bench(program);
  clearway::tool::add_trajectory(program);
  check_command(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return finish(program, error);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    clearway::tool::occupy_standard_descriptors();
  } catch (const clearway::ResourceError&) {
    return kResource;
  }
  clearway::tool::start_log();
  clearway::install_map_fault_handler(kResource);
  ::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is an error like a full disk
  ::signal(SIGPIPE, SIG_IGN);  // and so is a pipe that nobody reads
  // Large blocks go back to the system when freed, so that --memory bounds what it sees.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  try {
    return run_command_line(argc, argv);
  } catch (const clearway::UsageError& error) {
    spdlog::error("{}", error.what());
    return kWrongUsage;
  } catch (const clearway::InputError& error) {
    spdlog::error("{}", error.what());
    return kBadInput;
  } catch (const clearway::Interrupted& stopped) {
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
