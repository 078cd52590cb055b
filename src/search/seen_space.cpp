#include "search/seen_space.hpp"

#include <tbb/blocked_range.h>
#include <tbb/spin_mutex.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/inside.hpp"
#include "core/messages/messages.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/ignored_points.hpp"
#include "core/seen/brick_cloud.hpp"
#include "core/seen/brick_map.hpp"
#include "core/seen/unseen_groups.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/files/input_error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "search/check_query.hpp"
#include "search/checks/question.hpp"
#include "search/visit.hpp"
#include "stream/answer_rows.hpp"
#include "stream/search_journal.hpp"

namespace clearway {
namespace {

constexpr double kUsualCube = 0.2;     // metres
constexpr double kLongestBeam = 1000;  // metres
constexpr std::int64_t kMostSide = std::int64_t{1} << 29;
constexpr std::int64_t kInsets = 4;  // a cube's side in insets, rounded down
constexpr const char* kBeamStage = "beams";
/// A part of the memory is for the bricks, and another for the swept cubes, while the rest
/// searches.
constexpr std::uint64_t kMemoryParts = 4;

/// The query whose points are the middles of cubes: classes say nothing of them.
Query query_of_cubes(const Query& query, double radius) {
  Query out = query;
  out.radius = radius;
  raise_floors(out, query.radius - radius);
  out.first_pose = true;
  out.seen = out.depth = false;
  out.clearance = out.profile = 0;
  out.ignore_classes.clear();
  return out;
}

[[noreturn]] void refuse_more(std::uint64_t needed, std::uint64_t allowed) {
  throw ResourceError(
      "the cubes that the model sweeps take more than " + format_size(allowed) + " of memory",
      Remedy::kMoreMemory, static_cast<double>(needed));
}

/// The cubes of a cloud that the model sweeps: its points that collide, with their first poses.
struct SweptCubes {
  /// most_bytes: bytes that the swept cubes may take beside the search. All outlive it.
  SweptCubes(const BrickCloud& bricks, const Query& query, std::uint64_t most_bytes)
      : cloud(bricks),
        numbers(query),
        fixed_bytes(AnswerRows::bytes(bricks, query)),
        storage([=, this](std::uint64_t bytes) {
          bytes += fixed_bytes;
          if (bytes > most_bytes) refuse_more(kMemoryParts * bytes, most_bytes);
        }),
        rows(bricks, query, storage) {}

  std::uint64_t count() const { return rows.points(PointQuestion::kHits); }
  std::uint64_t bytes() const { return fixed_bytes + storage.allocated_bytes(); }
  /// The cells of the bricks that have any, ascending.
  std::vector<std::uint32_t> cells() const { return rows.cells(PointQuestion::kHits); }

  /// Calls visit(cube, first pose) for each swept cube of a brick.
  template <typename Visit>
  void for_each(std::uint32_t cell, Visit visit) const {
    const CellRows hits = rows.read(cell, PointQuestion::kHits);
    hits.for_each([&](std::uint32_t point, std::size_t row) {
      visit(cloud.bricks()[cell].cube(point), numbers.pose_of(hits.poses[row]));
    });
  }

  const BrickCloud& cloud;
  const BodyNumbers numbers;
  const std::uint64_t fixed_bytes;
  RowsInMemory storage;
  AnswerRows rows;
};

/// How much of the swept cubes lies in each cell of the cross-sections.
SweptCells cross_sections_of(const SweptCubes& swept, const CubeLattice& lattice,
                             const Quantisation& quantisation, double side, const Query& query,
                             int threads, Progress& progress) {
  CrossSections all(side);
  tbb::spin_mutex mutex;
  const std::vector<std::uint32_t> cells = swept.cells();
  in_threads(threads, [&] {
    constexpr std::size_t kBricksAtOnce = 256;
    using Range = tbb::blocked_range<std::size_t>;
    for_each_parallel(Range(0, cells.size(), kBricksAtOnce), [&](const Range& part) {
      throw_if_stopped(progress);
      CrossSections some(side);
      for (std::size_t i = part.begin(); i < part.end(); ++i) {
        swept.for_each(cells[i], [&](const Cube& cube, std::uint32_t pose) {
          some.add(pulled_back(query.poses[pose], middle_of(lattice, quantisation, cube)));
        });
      }
      const tbb::spin_mutex::scoped_lock lock(mutex);
      all.add(some);
    });
  });
  return all.cells();
}

/// What is known of a cell's beams before they are followed.
struct BeamReach {
  bool enters = true;    ///< whether a beam may enter the bricks, or may have to be counted
  unsigned minbits = 0;  ///< bits in which the cell's origins are packed
};

/// Finds out which beams there are in a store.
class StoreBeams {
 public:
  StoreBeams(const StoreReader& store, const BrickMap& map)
      : store_(store), origins_(store.metadata().origins->quanta), map_(map.ref()) {
    const double most = kLongestBeam * metre_of(store);
    most_squared_ = most * most;
  }

