#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/stages/measures.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"

namespace clearway::bench {
namespace {

/// A command that prints what `measure` returns, with the options of every command: a store, a
/// model, a trajectory, a radius and threads. Returns it and its options, to which more are added.
template <typename Options>
std::pair<CLI::App&, Options&> add_command(CLI::App& program, const char* name, const char* help,
                                           Json (*measure)(const Options&)) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand(name, help);
  const auto file = [&](const char* option, std::filesystem::path& path, const char* what) {
    command.add_option(option, path, what)->type_name("FILE")->required();
  };
  file("--env", options->environment, "A store of clearway convert");
  file("--model", options->model, "The model's points");
  file("--trajectory", options->trajectory, "The poses");
  command.add_option("--radius", options->radius, "Search radius in metres")
      ->type_name("METRES")
      ->transform(tool::positive_length())
      ->capture_default_str();
  tool::add_threads_option(command, options->threads);
  command.callback([options, measure] { tool::print(measure(*options).dump(2) + "\n"); });
  return {command, *options};
}

template <typename Value>
void add_count(CLI::App& command, const char* name, Value& value, const char* help, int most) {
  command.add_option(name, value, help)
      ->type_name("N")
      ->check(CLI::Range(1, most))
      ->capture_default_str();
}

void add_search(CLI::App& program) {
  const auto& [command, options] = add_command<SetEngines>(
      program, "search",
      "Searches with engines that are set as no clearway run sets them, so that the result may not "
      "be exact; writes it and prints JSON",
      search_with_set_engines);
  command.add_option("-o,--output", options.output, "The result, an HDF5 file")
      ->type_name("FILE")
      ->required();
  const auto choose = [&](const char* name, auto& chosen, auto usual, auto other,
                          const std::pair<const char*, const char*>& names, const char* help) {
    chosen = usual;
    command
        .add_option_function<std::string>(
            name,
            [&chosen, usual, other, names](const std::string& text) {
              chosen = text == names.first ? usual : other;
            },
            help)
        ->check(CLI::IsMember({names.first, names.second}))
        ->default_str(names.first);
  };
  choose("--engine", options.search.engine, Engine::kSweep, Engine::kGrid, {"sweep", "grid"},
         "The engine that searches");
  choose("--device", options.search.device, Device::kCpu, Device::kCuda, {"cpu", "cuda"},
         "Where it searches");
  command.add_option("--gpus", options.search.gpus, "As of clearway run")->delimiter(',');
  tool::add_size_option(command, "--memory", options.search.memory_bytes, "As of clearway run");
  tool::add_size_option(command, "--device-memory", options.search.device_memory_bytes,
                        "As of clearway run");
  const auto length = [&](const std::string& name, double& metres, const char* help) {
    command.add_option(name, metres, help)->type_name("METRES")->transform(tool::positive_length());
  };
  length("--field-voxel", options.settings.field_voxel,
         "Voxel of the sweep engine's model field (default: chosen)");
  length("--grid-cell", options.settings.grid.grid_cell,
         "Grid cell of engine grid (default: chosen)");
  choose("--precision", options.settings.grid.precision, GridPrecision::kExact,
         GridPrecision::kFloat, {"exact", "float"},
         "float: engine grid decides in single precision alone");
}

void add_commands(CLI::App& program, int&) {
  const auto& [share, shares] = add_command<ShareOptions>(
      program, "share",
      "Says what share of a scene a search touches, and what touching more than that costs; prints "
      "JSON",
      measure_shares);
  add_count(share, "--repetitions", shares.repetitions, "Searches of which the median counts", 100);
  const auto& [stages, pages] = add_command<StageOptions>(
      program, "stages",
      "Times reading alone and, with a GPU, sending and searching alone; prints JSON", time_stages);
  add_count(stages, "--slots", pages.slots, "Pages in flight", 4096);
  add_count(stages, "--cells", pages.cells, "Cells of a page", 4096);
  stages.add_flag("--cold", pages.cold, "Drop the store from the page cache before");
  add_search(program);
}

}  // namespace
}  // namespace clearway::bench

int main(int argc, char** argv) {
  return clearway::tool::run_program(
      {.name = "clearway-bench",
       .description = "Measures parts of Clearway, and engines as no run sets them, for the "
                      "experiments of tools/experiments.py."},
      argc, argv, clearway::bench::add_commands);
}
