#include "search/block_cells.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "cpu/section_search.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "search/device_estimate.hpp"
#include "search/kinds/cuda_kind.hpp"

namespace clearway {
namespace {

/// The bins that points of a cell may block; none where all its points are ignored.
std::vector<std::uint32_t> bins_of_cell(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                        const SectionRef& section, std::uint32_t cell) {
  if (ignored.any() && ignored.skips(cell)) return {};
  return bins_in_reach(section, position_box(cloud.quantisation(), cloud.cells()[cell].box));
}

}  // namespace

void block_cells(const PackedCloud& cloud, const IgnoredPoints& ignored, const SectionRef& section,
                 int threads, Progress& progress) {
  constexpr std::uint32_t kBlocksAtOnce = 32;
  const SectionSearch search(cloud, section);
  progress.begin("section", cloud.point_count(), "points");
  in_threads(threads, [&] {
    for_each_parallel(cloud.cells().size(), [&](std::size_t i) {
      throw_if_stopped(progress);
      const auto cell = static_cast<std::uint32_t>(i);
      const std::uint32_t count = cloud.cells()[cell].count;
      const std::vector<std::uint32_t> bins = bins_of_cell(cloud, ignored, section, cell);
      if (!bins.empty()) {
        const auto coordinates = cloud.coordinates(cell);
        std::vector<std::uint64_t> searched;
        if (ignored.any() && ignored.touches(cell)) {
          searched.resize(cloud.blocks_per_cell());
          ignored.mask(cell, searched, [&] { return coordinates; });
        }
        const auto blocks = static_cast<std::uint32_t>(divide_up(count, kBlockPoints));
        const auto parts = static_cast<std::uint32_t>(divide_up(blocks, kBlocksAtOnce));
        for_each_parallel(parts, [&](std::uint32_t part) {
          throw_if_stopped(progress);
          const std::uint32_t first = part * kBlocksAtOnce;
          search.search(cell, coordinates, searched, bins, first,
                        std::min(first + kBlocksAtOnce, blocks));
        });
      }
      progress.advance(count);
    });
  });
  progress.end();
}

std::vector<PlannedCell> plan_section(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                      const SectionRef& section, int threads, Progress& progress) {
  std::vector<PlannedCell> cells(cloud.cells().size());
  in_threads(threads, [&] {
    for_each_parallel(cells.size(), [&](std::size_t i) {
      throw_if_stopped(progress);
      const auto cell = static_cast<std::uint32_t>(i);
      cells[i] = {cell, bins_of_cell(cloud, ignored, section, cell)};
    });
  });
  std::erase_if(cells, [](const PlannedCell& cell) { return cell.nodes.empty(); });
  return cells;
}

SectionDevice::SectionDevice(const Store& store, const SectionOptions& options, MessageLog& log)
    : log_(log) {
  options_.engine = Engine::kSweep;  // which GPUs have
  options_.device = options.device;
  options_.gpus = options.gpus;
  options_.threads = threads_or_all(options.threads);
  options_.device_memory_bytes = options.device_memory_bytes;
  may_be_gpu_ = may_take_gpus(options_);
  const bool surely =
      !fallback_allowed(options_) || store.point_count() >= surely_many_points(options_.threads);
  if (may_be_gpu_ && surely) {
    options_.started = std::make_shared<DeviceStart>(options_, CudaKernels::kSection);
  }
}

void SectionDevice::block(const PackedCloud& cloud, const IgnoredPoints& ignored,
                          const SectionRef& section, std::uint64_t memory_bytes, Progress& progress,
                          SectionReport& report) {
  if (may_be_gpu_) {
    const std::vector<PlannedCell> cells =
        plan_section(cloud, ignored, section, options_.threads, progress);
    if (gpu_pays(cloud, cells, report)) {
      try {
        return block_on_gpus(cloud, ignored, section, cells, memory_bytes, progress, report);
      } catch (const ResourceError& error) {
        if (!fallback_allowed(options_)) throw;
        log_.note(std::string("the CPU is taken: ") + error.what());
      }
    }
  }
  block_cells(cloud, ignored, section, options_.threads, progress);
}

bool SectionDevice::gpu_pays(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                             SectionReport& report) {
  if (!fallback_allowed(options_)) return true;
  double pairs = 0;
  for (const PlannedCell& cell : cells) {
    pairs += static_cast<double>(cloud.cells()[cell.cell].count) *
             static_cast<double>(cell.nodes.size());
  }
  report.estimate = estimate_section(pairs, options_.threads);
  const auto [cpu, cuda] = *report.estimate;
  if (cpu > cuda) return true;
  log_.note("the CPU is taken: by estimate it needs " + format_brief(cpu) +
            " s, a GPU with its start " + format_brief(cuda) + " s");
  return false;
}

#ifdef CLEARWAY_CUDA

void SectionDevice::block_on_gpus(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                  const SectionRef& section, std::span<const PlannedCell> cells,
                                  std::uint64_t memory_bytes, Progress& progress,
                                  SectionReport& report) {
  if (!options_.started) {
    options_.started = std::make_shared<DeviceStart>(options_, CudaKernels::kSection);
  }
  std::string name;
  const auto open = [&] {
    const Stopwatch waiting;
    options_.started->wait();
    DeviceChoice choice = choose_device(options_, log_);
    if (!choice.is_cuda()) throw ResourceError("no GPU has room", Remedy::kCpuDevice);
    name = choice.name;
    report.context_wait_seconds = waiting.seconds();
    return choice;
  };
  ending_ = block_cells_on_gpus(cloud, ignored, cells, section, memory_bytes, options_, open,
                                progress, report);
  report.device = Device::kCuda;
  report.device_name = name;
}

#else

void SectionDevice::block_on_gpus(const PackedCloud&, const IgnoredPoints&, const SectionRef&,
                                  std::span<const PlannedCell>, std::uint64_t, Progress&,
                                  SectionReport&) {}

#endif

}  // namespace clearway