  /// The cells, among those of `only`, whose beams are to be followed; sets beams.origin_minbits.
  std::vector<PlannedCell> cells(const ShardCells* only, Beams& beams, Progress& progress) const {
    std::vector<BeamReach> reach(store_.cells().size());
    for_each_parallel(reach.size(), [&](std::size_t cell) {
      const auto index = static_cast<std::uint32_t>(cell);
      throw_if_stopped(progress);
      reach[cell] = only == nullptr || only->contains(index) ? reach_of(index) : BeamReach{false};
    });
    std::vector<PlannedCell> cells;
    for (std::uint32_t cell = 0; cell < reach.size(); ++cell) {
      if (!reach[cell].enters) continue;
      cells.push_back({cell, {}});
      beams.origin_minbits = std::max(beams.origin_minbits, reach[cell].minbits);
    }
    return cells;
  }

  Beams beams(const BrickMap& map) const {
    return {.ref = {.map = map_,
                    .origins = origins_.front().data(),
                    .origin_count = static_cast<std::uint32_t>(origins_.size()),
                    .quantisation = store_.quantisation(),
                    .most_squared = most_squared_},
            .map = map,
            .origins_of = [this](std::uint32_t cell) { return store_.origins(cell); }};
  }

 private:
  /// Beams of a cell lie in the box around its points and their origins. Where that box holds no
  /// brick, and no beam in it is too long, the cell need not be looked at.
  BeamReach reach_of(std::uint32_t cell) const {
    constexpr std::uint64_t kFewOrigins = 64;
    const PackedChunk<std::uint32_t> of = store_.origins(cell);
    BeamReach reach{.minbits = of.minbits()};
    const std::uint64_t first = of.minimum(), span = std::uint64_t{1} << of.minbits();
    if (first == 0 || span > kFewOrigins) return reach;
    const QuantumBox& box = store_.cells()[cell].box;
    std::int64_t longest[3];
    bool apart = false;
    for (std::size_t k = 0; k < 3; ++k) {
      std::int64_t lo = box.lo[k], hi = box.hi[k];
      for (std::uint64_t o = first; o < first + span && o <= origins_.size(); ++o) {
        lo = std::min(lo, origins_[o - 1][k]);
        hi = std::max(hi, origins_[o - 1][k]);
      }
      longest[k] = hi > lo + Beam::kMostQuanta ? Beam::kMostQuanta : hi - lo;
      apart = apart || hi < map_.range.lo[k] * map_.brick_side[k] ||
              lo > (std::int64_t{map_.range.hi[k]} + 1) * map_.brick_side[k];
    }
    reach.enters = !apart || is_too_long(longest, store_.quantisation(), most_squared_);
    return reach;
  }

