#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "clearway/query.hpp"
#include "clearway/seen.hpp"
#include "core/query/search_result.hpp"
#include "core/seen/cubes.hpp"
#include "core/util/messages.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"

namespace clearway {

/// Beams of a search for seen space, by what became of them.
struct BeamCounts {
  std::uint64_t beams = 0;           ///< beams that were followed
  std::uint64_t without_origin = 0;  ///< points whose scanner's place is not known
  std::uint64_t too_long = 0;        ///< beams of 2^30 steps or more on an axis, or over 1 km
};

/// The space that a query sweeps, as far as it is known.
struct SeenSpace {
  UnseenCubes unseen;
  SeenSummary summary;
  BeamCounts beams;
  double swept_seconds = 0, beams_seconds = 0;  ///< wall clock of the two steps
};

/// The cubes in which seen space is judged in a store. asked: side of a cube in the environment's
/// unit; 0: 0.2 m. Throws UsageError where it is too small or too large for the store's integers.
CubeLattice cube_lattice(const StoreReader& store, double asked);

/// Throws UsageError where the store cannot tell seen space: where it does not know where its
/// scanner stood, or the cubes do not suit its integers.
void check_seen_space(const StoreReader& store, const QueryParameters& query);

/// How a search for seen space is done.
struct SeenSearch {
  /// Distance from the model at which a cube's middle counts as swept, metres.
  double radius = 0;
  std::uint64_t memory_bytes = 0;
  int threads = 0;
  /// The cells whose beams are followed; null for all.
  const ShardCells* only = nullptr;
  /// Makes the engine that searches a cloud for a query, both of which outlive it.
  std::function<std::unique_ptr<PageEngineKind>(const PackedCloud&, const Query&)> kind;
};

/// Finds which cubes the query sweeps, by searching their middles, and which of these no beam of
/// the store passed through. Groups are not made. Throws as check_seen_space() does, InputError
/// where a cube is beyond 32-bit integers or a cell is damaged,
/// ResourceError where memory is too little, Interrupted.
SeenSpace find_seen_space(const StoreReader& store, const Query& query, const SeenSearch& how,
                          Progress& progress);

/// Numbers the groups of the unseen cubes, completes the summary, and removes the steps, which only
/// parts keep. The summary knows the number of swept cubes.
void group_unseen(const QueryParameters& query, UnseenCubes& unseen, SeenSummary& summary);

/// Warns of points whose beams were left out: "beams-without-origin", "long-beams".
void warn_of_beams(const BeamCounts& beams, MessageLog& log);

/// Warns of groups of unseen cubes that are too small to be listed: "small-unseen".
void warn_of_small_groups(const SeenSummary& found, const QueryParameters& query, MessageLog& log);

}  // namespace clearway
