#include "bench/commands.hpp"
#include "cli/support/program.hpp"

namespace {

void add_commands(CLI::App& program, int& exit_code) {
  clearway::bench::add_experiments(program, exit_code);
  clearway::bench::add_stages(program);
  clearway::bench::add_session(program);
  clearway::bench::add_search(program);
}

}  // namespace

int main(int argc, char** argv) {
  return clearway::tool::run_program(
      {.name = "clearway-bench",
       .description = "Measures Clearway: the paper's experiments and ours, as JSON for charts."},
      argc, argv, add_commands);
}