  const StoreReader& store_;
  const std::span<const std::array<std::int64_t, 3>> origins_;
  const BrickMapRef& map_;
  double most_squared_ = 0;
};

/// Follows the beams to the points of a cell.
BeamCounts follow_cell(const StoreReader& store, const Beams& beams, std::uint32_t cell) {
  const std::uint32_t count = store.cells()[cell].count;
  const auto coordinates = store.peek(cell);
  const PackedChunk<std::uint32_t> of = beams.origins_of(cell);
  constexpr std::uint32_t kAtOnce = 1024;
  std::array<std::array<std::int32_t, kAtOnce>, 3> q{};
  std::array<std::uint32_t, kAtOnce> origins{};
  BeamCounts counts;
  for (std::uint32_t first = 0; first < count; first += kAtOnce) {
    const std::uint32_t n = std::min(kAtOnce, count - first);
    for (std::size_t k = 0; k < 3; ++k) coordinates[k].decode(first, std::span(q[k]).first(n));
    of.decode(first, std::span(origins).first(n));
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::int32_t point[3] = {q[0][i], q[1][i], q[2][i]};
      beams.ref.follow(point, origins[i], counts);
    }
  }
  return counts;
}

BeamCounts follow_on_cpu(const StoreReader& store, const Beams& beams,
                         std::span<const PlannedCell> cells, int threads, Progress& progress) {
  std::uint64_t points = 0;
  for (const PlannedCell& cell : cells) points += store.cells()[cell.cell].count;
  progress.begin(kBeamStage, points, "points");
  std::atomic<std::uint64_t> without_origin = 0, too_long = 0;
  in_threads(threads, [&] {
    for_each_parallel(cells.size(), [&](std::size_t i) {
      throw_if_stopped(progress);
      const BeamCounts counts = follow_cell(store, beams, cells[i].cell);
      without_origin += counts.without_origin;
      too_long += counts.too_long;
      progress.advance(store.cells()[cells[i].cell].count);
    });
  });
  progress.end();
  return {without_origin, too_long};
}

BeamCounts follow_beams(const StoreReader& store, const SeenSearch& how, std::uint64_t memory_bytes,
                        BrickMap& map, Progress& progress) {
  const StoreBeams known(store, map);
  Beams beams = known.beams(map);
  std::vector<PlannedCell> cells;
  in_threads(how.threads, [&] { cells = known.cells(how.only, beams, progress); });
  if (how.follow_on_gpus && !cells.empty()) {
    if (const auto counts = how.follow_on_gpus(beams, cells, memory_bytes, map)) return *counts;
  }
  return follow_on_cpu(store, beams, cells, how.threads, progress);
}

/// A swept cube that no beam saw.
struct Unseen {
  Cube cube;
  std::uint32_t first_pose;
};

}  // namespace

double side_of_cubes(const StoreReader& store, double asked) {
  return asked > 0 ? asked : kUsualCube * metre_of(store);
}

CubeLattice cube_lattice(const StoreReader& store, double asked) {
  const double side = side_of_cubes(store, asked);
  CubeLattice lattice{};
  for (int k = 0; k < 3; ++k) {
    const double scale = store.quantisation().scale[k];
    const double quanta = side / scale;
    if (!(quanta < static_cast<double>(kMostSide))) {
      throw UsageError("cubes of seen space of " + format_digits(side, 9) +
                       ": expected sides below 2^29 times " + format_digits(scale, 9) +
                       ", the step of the stored coordinates");
    }
    lattice.side[k] = std::llround(quanta);
    lattice.inset[k] = lattice.side[k] / kInsets;
    if (lattice.inset[k] < 1) {
      throw UsageError("cubes of seen space of " + format_digits(side, 9) +
                       ": expected sides of at least " + format_digits(kInsets * scale, 9) +
                       ", four steps of the stored coordinates, so that a cube has an inner part");
    }
  }
  return lattice;
}

BeamCounts follow_all_beams(const StoreReader& store, int threads, BrickMap& map,
                            Progress& progress) {
  SeenSearch how;
  how.threads = threads;
  return follow_beams(store, how, 0, map, progress);
}

void check_seen_space(const StoreReader& store, const QueryParameters& query) {
  if (!store.has_origins()) {
    throw UsageError(
        store.name() +
            ": it does not know where its scanner stood, so that nothing is known of seen space; "
            "expected a store that was converted with origins",
        Remedy::kNone);
  }
  cube_lattice(store, query.seen_cube);
}

