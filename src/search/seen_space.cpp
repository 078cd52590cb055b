#include "search/seen_space.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/ignored_points.hpp"
#include "core/seen/brick_cloud.hpp"
#include "core/seen/brick_map.hpp"
#include "core/seen/unseen_groups.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/tsan_annotations.hpp"
#include "search/check_query.hpp"
#include "search/page_search.hpp"
#include "search/threads.hpp"

namespace clearway {
namespace {

constexpr double kUsualCube = 0.2;     // metres
constexpr double kLongestBeam = 1000;  // metres
constexpr std::int64_t kMostSide = std::int64_t{1} << 29;
constexpr std::int64_t kInsets = 4;  // a cube's side in insets, rounded down

/// The query whose points are the middles of cubes: classes say nothing of them.
Query query_of_cubes(const Query& query, double radius) {
  Query out = query;
  out.radius = radius;
  out.first_pose = true;
  out.seen = false;
  out.clearance = out.profile = out.tolerance = 0;
  out.ignore_classes.clear();
  return out;
}

/// The swept cubes of a brick.
struct SweptBrick {
  std::array<std::uint64_t, kBrickWords> words{};
  std::vector<std::uint32_t>
      first_poses;  ///< those of the swept cubes, in the order of their numbers

  std::uint64_t count() const { return first_poses.size(); }
};

/// Searches the middles of a cloud's cubes. Returns the swept cubes of each brick.
std::vector<SweptBrick> sweep(const BrickCloud& cloud, const Query& query,
                              std::uint64_t memory_bytes, PageEngineKind& kind,
                              Progress& progress) {
  const BodyNumbers numbers(query);
  std::vector<SweptBrick> swept(cloud.bricks().size());
  const CollectPage collect = [&](std::span<const PlannedCell> cells, const PageResult& found) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto hits = part_of_cell(found.hits, i, cloud.blocks_per_cell());
      const auto poses = part_of_cell(found.first_poses, i, cloud.cell_entries());
      SweptBrick& brick = swept[cells[i].cell];
      for (std::size_t word = 0; word < hits.size(); ++word) {
        brick.words[word] = hits[word];
        for (std::uint64_t open = hits[word]; open != 0; open &= open - 1) {
          const auto bit = static_cast<std::size_t>(std::countr_zero(open));
          brick.first_poses.push_back(numbers.pose_of(poses[64 * word + bit]));
        }
      }
    }
  };
  collect_pages(cloud, query, memory_bytes, kind, nullptr, IgnoredPoints::Search::kOthers,
                "swept space", collect, progress);
  return swept;
}

/// Follows the beams of a store.
class Beams {
 public:
  Beams(const StoreReader& store, BrickMap& map)
      : store_(store), origins_(store.metadata().origins->quanta), map_(map) {
    const double most = kLongestBeam * metre_of(store);
    most_squared_ = most * most;
  }

  void follow_cell(std::uint32_t cell) {
    const std::uint32_t count = store_.cells()[cell].count;
    const auto coordinates = store_.peek(cell);
    const PackedChunk<std::uint32_t> of = store_.origins(cell);
    constexpr std::uint32_t kAtOnce = 1024;
    std::array<std::array<std::int32_t, kAtOnce>, 3> q{};
    BeamCounts counts;
    for (std::uint32_t first = 0; first < count; first += kAtOnce) {
      const std::uint32_t n = std::min(kAtOnce, count - first);
      for (std::size_t k = 0; k < 3; ++k) coordinates[k].decode(first, std::span(q[k]).first(n));
      for (std::uint32_t i = 0; i < n; ++i) {
        follow({q[0][i], q[1][i], q[2][i]}, of[first + i], counts);
      }
    }
    beams_ += counts.beams;
    without_origin_ += counts.without_origin;
    too_long_ += counts.too_long;
  }

  BeamCounts counts() const { return {beams_, without_origin_, too_long_}; }

 private:
  void follow(const std::array<std::int32_t, 3>& q, std::uint32_t origin, BeamCounts& counts) {
    if (origin == 0) {
      ++counts.without_origin;
      return;
    }
    Beam beam{};
    bool any = false;
    double squared = 0;
    bool is_short = true;
    for (std::size_t k = 0; k < 3; ++k) {
      beam.origin[k] = origins_[origin - 1][k];
      const std::int64_t way = q[k] - beam.origin[k];
      is_short = is_short && way > -Beam::kMostQuanta && way < Beam::kMostQuanta;
      beam.way[k] = way;
      any = any || way != 0;
      const double length = static_cast<double>(way) * store_.quantisation().scale[k];
      squared += length * length;
    }
    if (!any) return;
    if (!is_short || squared > most_squared_) {
      ++counts.too_long;
      return;
    }
    ++counts.beams;
    map_.see(beam);
  }

  const StoreReader& store_;
  std::span<const std::array<std::int64_t, 3>> origins_;
  BrickMap& map_;
  double most_squared_ = 0;
  std::atomic<std::uint64_t> beams_ = 0, without_origin_ = 0, too_long_ = 0;
};

