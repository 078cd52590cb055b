#pragma once

#include <functional>
#include <memory>
#include <span>

#include "clearway/section.hpp"
#include "core/query/ignored_points.hpp"
#include "core/section/section_ref.hpp"
#include "core/seen/beams.hpp"
#include "core/util/progress.hpp"
#include "search/devices.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

class KeptOnGpus;
class PackedCloud;

/// Waits for GPUs to start, and chooses as many as the options name, or one.
using OpenGpus = std::function<DeviceChoice()>;

/// The CUDA form of the engine that options choose, with one engine on each of the GPUs that `open`
/// gives once there is a plan. kept: what stays on the GPUs for questions to come; null where
/// nothing does. settings: those of an experiment. Only in a build with CUDA. options.threads is
/// not 0; all references outlive it.
std::unique_ptr<PageEngineKind> cuda_kind(const PackedCloud& cloud, const Query& query,
                                          const SearchOptions& options, OpenGpus open,
                                          KeptOnGpus* kept = nullptr,
                                          const EngineSettings& settings = {});

/// Follows the beams to the points of these cells on the GPUs that `open` gives, page by page, and
/// clears the bits of the cubes in `map` that they see. memory_bytes: bytes that this may take on
/// the host. Notes in `report` what it takes on the GPUs. Only in a build with CUDA. Throws
/// ResourceError, and then has changed nothing, and Interrupted.
BeamCounts follow_beams_on_gpus(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                const Beams& beams, BrickMap& map, std::uint64_t memory_bytes,
                                const SearchOptions& options, OpenGpus open, Progress& progress,
                                SearchReport& report);

/// Blocks the cells of a section by the points of these cells, whose nodes are those of
/// bins_in_reach(), on the GPUs that `open` gives, page by page, and writes the entries of its
/// maps. memory_bytes: bytes that this may take on the host. options.threads is not 0. Tells
/// `report` what this took, unless it fails. Only in a build with CUDA. Throws ResourceError and
/// Interrupted; the entries may then be those that some of the points make.
EngineEnd block_cells_on_gpus(const PackedCloud& cloud, const IgnoredPoints& ignored,
                              std::span<const PlannedCell> cells, const SectionRef& section,
                              std::uint64_t memory_bytes, const SearchOptions& options,
                              OpenGpus open, Progress& progress, SectionReport& report);

}  // namespace clearway