namespace {

/// The swept cubes as a map, in which following the beams clears those that were seen.
BrickMap map_of(const SweptCubes& swept, const CubeLattice& lattice) {
  std::vector<Brick> bricks;
  std::vector<std::uint64_t> words;
  for (const std::uint32_t cell : swept.cells()) {
    bricks.push_back(swept.cloud.bricks()[cell]);
    const CellRows hits = swept.rows.read(cell, PointQuestion::kHits);
    words.insert(words.end(), hits.words.begin(), hits.words.end());
    words.resize(bricks.size() * kBrickWords);
  }
  return BrickMap(lattice, std::move(bricks), std::move(words));
}

std::uint64_t count_of(const BrickMap& map) {
  std::uint64_t count = 0;
  for (const std::uint64_t word : map.words()) {
    count += static_cast<std::uint64_t>(std::popcount(word));
  }
  return count;
}

/// The cubes that are left in the map, in their order.
std::vector<Unseen> unseen_of(const BrickMap& map, const SweptCubes& swept, std::uint64_t count) {
  std::vector<Unseen> unseen;
  unseen.reserve(count);
  std::uint32_t brick = 0;
  for (const std::uint32_t cell : swept.cells()) {
    const std::span<const std::uint64_t> words = map.words(brick++);
    swept.for_each(cell, [&](const Cube& cube, std::uint32_t pose) {
      const std::uint32_t entry = entry_of(cube);
      if ((words[entry / 64] >> entry % 64 & 1) != 0) unseen.push_back({cube, pose});
    });
  }
  std::sort(unseen.begin(), unseen.end(),
            [](const Unseen& a, const Unseen& b) { return a.cube < b.cube; });
  return unseen;
}

/// The rows of the result, still without groups.
UnseenCubes rows_of(const std::vector<Unseen>& unseen, std::span<const Pose> poses) {
  const std::vector<double> chainage = chainage_of(poses);
  UnseenCubes rows;
  for (const Unseen& one : unseen) {
    rows.cube.push_back({one.cube.i[0], one.cube.i[1], one.cube.i[2]});
    rows.first_pose.push_back(one.first_pose);
    const std::size_t next = std::size_t{one.first_pose} + 1;
    rows.chainage.push_back(chainage[one.first_pose]);
    rows.step.push_back(next < chainage.size() ? chainage[next] - chainage[next - 1] : 0);
  }
  rows.group.resize(unseen.size());
  return rows;
}

}  // namespace

SeenSpace find_seen_space(const StoreReader& store, const Query& query, const SeenSearch& how,
                          Progress& progress) {
  check_seen_space(store, query);
  const CubeLattice lattice = cube_lattice(store, query.seen_cube);
  const Query cubes = query_of_cubes(query, how.radius);
  SeenSpace space;
  space.summary.cube = static_cast<double>(lattice.side[0]) * store.quantisation().scale[0];
  const std::uint64_t share = how.memory_bytes / kMemoryParts;
  const Stopwatch clock;
  const BrickCloud cloud(bricks_along(query, how.radius, lattice, store.quantisation(), share),
                         lattice, store.quantisation());
  if (cloud.bricks().empty()) return space;
  SweptCubes swept(cloud, cubes, share);
  ProfileSet no_profile;
  space.taken = run_visit(cloud,
                          {.query = cubes,
                           .memory_bytes = how.memory_bytes - share,
                           .kind = *how.kind(cloud, cubes),
                           .collect = keep_answer(cloud, swept.rows, no_profile, nullptr),
                           .stage = "swept space"},
                          progress);
  space.summary.swept = swept.count();
  space.swept = cross_sections_of(swept, lattice, store.quantisation(), space.summary.cube, query,
                                  how.threads, progress);
  space.sweep_seconds = clock.seconds();

  BrickMap map = map_of(swept, lattice);
  std::uint64_t bytes = cloud.allocated_bytes() + swept.bytes() +
                        space.swept.size() * kSweptRowBytes +
                        BrickMap::bytes_for(map.bricks().size());
  if (bytes > how.memory_bytes) refuse_more(bytes, how.memory_bytes);
  const Stopwatch following;
  space.left_out = follow_beams(store, how, how.memory_bytes - bytes, map, progress);
  space.beam_seconds = following.seconds();

  const std::uint64_t unseen = count_of(map);
  bytes += unseen * (sizeof(Unseen) + kUnseenRowBytes);
  if (bytes > how.memory_bytes) refuse_more(bytes, how.memory_bytes);
  space.unseen = rows_of(unseen_of(map, swept, unseen), query.poses);
  space.summary.unseen = unseen;
  space.summary.seen = space.summary.swept - unseen;
  return space;
}