void follow_beams(const StoreReader& store, const SeenSearch& how, BrickMap& map,
                  BeamCounts& counts, Progress& progress) {
  Beams beams(store, map);
  progress.begin("beams", store.point_count(), "points");
  in_threads(how.threads, [&] {
    const ParallelScope scope;
    const auto follow = piece_of(scope, [&](std::size_t cell) {
      const auto index = static_cast<std::uint32_t>(cell);
      throw_if_stopped(progress);
      if (how.only == nullptr || how.only->contains(index)) beams.follow_cell(index);
      progress.advance(store.cells()[index].count);
    });
    scope.begin();
    tbb::parallel_for(std::size_t{0}, store.cells().size(), follow);
  });
  progress.end();
  counts = beams.counts();
}

/// A swept cube that no beam saw.
struct Unseen {
  Cube cube;
  std::uint32_t first_pose;
};

}  // namespace

CubeLattice cube_lattice(const StoreReader& store, double asked) {
  const double side = asked > 0 ? asked : kUsualCube * metre_of(store);
  CubeLattice lattice{};
  for (int k = 0; k < 3; ++k) {
    const double scale = store.quantisation().scale[k];
    const double quanta = side / scale;
    if (!(quanta < static_cast<double>(kMostSide))) {
      throw UsageError("cubes of seen space of " + brief(side) +
                       ": expected sides below 2^29 times " + brief(scale) +
                       ", the step of the stored coordinates");
    }
    lattice.side[k] = std::llround(quanta);
    lattice.inset[k] = lattice.side[k] / kInsets;
    if (lattice.inset[k] < 1) {
      throw UsageError("cubes of seen space of " + brief(side) + ": expected sides of at least " +
                       brief(kInsets * scale) +
                       ", four steps of the stored coordinates, so that a cube has an inner part");
    }
  }
  return lattice;
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

SeenSpace find_seen_space(const StoreReader& store, const Query& query, const SeenSearch& how,
                          Progress& progress) {
  check_seen_space(store, query);
  const CubeLattice lattice = cube_lattice(store, query.seen_cube);
  const Query cubes = query_of_cubes(query, how.radius);
  SeenSpace space;
  space.summary.cube = static_cast<double>(lattice.side[0]) * store.quantisation().scale[0];
  const BrickCloud cloud(
      bricks_along(query, how.radius, lattice, store.quantisation(), how.memory_bytes / 4), lattice,
      store.quantisation());
  if (cloud.bricks().empty()) return space;
  std::vector<SweptBrick> swept =
      sweep(cloud, cubes, how.memory_bytes, *how.kind(cloud, cubes), progress);

  std::vector<Brick> bricks;
  std::vector<std::uint32_t> cell_of_brick;
  std::vector<std::uint64_t> words;
  for (std::uint32_t cell = 0; cell < swept.size(); ++cell) {
    if (swept[cell].count() == 0) continue;
    bricks.push_back(cloud.bricks()[cell]);
    cell_of_brick.push_back(cell);
    words.insert(words.end(), swept[cell].words.begin(), swept[cell].words.end());
    space.summary.swept += swept[cell].count();
  }
  BrickMap map(lattice, std::move(bricks), std::move(words));
  follow_beams(store, how, map, space.beams, progress);

  std::vector<Unseen> unseen;
  for (std::uint32_t b = 0; b < map.bricks().size(); ++b) {
    const SweptBrick& brick = swept[cell_of_brick[b]];
    std::size_t next = 0;
    for (std::uint32_t word = 0; word < kBrickWords; ++word) {
      for (std::uint64_t open = brick.words[word]; open != 0; open &= open - 1, ++next) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(open));
        if ((map.words(b)[word] >> bit & 1) == 0) continue;
        unseen.push_back({map.bricks()[b].cube(64 * word + bit), brick.first_poses[next]});
      }
    }
  }
  const std::vector<double> chainage = chainage_of(query.poses);
  std::sort(unseen.begin(), unseen.end(),
            [](const Unseen& a, const Unseen& b) { return a.cube < b.cube; });
  for (const Unseen& one : unseen) {
    space.unseen.cube.push_back({one.cube.i[0], one.cube.i[1], one.cube.i[2]});
    space.unseen.first_pose.push_back(one.first_pose);
    const std::size_t next = std::size_t{one.first_pose} + 1;
    space.unseen.step.push_back(next < chainage.size() ? chainage[next] - chainage[next - 1] : 0);
  }
  space.unseen.group.resize(unseen.size());
  space.summary.unseen = unseen.size();
  space.summary.seen = space.summary.swept - unseen.size();
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
  std::map<std::uint32_t, double> steps;  // of the poses that first reach a cube of a listed group
  for (std::size_t i = 0; i < unseen.size(); ++i) {
    if (is_listed(unseen.group[i])) steps[unseen.first_pose[i]] = unseen.step[i];
  }
  summary.not_scanned_length = 0;
  for (const auto& [pose, step] : steps) summary.not_scanned_length += step;
  unseen.step.clear();
}

void warn_of_beams(const BeamCounts& beams, MessageLog& log) {
  if (beams.without_origin > 0) {
    log.warn("beams-without-origin",
             format_count(beams.without_origin) +
                 " points do not say where their scanner stood, so that their beams show nothing",
             {{"points", static_cast<double>(beams.without_origin)}});
  }
  if (beams.too_long > 0) {
    log.warn("long-beams",
             format_count(beams.too_long) +
                 " beams are longer than 1 km, or than 2^30 steps of the stored coordinates, and "
                 "are left out. Are the origins those of these scans?",
             {{"beams", static_cast<double>(beams.too_long)}});
  }
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
