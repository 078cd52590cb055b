#include "search/kinds/cuda_kind.hpp"

#include <algorithm>
#include <functional>
#include <future>

#include "core/util/stopwatch.hpp"
#include "core/util/threads.hpp"
#include "cpu/sweep_engine.hpp"
#include "gpu/beam_engine.hpp"
#include "gpu/devices.hpp"
#include "gpu/grid_engine.hpp"
#include "gpu/section_engine.hpp"
#include "gpu/sweep_engine.hpp"
#include "search/check_query.hpp"
#include "search/kept_on_gpus.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/memory_budget.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kMostSlots = 64;
/// Slots for pages on the way to a device, on it and on the way back, besides the pages that are
/// being read. A slot takes 4 ms to make, so more slots would cost more than they save.
constexpr std::uint32_t kPagesOnDevice = 8;
/// Cells of a page. Pages are small and many are in flight: a thread reads one in about a
/// millisecond.
constexpr std::uint32_t kPageCells = 16;
/// By what factor voxels are finer than usual. A GPU has the bandwidth for a larger field, and
/// fewer exact searches keep its warps together.
constexpr double kFieldFineness = 3;

/// Bytes of a full page of typical cells: their x, y and z, boxes and nodes.
std::uint64_t usual_page_bytes(const PackedCloud& cloud) {
  const std::uint64_t a_cell = 6 * std::uint64_t{cloud.cell_points()} + 4096;
  return kPageCells * a_cell;
}

/// waiting: the number of threads that wait for each device.
PageEngineNeeds needs_of(const PackedCloud& cloud, const SearchOptions& options,
                         std::uint32_t waiting) {
  const std::size_t gpus = std::max<std::size_t>(options.gpus.size(), 1);
  const auto wanted = static_cast<std::uint32_t>(options.threads) + kPagesOnDevice;
  return {.most_slots = waiting > 1 ? kMostSlots : std::min(kMostSlots, wanted),
          .page_cells = kPageCells,
          .page_bytes = usual_page_bytes(cloud),
          .threads = options.threads + static_cast<int>(gpus * waiting),
          .waiting_threads = static_cast<int>(gpus * waiting),
          .devices = static_cast<std::uint32_t>(gpus),
          .on_gpu = true};
}

/// The GPUs of an engine, chosen once they are needed.
class Gpus {
 public:
  Gpus(OpenGpus open, bool end_contexts) : open_(std::move(open)), end_contexts_(end_contexts) {}

  void resolve(PageEngineNeeds& needs) {
    if (!indices_.empty()) return;
    const DeviceChoice chosen = open_();
    indices_ = chosen.gpus;
    budget_ = chosen.memory_bytes;
    needs.most_device_bytes = chosen.memory_bytes;
    needs.short_device = chosen.short_device;
  }
  std::size_t size() const { return indices_.size(); }
  const std::vector<int>& indices() const { return indices_; }
  /// Bytes that may be taken on each GPU.
  std::uint64_t budget() const { return budget_; }

  /// Makes an engine on each GPU, all at once.
  template <typename Make>
  PageEngines engines(Make make) const {
    std::vector<std::future<std::unique_ptr<PageEngine>>> making;
    // A single engine needs no thread.
    const auto how = indices_.size() > 1 ? kBeside : std::launch::deferred;
    for (const int gpu : indices_) making.push_back(std::async(how, make, gpu));
    PageEngines engines;
    for (auto& one : making) engines.push_back(one.get());
    return engines;
  }

  /// Takes the engines down on other threads, because unlocking memory takes 0.15 s for each GiB,
  /// and ending a context 0.3 s.
  EngineEnd end(PageEngines engines) const {
    EngineEnd ending;
    for (std::size_t i = 0; i < engines.size(); ++i) {
      ending.push_back(std::async(kBeside, [engine = std::move(engines[i]), gpu = indices_[i],
                                            all = end_contexts_]() mutable {
        engine.reset();
        if (all) end_cuda_device(gpu);
      }));
    }
    return ending;
  }

 private:
  OpenGpus open_;
  bool end_contexts_;
  std::vector<int> indices_;
  std::uint64_t budget_ = 0;
};

/// Adds up the statistics of the engines, and reports the memory that they took.
template <typename Engine, typename Statistics>
Statistics report_of(EngineList engines, SearchReport& report) {
  Statistics total;
  for (const PageEngine* one : engines) {
    const auto& on_device = dynamic_cast<const Engine&>(*one);
    total.add(on_device.statistics());
    report.peak_device_bytes = std::max(report.peak_device_bytes, on_device.device_bytes());
    report.pinned_bytes += on_device.pinned_bytes();
  }
  return total;
}

template <typename Element>
class CudaSweepKindOf final : public SweepKindOf<Element> {
 public:
  CudaSweepKindOf(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
                  OpenGpus open, KeptOnGpus* kept, const EngineSettings& settings)
      : SweepKindOf<Element>(needs_of(cloud, options, 1), cloud, query, options, kFieldFineness,
                             settings),
        gpus_(std::move(open), options.end_gpus),
        kept_(kept != nullptr && kept->are_of(cloud) ? kept : nullptr) {}

