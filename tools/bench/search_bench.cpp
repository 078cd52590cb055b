// Times the kdtree engine against nanoflann; prints one JSON object.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/compare_engines.hpp"
#include "bench/stand_in_hall.hpp"
#include "support/memory_cloud.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  std::uint64_t points = 500'000;
  std::uint32_t model_points = 20'000;
  std::uint32_t poses = 4'000;
  double radius = 0.1;
  bool first_pose = false;
  CompareOptions options;
  CLI::App app("Times the kdtree engine against nanoflann on a synthetic hall");
  app.add_option("--points", points, "environment points");
  app.add_option("--model-points", model_points, "model points");
  app.add_option("--poses", poses, "poses");
  app.add_option("--radius", radius, "search radius, metres");
  app.add_option("--threads", options.threads, "threads, 0 for all");
  app.add_option("--repetitions", options.repetitions, "runs of each engine; the median counts")
      ->check(CLI::PositiveNumber);
  app.add_flag("--first-pose", first_pose, "also find first poses (kdtree only)");
  app.add_flag("!--no-peer", options.peer, "without nanoflann");
  CLI11_PARSE(app, argc, argv);
  try {
    const Hall hall = make_hall(points, model_points, poses, 1);
    const Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
    const MemoryCloud cloud(quantise(hall.environment, quantisation), quantisation);
    const auto positions = positions_by_slot(cloud);
    const Question question{hall.model, hall.poses, radius, first_pose};
    std::cout << compare_engines(cloud, positions, question, options).dump(2) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "clearway_search_bench: " << error.what() << '\n';
    return 4;
  }
  return 0;
}
