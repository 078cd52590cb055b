#include "search/cuda_run.hpp"

#include <algorithm>

#include "gpu/grid_engine.hpp"
#include "gpu/sweep_engine.hpp"
#include "search/grid_run.hpp"
#include "search/sweep_run.hpp"

namespace clearway {
namespace {

/// Small pages, many in flight: a page takes a reading thread about a millisecond.
constexpr std::uint32_t kMostSlots = 64;
constexpr std::uint32_t kPageCells = 16;
/// A third of the usual voxel: a GPU has the bandwidth for a larger field, and fewer exact searches
/// keep its warps together.
constexpr double kFieldFineness = 3;

/// x, y and z of a full page of typical cells, their boxes and nodes.
std::uint64_t usual_page_bytes(const StoreReader& store) {
  const std::uint64_t a_cell = 6 * std::uint64_t{store.cell_points()} + 4096;
  return kPageCells * a_cell;
}

/// waiting: threads that wait for each device.
PageEngineKind cuda_kind(const StoreReader& store, const EngineOptions& options,
                         const DeviceChoice& device, std::uint32_t waiting) {
  PageEngineKind kind;
  kind.most_slots = kMostSlots;
  kind.page_cells = kPageCells;
  kind.page_bytes = usual_page_bytes(store);
  kind.threads = options.threads + static_cast<int>(device.gpus.size() * waiting);
  kind.most_device_bytes = device.memory_bytes;
  kind.short_device = device.short_device;
  kind.devices = static_cast<std::uint32_t>(device.gpus.size());
  return kind;
}

template <typename Make>
PageEngines on_each(const DeviceChoice& device, Make make) {
  PageEngines engines;
  for (const int gpu : device.gpus) engines.push_back(make(gpu));
  return engines;
}

/// Adds up what the engines took, and their statistics.
template <typename Engine, typename Statistics>
Statistics report_of(const PageEngines& engines, EngineReport& report) {
  Statistics total;
  for (const auto& one : engines) {
    const auto& on_device = dynamic_cast<const Engine&>(*one);
    total.add(on_device.statistics());
    report.peak_device_bytes = std::max(report.peak_device_bytes, on_device.device_bytes());
    report.pinned_bytes += on_device.pinned_bytes();
  }
  return total;
}

}  // namespace

PageEngineKind cuda_sweep(const StoreReader& store, const EngineOptions& options,
                          const DeviceChoice& device) {
  PageEngineKind kind = cuda_kind(store, options, device, 1);
  kind.field_fineness = kFieldFineness;
  kind.host_bytes = [&store, device](const SearchPlan& plan, const SlotLayout& layout) {
    return device.gpus.size() * layout.slots *
           cuda_sweep_pinned_bytes(plan.filter.ref(), store, layout);
  };
  kind.device_bytes = [&store](const SearchPlan& plan, const SlotLayout& layout) {
    const SweepRef& sweep = plan.filter.ref();
    return cuda_sweep_bytes(sweep) + layout.slots * cuda_sweep_slot_bytes(sweep, store, layout);
  };
  kind.make = [&store, device](const SearchPlan& plan, const SlotLayout& layout) {
    return on_each(device, [&](int gpu) {
      return std::make_unique<CudaSweepEngine>(gpu, plan.filter.ref(), store, layout);
    });
  };
  kind.finished = [](const SearchPlan&, const PageEngines& engines, EngineReport& report) {
    report_statistics(report_of<CudaSweepEngine, SweepStatistics>(engines, report), report);
  };
  return kind;
}

PageEngineKind cuda_grid(const StoreReader& store, const Query& query, const EngineOptions& options,
                         const DeviceChoice& device) {
  PageEngineKind kind = cuda_kind(store, options, device, kMostSlots);
  const LazyGridScene scene(store, query, options);
  kind.host_bytes = [scene, device](const SearchPlan& plan, const SlotLayout& layout) {
    const GridScene& grid = scene.of(plan);
    return grid.size_bytes() +
           device.gpus.size() * layout.slots * cuda_grid_pinned_bytes(grid, layout);
  };
  kind.device_bytes = [scene](const SearchPlan& plan, const SlotLayout& layout) {
    const GridScene& grid = scene.of(plan);
    return cuda_grid_bytes(grid) + layout.slots * cuda_grid_slot_bytes(grid, layout);
  };
  kind.make = [scene, device](const SearchPlan& plan, const SlotLayout& layout) {
    return on_each(device, [&](int gpu) {
      return std::make_unique<CudaGridEngine>(gpu, scene.of(plan), layout);
    });
  };
  kind.finished = [scene](const SearchPlan& plan, const PageEngines& engines,
                          EngineReport& report) {
    report.grid_cell = scene.of(plan).grid_cell();
    log_statistics(scene.of(plan), report_of<CudaGridEngine, GridStatistics>(engines, report));
  };
  return kind;
}

}  // namespace clearway
