#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/stages/set_engines.hpp"
#include "bench/stages/share.hpp"
#include "bench/stages/time_stages.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"

namespace clearway::bench {
namespace {

/// What every command is asked: a store, a model, a trajectory and a radius.
template <typename Options>
void add_query(CLI::App& command, Options& options, int& threads) {
  const auto file = [&](const char* name, std::filesystem::path& path, const char* help) {
    command.add_option(name, path, help)->type_name("FILE")->required();
  };
  file("--env", options.environment, "A store of clearway convert");
  file("--model", options.model, "The model's points");
  file("--trajectory", options.trajectory, "The poses");
  command.add_option("--radius", options.radius, "Search radius in metres")
      ->type_name("METRES")
      ->transform(tool::positive_length())
      ->capture_default_str();
  tool::add_threads_option(command, threads);
}

template <typename Value>
void add_count(CLI::App& command, const char* name, Value& value, const char* help, int most) {
  command.add_option(name, value, help)
      ->type_name("N")
      ->check(CLI::Range(1, most))
      ->capture_default_str();
}

void add_share(CLI::App& program) {
  const auto options = std::make_shared<ShareOptions>();
  CLI::App* command = program.add_subcommand(
      "share",
      "Says what share of a scene a search touches, and what touching more than that costs; prints "
      "JSON");
  add_query(*command, *options, options->threads);
  add_count(*command, "--repetitions", options->repetitions, "Searches of which the median counts",
            100);
  command->callback([options] { tool::print(measure_shares(*options).dump(2) + "\n"); });
}

void add_stages(CLI::App& program) {
  const auto options = std::make_shared<StageOptions>();
  CLI::App* command = program.add_subcommand(
      "stages", "Times reading alone and, with a GPU, sending and searching alone; prints JSON");
  add_query(*command, *options, options->threads);
  add_count(*command, "--slots", options->slots, "Pages in flight", 4096);
  add_count(*command, "--cells", options->cells, "Cells of a page", 4096);
  command->add_flag("--cold", options->cold, "Drop the store from the page cache before");
  command->callback([options] { tool::print(time_stages(*options).dump(2) + "\n"); });
}

void add_search(CLI::App& program) {
  const auto options = std::make_shared<SetEngines>();
  CLI::App* command = program.add_subcommand(
      "search",
      "Searches with engines that are set as no clearway run sets them, so that the result may not "
      "be exact; writes it and prints JSON");
  add_query(*command, *options, options->search.threads);
  command->add_option("-o,--output", options->output, "The result, an HDF5 file")
      ->type_name("FILE")
      ->required();
  const auto choose = [&](const char* name, auto& chosen, auto usual, auto other,
                          const std::pair<const char*, const char*>& names, const char* help) {
    chosen = usual;
    command
        ->add_option_function<std::string>(
            name,
            [&chosen, usual, other, names](const std::string& text) {
              chosen = text == names.first ? usual : other;
            },
            help)
        ->check(CLI::IsMember({names.first, names.second}))
        ->default_str(names.first);
  };
  choose("--engine", options->search.engine, Engine::kSweep, Engine::kGrid, {"sweep", "grid"},
         "The engine that searches");
  choose("--device", options->search.device, Device::kCpu, Device::kCuda, {"cpu", "cuda"},
         "Where it searches");
  command->add_option("--gpus", options->search.gpus, "As of clearway run")->delimiter(',');
  tool::add_size_option(*command, "--memory", options->search.memory_bytes, "As of clearway run");
  tool::add_size_option(*command, "--device-memory", options->search.device_memory_bytes,
                        "As of clearway run");
  const auto length = [&](const std::string& name, double& metres, const char* help) {
    command->add_option(name, metres, help)
        ->type_name("METRES")
        ->transform(tool::positive_length());
  };
  length("--tolerance", options->settings.tolerance,
         "Engine sweep may decide wrongly for points within this of the radius");
  length("--field-voxel", options->settings.field_voxel,
         "Voxel of the sweep engine's model field (default: chosen)");
  length("--grid-cell", options->settings.grid.grid_cell,
         "Grid cell of engine grid (default: chosen)");
  choose("--precision", options->settings.grid.precision, GridPrecision::kExact,
         GridPrecision::kFloat, {"exact", "float"},
         "float: engine grid decides in single precision alone");
  command->callback([options] { tool::print(search_with_set_engines(*options).dump(2) + "\n"); });
}

void add_commands(CLI::App& program, int&) {
  add_share(program);
  add_stages(program);
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
