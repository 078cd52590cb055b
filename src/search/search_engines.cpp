#include "search/search_engines.hpp"

#include <algorithm>
#include <string>

#include "core/util/format.hpp"
#include "search/device_estimate.hpp"
#include "search/kinds/cpu_kind.hpp"
#include "search/kinds/cuda_kind.hpp"

namespace clearway {
namespace {

/// The least number of poses for which a session of its own accord asks a GPU, because the CPU has
/// answered for fewer poses before a GPU has started.
[[maybe_unused]] constexpr std::size_t kPosesForGpu = 256;

}  // namespace

Device SearchEngines::choose_device() {
  if (!gpu_pays() || !may_take_gpus(options_)) return Device::kCpu;
  if (!options_.started) options_.started = session_.start_surely(options_);
  return Device::kCuda;
}

/// Whether a GPU pays, by estimate. Always true where the user asked for a device, or for engine
/// grid or kdtree.
bool SearchEngines::gpu_pays() {
#ifdef CLEARWAY_CUDA
  if (!fallback_allowed(options_) || options_.engine != Engine::kSweep) return true;
  if (session_.is_session() && query_.poses.size() < kPosesForGpu) return false;
  report_.estimate = estimate_devices(workloads_of(session_.store().reader(), query_), query_,
                                      options_.threads, session_.has_gpus());
  const auto [cpu, cuda] = *report_.estimate;
  if (cpu > cuda) return true;
  log_.note("the CPU is taken: by estimate it needs " + format_brief(cpu) +
            " s, a GPU with its start " + format_brief(cuda) + " s");
  return false;
#else
  return true;  // a device that is asked for but missing is refused later
#endif
}

std::unique_ptr<PageEngineKind> SearchEngines::kind([[maybe_unused]] Device device,
                                                    const PackedCloud& cloud,
                                                    std::vector<VisitQuestion> questions,
                                                    const SearchOptions& options) {
  const MakeKind make = [&](const Query& query) -> std::unique_ptr<PageEngineKind> {
#ifdef CLEARWAY_CUDA
    if (device == Device::kCuda) {
      const OpenGpus open = [this] { return open_gpus(); };
      KeptOnGpus* const kept = session_.is_session() ? &session_.kept_on_gpus() : nullptr;
      return cuda_kind(cloud, query, options, open, kept);
    }
#endif
    return cpu_kind(cloud, query, options);
  };
  std::unique_ptr<PageEngineKind> kind = visit_kind(cloud, std::move(questions), make);
  kind->keep_models_in(session_.models(), model_hashes_);
  return kind;
}

/// Throws NoGpu where none can be used.
DeviceChoice SearchEngines::open_gpus() {
  if (!gpus_) {
    double& waited = report_.seconds.context_wait;
    gpus_ = session_.gpus(options_, log_, waited);
    report_.seconds.context = waited > 0 ? std::max(options_.started->seconds(), waited) : 0;
  }
  if (!gpus_->is_cuda()) throw NoGpu();
  report_.device_name = gpus_->name;
  return *gpus_;
}

void SearchEngines::note_failure(const ResourceError& of_gpu) const {
  log_.note(std::string("the CPU is taken: ") + of_gpu.what());
}

void SearchEngines::take_cpu() {
  report_.device = Device::kCpu;
  report_.device_name = DeviceChoice().name;
}

void SearchEngines::take_device_memory(std::uint64_t bytes, const Progress& progress) {
  if (!session_.is_session() || !gpus_ || !gpus_->is_cuda()) return;
  session_.device_memory().set_bytes(session_.kept_on_gpus().left_of(gpus_->memory_bytes));
  device_memory_.take(bytes, progress);
}

std::optional<BeamCounts> SearchEngines::follow_beams(
    [[maybe_unused]] std::span<const PlannedCell> cells, [[maybe_unused]] const Beams& beams,
    [[maybe_unused]] BrickMap& map, [[maybe_unused]] std::uint64_t memory_bytes,
    [[maybe_unused]] Progress& progress) {
#ifdef CLEARWAY_CUDA
  try {
    return follow_beams_on_gpus(
        session_.store().reader(), cells, beams, map, memory_bytes, options_,
        [this] { return open_gpus(); }, progress, report_);
  } catch (const NoGpu&) {
  } catch (const ResourceError& error) {
    if (!fallback_allowed(options_)) throw;
    note_failure(error);
  }
  take_cpu();
#endif
  return std::nullopt;
}

}  // namespace clearway
