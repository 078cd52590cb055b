#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "clearway/section.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/messages/messages.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "core/section/section_ref.hpp"
#include "core/util/progress.hpp"
#include "search/devices.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

/// Blocks the cells of a section, on the CPU, by all points of a cloud that are not ignored. Throws
/// InputError for a damaged cell, Interrupted.
void block_cells(const PackedCloud& cloud, const IgnoredPoints& ignored, const SectionRef& section,
                 int threads, Progress& progress);

/// The cells of a cloud with points that may block something, each with its bins_in_reach(). Looks
/// at boxes only.
std::vector<PlannedCell> plan_section(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                      const SectionRef& section, int threads, Progress& progress);

/// The device on which the cells of a section are blocked: a GPU where the options ask for one, or
/// where they leave the choice and a GPU pays.
class SectionDevice {
 public:
  /// Begins to start the GPUs that the options ask for. Throws ResourceError where CUDA is asked
  /// for and missing. All references outlive this object.
  SectionDevice(const Store& store, const SectionOptions& options, MessageLog& log);

  /// Does what block_cells() does, and notes in `report` where, and what it took. memory_bytes:
  /// bytes of memory on the host that may be taken. Throws as block_cells() does, and ResourceError
  /// where a GPU that is asked for cannot be used.
  void block(const PackedCloud& cloud, const IgnoredPoints& ignored, const SectionRef& section,
             std::uint64_t memory_bytes, Progress& progress, SectionReport& report);

 private:
  bool gpu_pays(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                SectionReport& report);
  void block_on_gpus(const PackedCloud& cloud, const IgnoredPoints& ignored,
                     const SectionRef& section, std::span<const PlannedCell> cells,
                     std::uint64_t memory_bytes, Progress& progress, SectionReport& report);

  SearchOptions options_;  ///< those of the device
  MessageLog& log_;
  bool may_be_gpu_;
  EngineEnd ending_;  ///< of the engines, beside what comes after the search
};

}  // namespace clearway
