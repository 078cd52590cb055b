#include <CLI/CLI.hpp>

#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/support/program.hpp"

namespace {

using namespace clearway::tool;

void add_commands(CLI::App& program, int& exit_code) {
  add_convert(program);
  add_run(program, exit_code);
  add_export(program);
  add_conflicts(program);
  add_compare(program, exit_code);
  add_info(program);
  add_verify(program, exit_code);
  add_model(program);
  add_scene(program);
  add_trajectory(program);
  program.add_subcommand("bench")->group("")->prefix_command()->callback(
      [] { throw clearway::UsageError("bench: the experiments are the program clearway-bench"); });
}

}  // namespace

int main(int argc, char** argv) {
  return run_program({.name = "clearway",
                      .description = "Clearway: does this vehicle, machine or car body pass "
                                     "through this scanned environment without touching it?"},
                     argc, argv, add_commands);
}
