// Times the kdtree engine against nanoflann on a store, a model and a trajectory; prints one JSON
// object.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/peers/compare_engines.hpp"
#include "clearway/model.hpp"
#include "io/store/store_reader.hpp"
#include "clearway/trajectory.hpp"

namespace {

struct Options {
  std::string environment, model, trajectory;
  double radius = 0.1;
  std::size_t every_pose = 1;
  bool first_pose = false;
  clearway::CompareOptions compare;
};

void measure(const Options& options) {
  using namespace clearway;
  const StoreReader store(options.environment);
  const std::vector<Vec3> model = read_model(options.model);
  const std::vector<Pose> all = read_trajectory(options.trajectory, {});
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < all.size(); i += options.every_pose) poses.push_back(all[i]);
  const std::vector<Vec3> points =
      options.compare.peer ? positions_by_slot(store) : std::vector<Vec3>{};
  const Query query{model, poses, {options.radius, options.first_pose}};
  std::cout << compare_engines(store, points, query, options.compare).dump(2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Times the kdtree engine against nanoflann on the same points, poses and threads");
  app.add_option("--env", options.environment, "store")->required();
  app.add_option("--model", options.model, "model points")->required();
  app.add_option("--trajectory", options.trajectory, "poses")->required();
  app.add_option("--radius", options.radius, "search radius, metres")->capture_default_str();
  app.add_option("--every-pose", options.every_pose, "take every N-th pose only")
      ->check(CLI::PositiveNumber);
  app.add_option("--threads", options.compare.threads, "threads, 0 for all");
  app.add_option("--repetitions", options.compare.repetitions,
                 "runs of each engine; the median counts")
      ->check(CLI::PositiveNumber);
  app.add_flag("--first-pose", options.first_pose, "also find first poses (kdtree only)");
  app.add_flag("!--no-peer", options.compare.peer, "without nanoflann");
  CLI11_PARSE(app, argc, argv);
  try {
    measure(options);
  } catch (const std::exception& error) {
    std::cerr << "clearway_search_bench: " << error.what() << '\n';
    return 4;
  }
  return 0;
}
