#include "search/ledger_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>

#include "clearway/error.hpp"
#include "core/cloud/scan_points.hpp"
#include "core/cloud/small_cloud.hpp"
#include "core/messages/messages.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/search_result.hpp"
#include "core/seen/brick_map.hpp"
#include "core/util/format.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/grouped_points.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "search/check_query.hpp"
#include "search/kinds/cpu_kind.hpp"
#include "search/kinds/visit_kind.hpp"
#include "search/seen_space.hpp"
#include "search/visit.hpp"

namespace clearway {
namespace {

constexpr Pose kInPlace{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};

/// How far from a place the scan must have a point, metres.
constexpr double kScannedWithin = 1;

/// Points of a cell of places.
constexpr std::uint32_t kCellPoints = 512;

/// The first pose of each point of a cloud, by the number of the point; kNoPose where it
/// does not collide.
std::vector<std::uint32_t> first_poses(const SmallCloud& cloud, const Query& query,
                                       std::uint64_t memory_bytes, int threads,
                                       Progress& progress) {
  SearchOptions options;
  options.engine = Engine::kSweep;
  options.device = Device::kCpu;
  options.threads = threads;
  options.memory_bytes = memory_bytes;
  const std::unique_ptr<PageEngineKind> kind =
      visit_kind(cloud, {{query}}, [&](const Query& one) { return cpu_kind(cloud, one, options); });
  const BodyNumbers numbers(query);
  // Every page writes the entries of its own points.
  std::vector<std::uint32_t> poses(cloud.point_count(), kNoPose);
  const CollectPage collect = [&](std::span<const PlannedCell> cells, const PageResult& found) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const CellRows hits = hit_rows(cloud, found, i);
      hits.for_each([&](std::uint32_t point, std::size_t row) {
        poses[cloud.source_of(cells[i].cell, point)] = numbers.pose_of(hits.poses[row]);
      });
    }
  };
  run_visit(cloud,
            {.query = query,
             .memory_bytes = memory_bytes,
             .kind = *kind,
             .collect = collect,
             .stage = "places of the ledger"},
            progress);
  return poses;
}

/// Places in cubes of 1 m that still need a point of the scan beside them.
class UnscannedPlaces {
 public:
  explicit UnscannedPlaces(double within) : within_(within) {}

  void add(const Vec3& place) {
    cubes_[cube_of(place)].push_back(static_cast<std::uint32_t>(places_.size()));
    places_.push_back(place);
    is_open_.push_back(true);
  }

  /// Takes a point of the scan.
  void meet(const Vec3& p) {
    const GridCube own = cube_of(p);
    for (int i = 0; i < 27; ++i) {
      const auto cube = cubes_.find({own.x + i % 3 - 1, own.y + i / 3 % 3 - 1, own.z + i / 9 - 1});
      if (cube == cubes_.end()) continue;
      std::erase_if(cube->second, [&](std::uint32_t place) {
        const Vec3 d = places_[place] - p;
        if (dot(d, d) > within_ * within_) return false;
        is_open_[place] = false;
        return true;
      });
      if (cube->second.empty()) cubes_.erase(cube);
    }
  }

  bool is_open(std::size_t place) const { return is_open_[place]; }
  const std::vector<Vec3>& places() const { return places_; }

 private:
  GridCube cube_of(const Vec3& p) const {
    const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x / within_)); };
    return {along(p.x), along(p.y), along(p.z)};
  }

  double within_;
  std::vector<Vec3> places_;
  std::vector<bool> is_open_;
  std::unordered_map<GridCube, std::vector<std::uint32_t>, GridCubeHash> cubes_;
};

/// The places that lie in cubes which a beam of the scanner passed through.
std::vector<bool> seen_places(const StoreReader& store, const std::vector<Vec3>& places,
                              int threads, Progress& progress) {
  std::vector<bool> seen(places.size());
  if (places.empty() || !store.has_origins()) return seen;
  CubeLattice lattice{};
  try {
    lattice = cube_lattice(store, 0);
  } catch (const UsageError&) {
    return seen;  // the store's step is too coarse or too fine for cubes
  }
  constexpr double kMost = 0x1p30;
  std::vector<std::optional<Cube>> cubes;
  std::map<Brick, std::array<std::uint64_t, kBrickWords>> bricks;
  for (const Vec3& place : places) {
    Cube cube{};
    bool fits = true;
    for (int k = 0; k < 3; ++k) {
      const Quantisation& steps = store.quantisation();
      const double q = std::round((place[k] - steps.offset[k]) / steps.scale[k]);
      fits = fits && std::abs(q) < kMost * static_cast<double>(lattice.side[k]);
      if (fits) cube.i[k] = lattice.cube_of(k, static_cast<std::int64_t>(q));
    }
    cubes.push_back(fits ? std::optional(cube) : std::nullopt);
    if (!fits) continue;
    const std::uint32_t entry = entry_of(cube);
    bricks[Brick::of(cube)][entry / 64] |= std::uint64_t{1} << (entry % 64);
  }
  std::vector<Brick> keys;
  std::vector<std::uint64_t> words;
  std::map<Brick, std::uint32_t> number;
  for (const auto& [brick, of_brick] : bricks) {
    number[brick] = static_cast<std::uint32_t>(keys.size());
    keys.push_back(brick);
    words.insert(words.end(), of_brick.begin(), of_brick.end());
  }
  if (keys.empty()) return seen;
  BrickMap map(lattice, std::move(keys), std::move(words));
  follow_all_beams(store, threads, map, progress);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!cubes[i]) continue;
    const std::uint32_t entry = entry_of(*cubes[i]);
    const auto of_brick = map.words(number.at(Brick::of(*cubes[i])));
    seen[i] = (of_brick[entry / 64] >> (entry % 64) & 1) == 0;
  }
  return seen;
}

