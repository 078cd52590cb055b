#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "clearway/query.hpp"
#include "clearway/seen.hpp"
#include "core/messages/messages.hpp"
#include "core/query/search_result.hpp"
#include "core/seen/beams.hpp"
#include "core/seen/brick_map.hpp"
#include "core/seen/cross_sections.hpp"
#include "core/seen/cubes.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"
#include "search/visit.hpp"

namespace clearway {

/// The space that a query sweeps, as far as it is known.
struct SeenSpace {
  UnseenCubes unseen;
  SweptCells swept;  ///< how much of the swept cubes lies in each cell of the cross-sections
  SeenSummary summary;
  BeamCounts left_out;  ///< beams that were not followed
  SearchReport taken;   ///< what the search for swept cubes took
  double sweep_seconds = 0, beam_seconds = 0;
};

/// The side of the cubes that was asked for, or the usual one; in the environment's unit.
double side_of_cubes(const StoreReader& store, double asked);

/// The cubes in which seen space is judged in a store. asked: side of a cube in the environment's
/// unit; 0: 0.2 m. Throws UsageError where it is too small or too large for the store's integers.
CubeLattice cube_lattice(const StoreReader& store, double asked);

/// Throws UsageError where the store cannot have seen space: where it does not know where its
/// scanner stood, or the cubes do not suit its integers.
void check_seen_space(const StoreReader& store, const QueryParameters& query);

/// Bytes of a row of UnseenCubes.
inline constexpr std::uint64_t kUnseenRowBytes = 5 * sizeof(std::uint32_t) + 2 * sizeof(double);

/// Bytes of a row of SweptCells.
inline constexpr std::uint64_t kSweptRowBytes = 3 * sizeof(std::uint32_t) + sizeof(std::uint64_t);

/// How a search for seen space is done.
struct SeenSearch {
  /// Distance from the model at which a cube's middle counts as swept, metres.
  double radius = 0;
  std::uint64_t memory_bytes = 0;  ///< bytes that the search may take
  int threads = 0;
  /// The cells whose beams are followed; null for all.
  const ShardCells* only = nullptr;
  /// Makes the engine that searches a cloud for a query, both of which outlive it.
  std::function<std::unique_ptr<PageEngineKind>(const PackedCloud&, const Query&)> kind;
  /// Follows beams to the points of cells on GPUs, with up to so many bytes of memory, and clears
  /// bits of the map; returns nothing where the CPU has to do it. Empty where it always has to.
  std::function<std::optional<BeamCounts>(const Beams&, std::span<const PlannedCell>,
                                          std::uint64_t memory_bytes, BrickMap&)>
      follow_on_gpus;
};

/// Finds which cubes the query sweeps, by searching their middles, and which of these no beam of
/// the store passed through. Groups are not made. Throws as check_seen_space() does, InputError
/// where a cube is beyond 32-bit integers or a cell is damaged,
/// ResourceError where memory is too little, Interrupted.
SeenSpace find_seen_space(const StoreReader& store, const Query& query, const SeenSearch& how,
                          Progress& progress);

/// Follows all beams of a store on the CPU, and clears the bits of the cubes that they see. The
/// store has origins. Throws InputError for a damaged cell, Interrupted.
BeamCounts follow_all_beams(const StoreReader& store, int threads, BrickMap& map,
                            Progress& progress);

/// Numbers the groups of the unseen cubes, completes the summary, and removes chainage and
/// steps, which only parts keep. The summary knows the number of swept cubes.
void group_unseen(const QueryParameters& query, UnseenCubes& unseen, SeenSummary& summary);

/// Warns of cubes so large that parts of the model can lie between their middles, and sweep none:
/// "large-cubes". radius: the distance at which a middle counts as swept. Throws as
/// check_seen_space() does.
void warn_of_large_cubes(const StoreReader& store, const QueryParameters& query, double radius,
                         MessageLog& log);

/// Warns where no cube is swept, so that the search says nothing of what was scanned:
/// "nothing-swept". poses: the number of poses of the query.
void warn_of_nothing_swept(const SeenSummary& found, std::uint64_t poses, MessageLog& log);

/// Warns of points whose beams were left out: "beams-without-origin", "long-beams".
void warn_of_beams(const BeamCounts& left_out, MessageLog& log);

/// Whether a warning was given by warn_of_beams() or warn_of_nothing_swept(). Where it counts
/// beams, the count is added to `left_out`. Each part follows beams of its own, so a merge adds
/// them up.
bool takes_warning_of_beams(const Message& warning, BeamCounts& left_out);

/// Warns of groups of unseen cubes that are too small to be listed: "small-unseen".
void warn_of_small_groups(const SeenSummary& found, const QueryParameters& query, MessageLog& log);

}  // namespace clearway