  void resolve_devices() override {
    gpus_.resolve(this->needs_);
    if (kept_ != nullptr) this->needs_.most_device_bytes = kept_->left_of(gpus_.budget());
  }

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override {
    return gpus_.size() *
           (layout.slots * cuda_sweep_pinned_bytes(filter_->ref(), cloud_, layout) +
            SweepEngineOf<Element>::profile_bytes(cloud_, query_, layout, most_poses));
  }
  std::uint64_t device_bytes(const SlotLayout& layout) const override {
    const SweepRefOf<Element>& sweep = filter_->ref();
    return cuda_sweep_bytes(sweep) + layout.slots * cuda_sweep_slot_bytes(sweep, cloud_, layout);
  }
  std::uint64_t own_device_bytes(const SlotLayout& layout) const override {
    const std::uint64_t all = device_bytes(layout);
    if (kept_ == nullptr) return all;
    const std::uint64_t model = cuda_model_bytes(filter_->ref());
    return kept_->keeps_model(model, gpus_.budget()) ? all - model : all;
  }
  PageEngines make(const SlotLayout& layout) override {
    KeptOnGpus::OnDevices kept;
    if (kept_ != nullptr) kept = kept_->on(gpus_.indices(), gpus_.budget());
    return gpus_.engines([&](int gpu) -> std::unique_ptr<PageEngine> {
      if (!kept.empty()) {
        return CudaSweepEngineOf<Element>::of_kept(filter_->ref(), this->field_, cloud_, layout,
                                                   kept.at(gpu));
      }
      return std::make_unique<CudaSweepEngineOf<Element>>(gpu, filter_->ref(), cloud_, layout);
    });
  }
  EngineEnd end(PageEngines engines) const override {
    if (kept_ == nullptr) return gpus_.end(std::move(engines));
    engines.clear();  // what they leave takes no time to end
    return {};
  }
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override {
    this->log_statistics(report_of<CudaSweepEngineOf<Element>, SweepStatistics>(engines, report),
                         log);
  }

 private:
  using SweepKindOf<Element>::cloud_;
  using SweepKindOf<Element>::query_;
  using SweepKindOf<Element>::filter_;

  Gpus gpus_;
  KeptOnGpus* const kept_;
};

class CudaGridKind final : public GridKind {
 public:
  CudaGridKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
               OpenGpus open, const GridOptions& scene_options)
      : GridKind(needs_of(cloud, options, kMostSlots), cloud, query, scene_options),
        gpus_(std::move(open), options.end_gpus) {}

  void resolve_devices() override { gpus_.resolve(needs_); }

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t) const override {
    return gpus_.size() * layout.slots * cuda_grid_pinned_bytes(*scene_, layout);
  }
  std::uint64_t device_bytes(const SlotLayout& layout) const override {
    return cuda_grid_bytes(*scene_) + layout.slots * cuda_grid_slot_bytes(*scene_, layout);
  }
  PageEngines make(const SlotLayout& layout) override {
    return gpus_.engines([&](int gpu) -> std::unique_ptr<PageEngine> {
      return std::make_unique<CudaGridEngine>(gpu, *scene_, layout);
    });
  }
  EngineEnd end(PageEngines engines) const override { return gpus_.end(std::move(engines)); }
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override {
    log_statistics(report_of<CudaGridEngine, GridStatistics>(engines, report), log);
  }

 private:
  Gpus gpus_;
};

}  // namespace

std::unique_ptr<PageEngineKind> cuda_kind(const PackedCloud& cloud, const Query& query,
                                          const SearchOptions& options, OpenGpus open,
                                          KeptOnGpus* kept, const EngineSettings& settings) {
  if (options.engine == Engine::kGrid) {
    return std::make_unique<CudaGridKind>(cloud, query, options, std::move(open), settings.grid);
  }
  return for_element_of(query.model, [&]<typename Element>() -> std::unique_ptr<PageEngineKind> {
    return std::make_unique<CudaSweepKindOf<Element>>(cloud, query, options, std::move(open), kept,
                                                      settings);
  });
}

namespace {

/// Bytes that pages take with a layout, and what is kept besides them.
struct PageBytes {
  std::function<std::uint64_t(const SlotLayout&)> on_device;  ///< of each device
  std::function<std::uint64_t(const SlotLayout&)> on_host;    ///< for each device
  std::uint64_t kept = 0;                                     ///< bytes on the host besides these
};

/// The largest layout whose pages fit the memory of host and device.
SlotLayout layout_that_fits(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                            bool masked, const PageBytes& bytes, std::uint64_t memory_bytes,
                            const PageEngineNeeds& needs) {
  std::uint64_t least_device = 0, least_host = 0;
  const std::uint64_t kept = bytes.kept + run_pages_bytes(cells.size());
  for (const SlotLayout& layout : layouts(needs, smallest_page_bytes(cloud, cells, masked))) {
    least_device = bytes.on_device(layout);
    least_host = kept + needs.devices * bytes.on_host(layout);
    if (least_device <= needs.most_device_bytes && least_host <= memory_bytes) {
      return needed_layout(cloud, cells, masked, needs.devices, layout);
    }
  }
  if (least_device > needs.most_device_bytes) {
    refuse_device_memory(least_device, needs.most_device_bytes, needs.short_device);
  }
  throw ResourceError("too little memory for pages on the way to a GPU", Remedy::kMoreMemory,
                      static_cast<double>(least_host));
}

std::vector<PageEngine*> lanes_of(const PageEngines& engines) {
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) lanes.push_back(engine.get());
  return lanes;
}

}  // namespace