std::string are(std::size_t count, std::size_t of) {
  return count == of ? "none of its places" : counted(count, "of its places", "of its places");
}

}  // namespace

LedgerEvidence::LedgerEvidence(const GroupedResult& found, const ConflictOptions& find,
                               const LedgerOptions& options, Progress& progress)
    : found_(found),
      options_(options),
      store_(options.store != nullptr ? &options.store->reader() : nullptr),
      progress_(progress),
      threads_(threads_or_all(options.threads)) {
  const bool knows_model = (find.model != nullptr && !find.model->empty()) || !find.bodies.empty();
  if (!knows_model || store_ == nullptr) return;
  static const Model kNone{};
  const Model& model = find.model != nullptr ? *find.model : kNone;
  check_searched(found.result.reader(), *store_, {model, find.bodies, found.poses});
  const ResultHeader& header = found.result.reader().header();
  QueryParameters asked;
  asked.radius = header.radius;
  asked.floor = header.floor;
  asked.between_poses = header.between_poses;
  asked.ignore_boxes = header.ignore_boxes;
  asked.first_pose = true;
  Query& query = query_.emplace_back(model, found.poses, asked);
  query.bodies.assign(find.bodies.begin(), find.bodies.end());
}

std::vector<std::string> LedgerEvidence::why_not_gone(
    std::span<const LedgerPlaces* const> rows) const {
  std::vector<std::string> reasons(rows.size());
  if (!knows_all()) {
    std::ranges::fill(reasons, "the store and the model are needed to show that it is gone");
    return reasons;
  }
  const std::vector<std::vector<Touch>> touches = search(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    reasons[i] = of_search(touches[i]);
    if (reasons[i].empty()) reasons[i] = of_warnings(touches[i]);
    if (reasons[i].empty()) reasons[i] = of_withheld(*rows[i]);
  }
  look_at_store(rows, reasons);
  return reasons;
}

/// Searches the places as an environment, all of those in the same steps at once.
std::vector<std::vector<LedgerEvidence::Touch>> LedgerEvidence::search(
    std::span<const LedgerPlaces* const> rows) const {
  std::vector<std::vector<Touch>> touches(rows.size());
  std::vector<bool> is_done(rows.size());
  const Query& query = query_.front();
  const Query reversed = backwards(query);
  const auto last = static_cast<std::uint32_t>(query.poses.size() - 1);
  for (std::size_t first = 0; first < rows.size(); ++first) {
    if (is_done[first]) continue;
    const Quantisation& steps = rows[first]->quantisation;
    std::vector<Quantum> points;
    std::vector<std::size_t> of_group;
    for (std::size_t i = first; i < rows.size(); ++i) {
      if (is_done[i] || !(rows[i]->quantisation == steps)) continue;
      is_done[i] = true;
      of_group.push_back(i);
      for (const QuantumPoint& p : rows[i]->quanta) points.push_back({p.q[0], p.q[1], p.q[2]});
    }
    const SmallCloud cloud(points, steps, {.cell_points = kCellPoints});
    const auto from = first_poses(cloud, query, options_.memory_bytes, threads_, progress_);
    const auto back = first_poses(cloud, reversed, options_.memory_bytes, threads_, progress_);
    std::size_t point = 0;
    for (const std::size_t row : of_group) {
      for (std::size_t i = 0; i < rows[row]->quanta.size(); ++i, ++point) {
        if (from[point] == kNoPose || back[point] == kNoPose) {
          touches[row].emplace_back();
        } else {
          // Between poses, a way belongs to both of its poses.
          touches[row].emplace_back(
              PoseRange{from[point], std::max(from[point], last - std::min(last, back[point]))});
        }
      }
    }
  }
  return touches;
}

std::string LedgerEvidence::of_search(const std::vector<Touch>& touches) const {
  const auto missed = static_cast<std::size_t>(std::ranges::count(touches, Touch()));
  if (missed == 0) return "";
  return "this question would not find it, because " + are(missed, touches.size()) +
         (missed == touches.size() ? " collides" : " would not collide");
}

