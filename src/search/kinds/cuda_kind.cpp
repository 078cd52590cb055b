#include "search/kinds/cuda_kind.hpp"

#include <algorithm>

#include "cpu/sweep_engine.hpp"
#include "gpu/grid_engine.hpp"
#include "gpu/sweep_engine.hpp"
#include "search/check_query.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/kinds/sweep_kind.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kMostSlots = 64;
/// Pages on the way to a device, on it and back, beside those that are read. A slot takes 4 ms to
/// make, so that more of them cost more than they spare.
constexpr std::uint32_t kPagesOnDevice = 8;
/// Small pages, many in flight: a page takes a reading thread about a millisecond.
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
PageEngineNeeds needs_of(const StoreReader& store, const SearchOptions& options,
                         const DeviceChoice& device, std::uint32_t waiting) {
  const auto wanted = static_cast<std::uint32_t>(options.threads) + kPagesOnDevice;
  return {.most_slots = waiting > 1 ? kMostSlots : std::min(kMostSlots, wanted),
          .page_cells = kPageCells,
          .page_bytes = usual_page_bytes(store),
          .threads = options.threads + static_cast<int>(device.gpus.size() * waiting),
          .devices = static_cast<std::uint32_t>(device.gpus.size()),
          .on_gpu = true,
          .most_device_bytes = device.memory_bytes,
          .short_device = device.short_device};
}

template <typename Make>
PageEngines on_each(const std::vector<int>& gpus, Make make) {
  PageEngines engines;
  for (const int gpu : gpus) engines.push_back(make(gpu));
  return engines;
}

/// Adds up what the engines took, and their statistics.
template <typename Engine, typename Statistics>
Statistics report_of(const PageEngines& engines, SearchReport& report) {
  Statistics total;
  for (const auto& one : engines) {
    const auto& on_device = dynamic_cast<const Engine&>(*one);
    total.add(on_device.statistics());
    report.peak_device_bytes = std::max(report.peak_device_bytes, on_device.device_bytes());
    report.pinned_bytes += on_device.pinned_bytes();
  }
  return total;
}

class CudaSweepKind final : public SweepKind {
 public:
  CudaSweepKind(const StoreReader& store, const Query& query, const SearchOptions& options,
                const DeviceChoice& device)
      : SweepKind(needs_of(store, options, device, 1), store, query, options, kFieldFineness),
        gpus_(device.gpus) {}

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override {
    return gpus_.size() * (layout.slots * cuda_sweep_pinned_bytes(filter_->ref(), store_, layout) +
                           SweepEngine::profile_bytes(store_, query_, layout, most_poses));
  }
  std::uint64_t device_bytes(const SlotLayout& layout) const override {
    const SweepRef& sweep = filter_->ref();
    return cuda_sweep_bytes(sweep) + layout.slots * cuda_sweep_slot_bytes(sweep, store_, layout);
  }
  PageEngines make(const SlotLayout& layout) override {
    return on_each(gpus_, [&](int gpu) {
      return std::make_unique<CudaSweepEngine>(gpu, filter_->ref(), store_, layout);
    });
  }
  void report_search(const PageEngines& engines, SearchReport& report,
                     const MessageLog& log) const override {
    report_statistics(report_of<CudaSweepEngine, SweepStatistics>(engines, report), report, log);
  }

 private:
  std::vector<int> gpus_;
};

class CudaGridKind final : public GridKind {
 public:
  CudaGridKind(const StoreReader& store, const Query& query, const SearchOptions& options,
               const DeviceChoice& device)
      : GridKind(needs_of(store, options, device, kMostSlots), store, query, options),
        gpus_(device.gpus) {}

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t) const override {
    return gpus_.size() * layout.slots * cuda_grid_pinned_bytes(*scene_, layout);
  }
  std::uint64_t device_bytes(const SlotLayout& layout) const override {
    return cuda_grid_bytes(*scene_) + layout.slots * cuda_grid_slot_bytes(*scene_, layout);
  }
  PageEngines make(const SlotLayout& layout) override {
    return on_each(gpus_,
                   [&](int gpu) { return std::make_unique<CudaGridEngine>(gpu, *scene_, layout); });
  }
  void report_search(const PageEngines& engines, SearchReport& report,
                     const MessageLog& log) const override {
    report_statistics(report_of<CudaGridEngine, GridStatistics>(engines, report), log);
  }

 private:
  std::vector<int> gpus_;
};

}  // namespace

std::unique_ptr<PageEngineKind> cuda_kind(const StoreReader& store, const Query& query,
                                          const SearchOptions& options,
                                          const DeviceChoice& device) {
  if (chosen_engine(options) == Engine::kGrid) {
    return std::make_unique<CudaGridKind>(store, query, options, device);
  }
  return std::make_unique<CudaSweepKind>(store, query, options, device);
}

}  // namespace clearway
