// Reads the pages that a run on a GPU would read, and does nothing with them; prints one JSON
// object.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "clearway/search_plan.hpp"
#include "core/page_pool.hpp"
#include "io/model.hpp"
#include "io/store.hpp"
#include "io/trajectory.hpp"
#include "stream/paginate.hpp"
#include "stream/run_pages.hpp"

namespace {

using namespace clearway;

struct Options {
  std::string environment, model, trajectory;
  double radius = 0.1;
  int threads = 0;
  std::uint32_t slots = 16, cells = 16;
};

/// Finds nothing, at once.
class NoEngine final : public PageEngine {
 public:
  NoEngine(const PackedCloud& cloud, const Question& question, const SlotLayout& layout)
      : pool_(cloud, question, layout), shapes_(layout.slots) {
    for (std::uint32_t slot = 0; slot < layout.slots; ++slot) {
      std::ranges::fill(pool_.page(slot), std::byte{0});  // touched, as page-locked memory is
      std::ranges::fill(pool_.hits(slot), 0);
    }
  }

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  void start(std::uint32_t slot, const PageShape& shape) override { shapes_[slot] = shape; }
  PageAnswer finish(std::uint32_t slot) override {
    return {.hits = pool_.hits(slot).first(std::size_t{shapes_[slot].cells} *
                                           shapes_[slot].blocks_per_cell),
            .first_poses = {},
            .clearances = {}};
  }

 private:
  PagePool pool_;
  std::vector<PageShape> shapes_;
};

void measure(const Options& options) {
  const Store store(options.environment);
  const std::vector<Vec3> model = read_model(options.model);
  const std::vector<Pose> poses = read_trajectory(options.trajectory, {});
  const Question question{.model = model, .poses = poses, .radius = options.radius};
  const tool::QuestionTrees trees(question);
  const tool::SearchPlan plan(store, question, trees, {}, options.threads);
  const std::uint64_t cell_bytes = 6 * std::uint64_t{store.cell_points()} + 4096;
  const SlotLayout layout{
      options.slots, std::max(plan.least_page_bytes(), options.cells * cell_bytes), options.cells};
  const std::vector<PlannedPage> pages =
      paginate(store, plan.cells, layout.page_bytes, layout.cells);
  NoEngine engine(store, question, layout);
  NoProgress progress;
  StageTimes times;
  run_pages(store, plan.cells, pages, engine, question, options.threads, progress, times);
  std::cout << nlohmann::ordered_json{{"pages", pages.size()},
                                      {"cells_read", store.touched().cells},
                                      {"bytes_read", store.touched().bytes},
                                      {"read_seconds", times.total}}
                   .dump(2)
            << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Reads the pages of a run, and does nothing with them");
  app.add_option("--env", options.environment, "store")->required();
  app.add_option("--model", options.model, "model points")->required();
  app.add_option("--trajectory", options.trajectory, "poses")->required();
  app.add_option("--radius", options.radius, "search radius, metres")->capture_default_str();
  app.add_option("--threads", options.threads, "threads, 0 for all");
  app.add_option("--slots", options.slots, "pages in flight")->capture_default_str();
  app.add_option("--cells", options.cells, "cells of a page")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    measure(options);
  } catch (const std::exception& error) {
    std::cerr << "clearway_stage_bench: " << error.what() << '\n';
    return 4;
  }
  return 0;
}
