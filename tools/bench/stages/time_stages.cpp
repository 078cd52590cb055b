#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "bench/stages/measures.hpp"
#include "clearway/error.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "io/files/file.hpp"
#include "io/store/store_reader.hpp"
#include "search/query_trees.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#ifdef CLEARWAY_CUDA
#include "gpu/devices.hpp"
#include "gpu/sweep_engine.hpp"
#endif

namespace clearway::bench {
namespace {

/// An engine that answers at once and finds nothing, so that only reading is timed.
class NoEngine final : public PageEngine {
 public:
  NoEngine(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
      : pool_(cloud, query, layout), shapes_(layout.slots) {
    for (std::uint32_t slot = 0; slot < layout.slots; ++slot) {
      std::ranges::fill(pool_.page(slot), std::byte{0});  // touched once, as page-locked memory is
      std::ranges::fill(pool_.hits(slot), 0);
    }
  }

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  void start(std::uint32_t slot, const PageShape& shape) override { shapes_[slot] = shape; }
  PageResult finish(std::uint32_t slot) override {
    return {.hits = pool_.hits(slot).first(std::size_t{shapes_[slot].cells} *
                                           shapes_[slot].blocks_per_cell),
            .first_poses = {},
            .clearances = {}};
  }

 private:
  PagePool pool_;
  std::vector<PageShape> shapes_;
};

#ifdef CLEARWAY_CUDA
double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

/// Times pages that are staged beforehand and all started at once; seconds on the device's clock,
/// the best of several runs. Where there are more pages than slots, the first ones stand for all.
Json time_device(const StoreReader& store, const SweepFilter& filter,
                 std::span<const PlannedCell> cells, std::span<const PlannedPage> pages,
                 SlotLayout layout) {
  constexpr std::size_t kMostSlots = 512;
  constexpr int kRepetitions = 5;
  pages = pages.first(std::min(pages.size(), kMostSlots));
  layout.slots = static_cast<std::uint32_t>(pages.size());
  CudaSweepEngine engine(0, filter.ref(), store, layout);
  std::vector<PageShape> shapes;
  std::uint64_t points = 0, bytes = 0;
  for (std::uint32_t slot = 0; slot < layout.slots; ++slot) {
    shapes.push_back(stage_page(store, pages[slot].of(cells), engine.page(slot)));
    bytes += shapes.back().bytes();
    for (const PlannedCell& cell : pages[slot].of(cells)) points += store.cells()[cell.cell].count;
  }
  double upload = 1e9, compute = 1e9;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (std::uint32_t slot = 0; slot < layout.slots; ++slot) engine.start(slot, shapes[slot]);
    Interval sent = engine.finish(0).upload, searched = engine.finish(0).compute;
    for (std::uint32_t slot = 1; slot < layout.slots; ++slot) {
      const PageResult found = engine.finish(slot);
      sent = {std::min(sent.begin, found.upload.begin), std::max(sent.end, found.upload.end)};
      searched = {std::min(searched.begin, found.compute.begin),
                  std::max(searched.end, found.compute.end)};
    }
    upload = std::min(upload, seconds_between(sent.begin, sent.end));
    compute = std::min(compute, seconds_between(searched.begin, searched.end));
  }
  return {
      {"pages", pages.size()},      {"page_bytes", bytes},
      {"points", points},           {"upload_seconds", upload},
      {"compute_seconds", compute}, {"points_per_second", static_cast<double>(points) / compute}};
}
#endif

/// Drops a file from the page cache of the system, so that the next reader waits for the disk.
void drop_from_page_cache(const std::filesystem::path& path) {
  const File file = File::open_for_reading(path);
  int error = ::fsync(file.descriptor()) == 0 ? 0 : errno;  // unwritten pages would stay
  if (error == 0) error = ::posix_fadvise(file.descriptor(), 0, 0, POSIX_FADV_DONTNEED);
  if (error == 0) return;
  throw ResourceError(path.string() + ": cannot drop from the page cache: " + std::strerror(error));
}

}  // namespace

Json time_stages(const StageOptions& options) {
  if (options.cold) drop_from_page_cache(options.environment);
  const StoreReader store(options.environment);
  const std::vector<Vec3> model =
      read_model_points(options.model, {.spacing = options.radius / 4});  // as in clearway run
  const std::vector<Pose> poses = read_trajectory(options.trajectory, {});
  const Query query{model, poses, {.radius = options.radius}};
  const QueryTrees trees(query);
#ifdef CLEARWAY_CUDA
  const bool on_device = cuda_device_count() > 0;
  if (on_device) open_cuda_device(0);
#endif
  const ModelField field(trees.of<Vec3>(), query.radius, {.fineness = 3}, options.threads);
  const SweepFilter filter(query, trees.motion, trees.of<Vec3>(), field, store);
  const std::vector<PlannedCell> cells = plan(store, filter);
  const std::uint64_t cell_bytes = 6 * std::uint64_t{store.cell_points()} + 4096;
  const SlotLayout layout{options.slots,
                          std::max(smallest_page_bytes(store, cells), options.cells * cell_bytes),
                          options.cells};
  const std::vector<PlannedPage> pages = paginate(store, cells, layout.page_bytes, layout.cells);
  NoEngine engine(store, query, layout);
  NoProgress progress;
  StageTimes times;
  PageEngine* const engines[] = {&engine};
  run_pages(
      store, cells, pages, engines, {.threads = options.threads},
      [](std::span<const PlannedCell>, const PageResult&) {}, progress, times);
  Json out{{"pages", pages.size()},
           {"cells_read", store.cells_touched()},
           {"bytes_read", store.bytes_read().coordinates},
           {"read_seconds", times.total}};
#ifdef CLEARWAY_CUDA
  if (on_device) out["device"] = time_device(store, filter, cells, pages, layout);
#endif
  return out;
}

}  // namespace clearway::bench
