#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/messages/messages.hpp"
#include "core/seen/beams.hpp"
#include "core/seen/brick_map.hpp"
#include "core/util/progress.hpp"
#include "search/devices.hpp"
#include "search/kinds/visit_kind.hpp"
#include "search/session_state.hpp"

namespace clearway {

/// The devices of one question and the engines on them. The GPUs are opened when an engine first
/// needs them; their start was begun earlier, in the background.
class SearchEngines {
 public:
  /// model_hashes: hash_of_model() of the query's model, or of each body's. options: of the
  /// question, which the search may resolve further. report: gets the estimate by which the device
  /// is chosen, the GPUs' names and the seconds of waiting for them. All references outlive it.
  SearchEngines(SessionState& session, const Query& query,
                const std::vector<std::uint64_t>& model_hashes, SearchOptions& options,
                SearchReport& report, const MessageLog& log)
      : session_(session),
        query_(query),
        model_hashes_(model_hashes),
        options_(options),
        report_(report),
        log_(log),
        device_memory_(session.device_memory()) {}

  /// The device to begin with: a GPU where the user asks for one or it is faster by estimate, and
  /// the options allow one. Starts it if that has not been done.
  Device choose_device();

  /// Does the work on the device. Where that is a GPU that the user did not ask for, and it cannot
  /// do the work, notes why, does it on the CPU, and reports the CPU as the device from then on.
  /// failed: called before that with the GPU's error, and may throw it again.
  template <typename Work>
  auto on(
      Device device, const Work& work,
      const std::function<void(const ResourceError&)>& failed = [](const ResourceError&) {}) {
    if (device == Device::kCuda) {
      try {
        return work(Device::kCuda);
      } catch (const NoGpu&) {
      } catch (const ResourceError& error) {
        if (!fallback_allowed(options_)) throw;
        failed(error);
        note_failure(error);
      }
      take_cpu();
    }
    return work(Device::kCpu);
  }

  /// Makes the engine kind of a visit for a device. cloud, queries and options outlive the kind.
  /// For use in on().
  std::unique_ptr<PageEngineKind> kind(Device device, const PackedCloud& cloud,
                                       std::vector<VisitQuestion> questions,
                                       const SearchOptions& options);

  /// Takes memory of each GPU in use, which the questions of a session share. Does nothing on the
  /// CPU.
  void take_device_memory(std::uint64_t bytes, const Progress& progress);

  /// Follows the beams to the points of cells on the GPUs, and clears bits of the map. Nothing
  /// where the CPU has to do it.
  std::optional<BeamCounts> follow_beams(std::span<const PlannedCell> cells, const Beams& beams,
                                         BrickMap& map, std::uint64_t memory_bytes,
                                         Progress& progress);

 private:
  /// Thrown when no GPU is available; the reason has already been reported.
  struct NoGpu {};

  bool gpu_pays();
  DeviceChoice open_gpus();
  void note_failure(const ResourceError& of_gpu) const;
  /// Reports the CPU as the device of what follows.
  void take_cpu();

  SessionState& session_;
  const Query& query_;
  const std::vector<std::uint64_t>& model_hashes_;
  SearchOptions& options_;
  SearchReport& report_;
  const MessageLog& log_;
  SharedMemory::Share device_memory_;
  std::optional<DeviceChoice> gpus_;  ///< set once they are open
};

}  // namespace clearway
