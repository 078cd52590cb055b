#include <CLI/CLI.hpp>

#include "clearway/error.hpp"
#include "cli/clearway_program.hpp"
#include "cli/commands.hpp"
#include "cli/support/program.hpp"

namespace clearway::tool {
namespace {

void add_commands(CLI::App& program, int& exit_code) {
  add_check(program, exit_code);
  add_convert(program);
  add_run(program, exit_code);
  add_merge(program, exit_code);
  add_export(program);
  add_conflicts(program, exit_code);
  add_stations(program);
  add_shift(program);
  add_compare(program, exit_code);
  add_info(program);
  add_verify(program, exit_code);
  add_model(program);
  add_report(program);
  add_section(program, exit_code);
  add_scene(program);
  add_trajectory(program);
  add_campaign(program, exit_code);
  program.add_subcommand("bench")->group("")->prefix_command()->callback([] {
    throw UsageError("bench: the experiments are tools/experiments.py, with clearway-bench");
  });
}

constexpr const char* kFirstSteps =
    R"(Clearway says whether a vehicle passes through a scanned environment without
touching it. One command gives the answer, and a page for any browser:

  clearway check scans/ --model car.ply --trajectory path.txt --radius 0.1 -o site

Without data of your own, make a scan of a road, a lorry and its path first:

  clearway scene road -o road
  clearway check road/environment.las --model road/model.ply \
    --trajectory road/trajectory.txt --radius 0.1 -o road/site

clearway --help lists the commands, and clearway COMMAND --help explains one.
)";

}  // namespace

int run_clearway(int argc, char** argv) {
  return run_program({.name = "clearway",
                      .description = "Clearway: does this vehicle, machine or car body pass "
                                     "through this scanned environment without touching it?",
                      .first_steps = kFirstSteps},
                     argc, argv, add_commands);
}

}  // namespace clearway::tool

int main(int argc, char** argv) { return clearway::tool::run_clearway(argc, argv); }