std::string LedgerEvidence::of_warnings(const std::vector<Touch>& touches) const {
  for (const Message& warning : counted_answer(found_.result.reader()).warnings) {
    if (warning.stretches.empty() && may_miss(warning.code)) {
      return "the run warns of " + warning.code + ", so it may have missed points";
    }
    for (const PoseRange& stretch : warning.stretches) {
      const bool reaches = std::ranges::any_of(touches, [&](const Touch& touch) {
        return touch && stretch.first <= touch->last && touch->first <= stretch.last;
      });
      if (reaches) return "the run warns of " + warning.code + " where it is";
    }
  }
  return "";
}

std::string LedgerEvidence::of_withheld(const LedgerPlaces& row) const {
  const auto& withheld = store_->metadata().withheld;
  if (!withheld || withheld->cubes.empty()) return "";
  const double edge = metre_cube_edge(store_->metadata().unit);
  const auto index = [edge](double x) {
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int64_t>(std::clamp(std::floor(x / edge), -kMost - 1, kMost));
  };
  for (std::size_t i = 0; i < row.quanta.size(); ++i) {
    const Vec3 p = row.place(i);
    for (int k = 0; k < 27; ++k) {
      const std::array<std::int64_t, 3> cube{index(p.x) + k % 3 - 1, index(p.y) + k / 3 % 3 - 1,
                                             index(p.z) + k / 9 - 1};
      constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
      constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
      if (std::ranges::any_of(cube, [](std::int64_t c) { return c < kLeast || c > kMost; })) {
        continue;
      }
      const MetreCube as_cube{static_cast<std::int32_t>(cube[0]),
                              static_cast<std::int32_t>(cube[1]),
                              static_cast<std::int32_t>(cube[2])};
      if (std::ranges::binary_search(withheld->cubes, as_cube)) {
        return "points with the flag withheld were left out there";
      }
    }
  }
  return "";
}

/// Adds reasons for rows that have none: points that the question ignores, and places where nothing
/// was scanned.
void LedgerEvidence::look_at_store(std::span<const LedgerPlaces* const> rows,
                                   std::vector<std::string>& reasons) const {
  struct Row {
    std::size_t index;
    Box box{};  ///< what may be near enough to matter
    Places gap;
    std::size_t first_place = 0;
    bool has_ignored = false;
  };
  const double within = kScannedWithin * metre_of(*store_);
  UnscannedPlaces unscanned(within);
  std::vector<Row> open;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!reasons[i].empty()) continue;
    Row row{i, {}, Places(rows[i]->gap)};
    row.first_place = unscanned.places().size();
    row.box = {rows[i]->place(0), rows[i]->place(0)};
    for (std::size_t k = 0; k < rows[i]->quanta.size(); ++k) {
      const Vec3 p = rows[i]->place(k);
      row.box.extend(p);
      row.gap.add({p, 1});
      unscanned.add(p);
    }
    row.box = row.box.grown(std::max(within, rows[i]->gap) + Places::kRounding);
    open.push_back(std::move(row));
  }
  if (open.empty()) return;
  const ResultHeader& header = found_.result.reader().header();
  const auto is_ignored = [&](const Vec3& p, std::uint8_t of_class) {
    return std::ranges::find(header.ignore_classes, of_class) != header.ignore_classes.end() ||
           std::ranges::any_of(header.ignore_boxes,
                               [&](const Box& box) { return box.contains(p); });
  };
  constexpr auto kAllBlocks = std::numeric_limits<std::uint32_t>::max();
  const ScanPoints points(*store_, kAllBlocks);
  const bool knows_class = !header.ignore_classes.empty() && store_->has_classes();
  for (Row& row : open) {
    throw_if_stopped(progress_);
    const auto look = [&](const Vec3& p, std::uint32_t cell, std::uint32_t index) {
      if (!row.has_ignored && is_ignored(p, knows_class ? store_->class_of(cell, index) : 0)) {
        row.has_ignored = row.gap.near(p).has_value();
      }
      unscanned.meet(p);
      return true;
    };
    if (!store_->cells().empty()) points.visit(row.box, kInPlace, look);
  }
  std::vector<Vec3> far;
  std::vector<std::size_t> of_far(unscanned.places().size());
  for (std::size_t i = 0; i < unscanned.places().size(); ++i) {
    of_far[i] = far.size();
    if (unscanned.is_open(i)) far.push_back(unscanned.places()[i]);
  }
  const std::vector<bool> seen = seen_places(*store_, far, threads_, progress_);
  for (const Row& row : open) {
    std::size_t missed = 0;
    for (std::size_t k = 0; k < rows[row.index]->quanta.size(); ++k) {
      const std::size_t place = row.first_place + k;
      if (unscanned.is_open(place) && !seen[of_far[place]]) ++missed;
    }
    if (row.has_ignored) {
      reasons[row.index] = "points that this question ignores are there";
    } else if (missed > 0) {
      reasons[row.index] = "nothing was scanned within " + format_brief(kScannedWithin) + " m of " +
                           counted(missed, "of its places", "of its places");
    }
  }
}

}  // namespace clearway