void group_unseen(const QueryParameters& query, UnseenCubes& unseen, SeenSummary& summary) {
  std::vector<Cube> cubes;
  cubes.reserve(unseen.size());
  for (const auto& i : unseen.cube) cubes.push_back({{i[0], i[1], i[2]}});
  unseen.group = group_cubes(cubes, unseen.first_pose);
  summary.unseen = unseen.size();
  summary.seen = summary.swept - unseen.size();
  summary.groups = unseen.group.empty() ? 0 : *std::ranges::max_element(unseen.group);
  std::vector<std::uint64_t> size(summary.groups + 1);
  for (const std::uint32_t group : unseen.group) ++size[group];
  const auto is_listed = [&](std::uint32_t group) { return size[group] >= query.seen_min; };
  summary.listed_groups = summary.listed_cubes = 0;
  for (std::uint32_t group = 1; group <= summary.groups; ++group) {
    if (!is_listed(group)) continue;
    ++summary.listed_groups;
    summary.listed_cubes += size[group];
  }
  // The ways from the poses that first reach a cube of a listed group, from and to.
  std::map<std::uint32_t, std::pair<double, double>> ways;
  for (std::size_t i = 0; i < unseen.size(); ++i) {
    if (!is_listed(unseen.group[i])) continue;
    const double from = unseen.chainage[i];
    ways[unseen.first_pose[i]] = {from, from + unseen.step[i]};
  }
  summary.not_scanned_length = 0;
  std::optional<double> end;  // of the way before
  for (const auto& [pose, way] : ways) {
    const double from = end && way.first - *end < summary.cube ? *end : way.first;
    summary.not_scanned_length += std::max(0.0, way.second - from);
    end = std::max(end.value_or(way.second), way.second);
  }
  unseen.chainage.clear();
  unseen.step.clear();
}

void warn_of_large_cubes(const StoreReader& store, const QueryParameters& query, double radius,
                         MessageLog& log) {
  const CubeLattice lattice = cube_lattice(store, query.seen_cube);
  double side = 0;
  for (int k = 0; k < 3; ++k) {
    side = std::max(side, static_cast<double>(lattice.side[k]) * store.quantisation().scale[k]);
  }
  constexpr double kRounding = 1e-6;
  if (!(side > 2 * radius * (1 + kRounding))) return;
  const LengthUnit unit = store.metadata().unit;
  log.warn("large-cubes",
           "cubes of " + length_text(side, unit) + " are larger than twice the distance of " +
               length_text(radius, unit) +
               " at which the middle of a cube counts as swept, so that thin parts of the vehicle "
               "can pass between the middles, and nothing is said of the space around them. Take "
               "cubes of " +
               length_text(2 * radius, unit) + " or less",
           {{"cube", side}, {"distance", radius}});
}

namespace {
constexpr WarningCode kNothingSwept = "nothing-swept";
constexpr WarningCode kWithoutOrigin = "beams-without-origin";
constexpr WarningCode kLongBeams = "long-beams";
}  // namespace

void warn_of_nothing_swept(const SeenSummary& found, std::uint64_t poses, MessageLog& log) {
  if (found.swept > 0 || poses == 0) return;
  log.warn(
      kNothingSwept,
      "the vehicle sweeps the middle of no cube, so that nothing is known of what was scanned. "
      "Smaller cubes show more");
}

void warn_of_beams(const BeamCounts& left_out, MessageLog& log) {
  if (left_out.without_origin > 0) {
    log.warn(kWithoutOrigin,
             format_count(left_out.without_origin) +
                 " points do not say where their scanner stood, so that their beams show nothing",
             {{"points", static_cast<double>(left_out.without_origin)}});
  }
  if (left_out.too_long > 0) {
    log.warn(kLongBeams,
             format_count(left_out.too_long) +
                 " beams are longer than 1 km, or than 2^30 steps of the stored coordinates, and "
                 "are left out. Are the origins those of these scans?",
             {{"beams", static_cast<double>(left_out.too_long)}});
  }
}

bool takes_warning_of_beams(const Message& warning, BeamCounts& left_out) {
  const auto count = [&] {
    return warning.numbers.empty() ? 0 : static_cast<std::uint64_t>(warning.numbers[0].second);
  };
  if (warning.code == kWithoutOrigin) {
    left_out.without_origin += count();
  } else if (warning.code == kLongBeams) {
    left_out.too_long += count();
  }
  return warning.code == kWithoutOrigin || warning.code == kLongBeams ||
         warning.code == kNothingSwept;
}

void warn_of_small_groups(const SeenSummary& found, const QueryParameters& query, MessageLog& log) {
  const std::uint64_t small = found.groups - found.listed_groups;
  if (small > 0) {
    const std::uint64_t cubes = found.unseen - found.listed_cubes;
    log.warn("small-unseen",
             format_count(small) + (small == 1 ? " group" : " groups") + " of fewer than " +
                 std::to_string(query.seen_min) + " cubes, " + format_count(cubes) +
                 " cubes in all, were passed through by no beam; something small can be there",
             {{"groups", static_cast<double>(small)}, {"cubes", static_cast<double>(cubes)}});
  }
}

}  // namespace clearway