BeamCounts follow_beams_on_gpus(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                const Beams& beams, BrickMap& map, std::uint64_t memory_bytes,
                                const SearchOptions& options, OpenGpus open, Progress& progress,
                                SearchReport& report) {
  Gpus gpus(std::move(open), options.end_gpus);
  PageEngineNeeds needs = needs_of(cloud, options, 1);
  gpus.resolve(needs);
  const PageBytes bytes{
      .on_device =
          [&](const SlotLayout& of) {
            return cuda_beam_bytes(beams) + of.slots * cuda_beam_slot_bytes(beams, cloud, of);
          },
      .on_host =
          [&](const SlotLayout& of) { return of.slots * cuda_beam_pinned_bytes(beams, cloud, of); },
      .kept = beams.map.words().size_bytes()};
  const SlotLayout layout = layout_that_fits(cloud, cells, false, bytes, memory_bytes, needs);
  PageEngines engines = gpus.engines([&](int gpu) -> std::unique_ptr<PageEngine> {
    return std::make_unique<CudaBeamEngine>(gpu, beams, cloud, layout);
  });
  const std::vector<PageEngine*> lanes = lanes_of(engines);
  StageTimes times;
  run_pages(
      cloud, cells, paginate(cloud, cells, layout.page_bytes, layout.cells), lanes,
      {.stage = "beams", .threads = needs.threads},
      [](std::span<const PlannedCell>, const PageResult&) {}, progress, times);
  BeamCounts counts;
  std::vector<std::vector<std::uint64_t>> words;
  for (const PageEngine* lane : lanes) {
    const auto& engine = dynamic_cast<const CudaBeamEngine&>(*lane);
    words.push_back(engine.words());
    counts.add(engine.counts());
    report.peak_device_bytes = std::max(report.peak_device_bytes, engine.device_bytes());
  }
  for (const auto& of_device : words) map.clear_as_in(of_device);
  gpus.end(std::move(engines)).clear();
  return counts;
}

EngineEnd block_cells_on_gpus(const PackedCloud& cloud, const IgnoredPoints& ignored,
                              std::span<const PlannedCell> cells, const SectionRef& section,
                              std::uint64_t memory_bytes, const SearchOptions& options,
                              OpenGpus open, Progress& progress, SectionReport& report) {
  const std::span entries(section.entries, section.entry_count());
  Gpus gpus(std::move(open), options.end_gpus);
  PageEngineNeeds needs = needs_of(cloud, options, 1);
  gpus.resolve(needs);
  const PageBytes bytes{
      .on_device =
          [&](const SlotLayout& of) {
            return cuda_section_bytes(section) + of.slots * cuda_section_slot_bytes(cloud, of);
          },
      .on_host =
          [&](const SlotLayout& of) { return of.slots * cuda_section_pinned_bytes(cloud, of); },
      // The maps of a second GPU and of any further one are merged by way of the host.
      .kept = gpus.size() > 1 ? entries.size_bytes() : 0};
  const SlotLayout layout =
      layout_that_fits(cloud, cells, ignored.any(), bytes, memory_bytes, needs);
  const Stopwatch making;
  PageEngines engines = gpus.engines([&](int gpu) -> std::unique_ptr<PageEngine> {
    return std::make_unique<CudaSectionEngine>(gpu, section, cloud, layout);
  });
  const double engine_seconds = making.seconds();
  const std::vector<PageEngine*> lanes = lanes_of(engines);
  StageTimes times;
  run_pages(
      cloud, cells, paginate(cloud, cells, layout.page_bytes, layout.cells, ignored.any()), lanes,
      {.stage = "section", .masks = ignored.any() ? &ignored : nullptr, .threads = needs.threads},
      [](std::span<const PlannedCell>, const PageResult&) {}, progress, times);
  std::vector<std::uint32_t> of_device;
  std::uint64_t device_bytes = 0, host_bytes = bytes.kept + run_pages_bytes(cells.size());
  for (const PageEngine* lane : lanes) {
    const auto& engine = dynamic_cast<const CudaSectionEngine&>(*lane);
    device_bytes = std::max(device_bytes, engine.device_bytes());
    host_bytes += engine.pinned_bytes();
    if (lane == lanes.front()) {
      engine.read_entries(entries);
      continue;
    }
    of_device.resize(entries.size());
    engine.read_entries(of_device);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      entries[i] = std::min(entries[i], of_device[i]);
    }
  }
  // Nothing failed, so that the report is that of the GPUs.
  report.peak_device_bytes = device_bytes;
  report.needed_host_bytes += host_bytes;
  report.engine_seconds = engine_seconds;
  return gpus.end(std::move(engines));
}

}  // namespace clearway
