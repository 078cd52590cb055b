#include <tbb/blocked_range.h>
#include <tbb/parallel_sort.h>
#include <tbb/spin_mutex.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/error.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/point_classes.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "findings/across_body.hpp"
#include "findings/certain_points.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/colliding_points.hpp"
#include "findings/colliding_spacing.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/row_pieces.hpp"
#include "findings/shift/least_shift.hpp"
#include "findings/tally_points.hpp"
#include "findings/touched_first.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// What find_conflicts() takes of the memory budget. The checks throw ResourceError with an amount
/// that is enough.
class ConflictMemory {
 public:
  ConflictMemory(std::uint64_t allowed, std::uint64_t points, std::uint64_t poses)
      : allowed_(allowed), points_(points), poses_(poses) {}

  /// Called before the points are read: checks the memory of the points and their grid.
  void check_points() const;
  /// Called before the cells of the grid are kept: checks the memory of that many cells.
  void check_cells(std::uint64_t cells) const;
  /// Called before groups are summed up: checks the memory of that many cells and parts.
  void check_parts(std::uint64_t cells, std::uint64_t parts) const;

 private:
  std::uint64_t fixed() const;
  std::uint64_t with_cells(std::uint64_t cells) const;
  void check(std::uint64_t needed, std::uint64_t enough) const;

  std::uint64_t allowed_, points_, poses_;
};

constexpr std::uint64_t kProgram = std::uint64_t{32} << 20;  // includes the reader's buffers
constexpr std::uint64_t kMostPoints = 0xffff'fffe;

/// Bytes of a cell: what the grid holds of it, its set, its group, and the count of its points.
constexpr std::uint64_t kBytesOfCell = CellGrid::kBytesOfCell + 3 * sizeof(std::uint32_t);
/// Bytes of a point once it is in the grid, including its source, first and last pose, body, class
/// and part.
constexpr std::uint64_t kBytesOfSortedPoint = CellGrid::kBytesOfPoint + sizeof(std::uint64_t) +
                                              3 * sizeof(std::uint32_t) + 2 + kJoinBytesOfPoint;
constexpr std::uint64_t kBytesOfUnsortedPoint =
    CollidingPoints::kBytesOfPoint + CellGrid::kBytesOfPoint;
/// Bytes of a part, with where it lies across its body, its conflict, which counts twice because
/// vectors grow to twice their size, and what finding its shifts takes.
constexpr std::uint64_t kBytesOfPart = sizeof(Tally) + sizeof(PartAcross) + 2 * sizeof(Conflict) +
                                       32 + LeastShift::kBytesOfSet + sizeof(PointsToFree);
// Classes are counted when the memory of the grid is free again.
static_assert(sizeof(std::uint64_t) <= CellGrid::kBytesOfPoint);
// Shifts are found when the memory of joining points is free again, and their trees are made when
// that of the grid is, too.
static_assert(sizeof(QuantumPoint) <= kJoinBytesOfPoint);
static_assert(sizeof(QuantumPoint) + LeastShift::kBytesOfPoint <=
              kJoinBytesOfPoint + CellGrid::kBytesOfPoint);

std::uint64_t ConflictMemory::fixed() const {
  return kProgram + poses_ * (sizeof(Pose) + sizeof(double) + sizeof(std::uint32_t));
}

std::uint64_t ConflictMemory::with_cells(std::uint64_t cells) const {
  return fixed() + cells * kBytesOfCell +
         points_ * std::max(kBytesOfUnsortedPoint, kBytesOfSortedPoint);
}

void ConflictMemory::check_points() const {
  if (points_ > kMostPoints) {
    throw UsageError(format_count(points_) + " colliding points; conflicts are made of up to " +
                     format_count(kMostPoints));
  }
  check(fixed() + points_ * kBytesOfUnsortedPoint, with_cells(points_));
}

void ConflictMemory::check_cells(std::uint64_t cells) const {
  check(with_cells(cells), with_cells(cells));
}

void ConflictMemory::check_parts(std::uint64_t cells, std::uint64_t parts) const {
  if (parts > kMostPoints) {
    throw UsageError(format_count(parts) + " conflicts; expected fewer than " +
                     format_count(kMostPoints));
  }
  const std::uint64_t needed = with_cells(cells) + parts * kBytesOfPart;
  check(needed, needed);
}

void ConflictMemory::check(std::uint64_t needed, std::uint64_t enough) const {
  if (needed <= allowed_) return;
  throw ResourceError(format_size(allowed_) + " of memory is too little: the conflicts of " +
                          counted(points_, "point") + " need at least " + format_size(needed),
                      Remedy::kMoreMemory, static_cast<double>(enough));
}

/// The point of a conflict that is nearest to the model.
struct ConflictDistance {
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  double distance = 0;  ///< metres, below 0 inside solids
  /// Source index; of equally near points the smallest.
  std::uint64_t source = kNone;
  std::uint32_t pose = 0;
  Vec3 xyz{};
  /// The body that is so near, for a vehicle.
  std::optional<std::uint32_t> body = {};
  std::uint64_t inside = 0;  ///< number of points with a distance below 0
};

/// The nearest points of conflicts, which several threads may offer at the same time. Most points
/// are no nearer than what is known, and need no lock.
class NearestPoints {
 public:
  /// For conflicts with the numbers 1 to `conflicts`.
  explicit NearestPoints(std::size_t conflicts)
      : nearest_(conflicts + 1), known_(conflicts + 1), inside_(conflicts + 1) {
    for (auto& known : known_) known = std::numeric_limits<double>::infinity();
  }

  void offer(std::uint32_t conflict, const Clearances& rows, std::size_t i) {
    const double distance = rows.distance[i];
    if (distance < 0) inside_[conflict].fetch_add(1, std::memory_order_relaxed);
    if (distance > known_[conflict].load(std::memory_order_relaxed)) return;
    tbb::spin_mutex& lock = locks_[conflict % locks_.size()];
    const tbb::spin_mutex::scoped_lock held(lock);
    acquire(&lock);
    ConflictDistance& nearest = nearest_[conflict];
    if (nearest.source == ConflictDistance::kNone || distance < nearest.distance ||
        (distance == nearest.distance && rows.source[i] < nearest.source)) {
      nearest = {distance, rows.source[i], rows.pose[i], rows.xyz[i],
                 rows.body.empty() ? std::nullopt : std::optional(rows.body[i])};
      known_[conflict].store(distance, std::memory_order_relaxed);
    }
    release(&lock);
  }

  std::vector<ConflictDistance> take() {
    for (std::size_t i = 0; i < nearest_.size(); ++i) nearest_[i].inside = inside_[i];
    return std::move(nearest_);
  }

 private:
  std::vector<ConflictDistance> nearest_;
  std::vector<std::atomic<double>> known_;
  std::vector<std::atomic<std::uint64_t>> inside_;
  std::array<tbb::spin_mutex, 64> locks_;
};

/// Joins the clearances with the colliding points; both are in ascending order of their source.
/// Returns the nearest point of each conflict at the conflict's number, from 1 to `conflicts`.
/// conflict_of: the conflict of each row, 0 for none.
std::vector<ConflictDistance> least_distances(const ResultReader& result,
                                              std::span<const std::uint64_t> source,
                                              std::span<const std::uint32_t> conflict_of,
                                              std::size_t conflicts, Progress& progress) {
  NearestPoints nearest(conflicts);
  progress.begin("distances", result.clearances(), "points");
  RowStream<Clearances> stream(result);
  std::size_t first_row = 0;  // below it, no source is among those of later clearances
  for (Clearances rows; stream.read(rows);) {
    throw_if_stopped(progress);
    const std::span<const std::uint64_t> left = source.subspan(first_row);
    in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
      auto at = std::ranges::lower_bound(left, rows.source[first]);
      for (std::size_t i = first; i < end; ++i) {
        while (at != left.end() && *at < rows.source[i]) ++at;
        if (at == left.end()) return;
        if (*at != rows.source[i]) continue;
        const std::uint32_t conflict = conflict_of[static_cast<std::size_t>(&*at - source.data())];
        if (conflict != 0) nearest.offer(conflict, rows, i);
      }
    });
    first_row +=
        static_cast<std::size_t>(std::ranges::upper_bound(left, rows.source.back()) - left.begin());
    progress.advance(rows.size());
  }
  progress.end();
  return nearest.take();
}

/// Points in the order of their conflicts.
struct PointsOfConflicts {
  std::vector<QuantumPoint> points;
  /// The first point of each conflict, by its number - 1, and at the end the number of all points.
  std::vector<std::size_t> first;

  std::span<QuantumPoint> of(std::uint32_t id) {
    return std::span(points).subspan(first[id - 1], first[id] - first[id - 1]);
  }
};

/// One call of find_conflicts(), step by step.
class ConflictSearch {
 public:
  inline static const Model kNoModel{};
  /// The cosine of 45 degrees: the model moves along its forward axis up to this angle.
  static constexpr double kAlong = 0.7071067811865476;

  ConflictSearch(const Result& result, const std::vector<Pose>& poses,
                 const ConflictOptions& options, Progress& progress)
      : reader_(result.reader()),
        poses_(poses),
        options_(options),
        boxes_(boxes_of(result, options)),
        metre_(metres_per_unit(reader_.header())),
        progress_(progress),
        memory_(options.memory_bytes, reader_.collisions() + reader_.near(), poses.size()),
        chainage_(chainage_of(poses)) {}

  Conflicts run(std::vector<std::uint32_t>* conflict_of,
                std::vector<std::uint32_t>* conflict_of_near) {
    out_.path_length = chainage_.empty() ? 0 : chainage_.back();
    out_.colliding_points = reader_.collisions();
    out_.near_points = reader_.near();
    if (conflict_of != nullptr) conflict_of->clear();
    if (conflict_of_near != nullptr) conflict_of_near->clear();
    out_.knows_trims = !boxes_.empty();
    out_.knows_shifts =
        !options_.bodies.empty() || (options_.model != nullptr && !options_.model->empty());
    if (out_.colliding_points + out_.near_points == 0) {
      choose_grouping();
      return std::move(out_);
    }
    memory_.check_points();
    points_ = read_colliding_points(reader_, progress_);
    choose_grouping();
    const std::vector<std::uint32_t> certain = rows_of_certain_groups();
    group();
    std::vector<std::uint32_t> part_of_row = list();
    classify(certain, part_of_row);
    std::vector<std::uint32_t> of_near = take_near(part_of_row);
    if (conflict_of_near != nullptr) *conflict_of_near = std::move(of_near);
    if (conflict_of != nullptr) *conflict_of = std::move(part_of_row);
    return std::move(out_);
  }

 private:
  /// The rows of the points that are certainly too close and of which ten or more hang together by
  /// the gap of the search, in no particular order.
  std::vector<std::uint32_t> rows_of_certain_groups() {
    std::vector<QuantumPoint> quanta;
    std::vector<std::uint32_t> row_of, out;
    for (std::size_t row = 0; row < points_.kind.size(); ++row) {
      if (points_.kind[row] != CollidingPoints::kCertain) continue;
      quanta.push_back(points_.quanta[row]);
      row_of.push_back(static_cast<std::uint32_t>(row));
    }
    const ResultHeader& header = reader_.header();
    for (const std::uint32_t member :
         members_of_certain_groups(quanta, header.quantisation, header.gap, progress_)) {
      out.push_back(row_of[member]);
    }
    return out;
  }

  /// Says of each conflict whether it is certain. certain: rows_of_certain_groups().
  void classify(std::span<const std::uint32_t> certain,
                std::span<const std::uint32_t> conflict_of_row) {
    if (!reader_.header().budget) return;
    for (Conflict& conflict : out_.listed) conflict.certain = false;
    for (const std::uint32_t row : certain) {
      if (const std::uint32_t id = conflict_of_row[row]) out_.listed[id - 1].certain = true;
    }
  }

  /// Removes the rows of near points, so that the rest are those of /collisions, and returns them.
  std::vector<std::uint32_t> take_near(std::vector<std::uint32_t>& of_row) const {
    std::vector<std::uint32_t> near;
    if (points_.kind.empty()) return near;
    std::size_t kept = 0;
    for (std::size_t row = 0; row < of_row.size(); ++row) {
      if (points_.kind[row] == CollidingPoints::kNear) {
        near.push_back(of_row[row]);
      } else {
        of_row[kept++] = of_row[row];
      }
    }
    of_row.resize(kept);
    return near;
  }

  static double metres_per_unit(const ResultHeader& header) {
    const double metre = metres_of(unit_of(header));
    return metre > 0 ? metre : 1;
  }

  /// Chooses the gap and the least number of points, where the options leave them open.
  void choose_grouping() {
    const Grouping usual =
        usual_grouping(out_.colliding_points > 0, spacing_of_colliding(), metre_);
    out_.gap = options_.gap > 0 ? options_.gap : usual.gap;
    out_.min_points = options_.min_points > 0 ? options_.min_points : usual.min_points;
  }

  std::optional<double> spacing_of_colliding() {
    std::vector<QuantumPoint> colliding;
    if (out_.near_points > 0) {
      for (std::size_t row = 0; row < points_.kind.size(); ++row) {
        if (points_.kind[row] != CollidingPoints::kNear) colliding.push_back(points_.quanta[row]);
      }
    }
    out_.spacing = colliding_spacing(out_.near_points > 0 ? colliding : points_.quanta,
                                     reader_.header().quantisation, progress_);
    return out_.spacing;
  }

  void group() {
    const Neighbourhood neighbourhood(reader_.header().quantisation, out_.gap);
    grid_.emplace(points_.quanta, neighbourhood,
                  [this](std::uint64_t cells) { memory_.check_cells(cells); });
    points_.quanta = {};
    UnionFind sets(grid_->cells());
    join_cells(*grid_, neighbourhood, sets, progress_);
    groups_ = number_groups(*grid_, sets, out_.min_points);
    out_.groups = groups_.count + groups_.small_groups;
    out_.small_groups = groups_.small_groups;
    out_.small_points = groups_.small_points;
  }

  /// Lists the conflicts, and returns the conflict of each row.
  std::vector<std::uint32_t> list() {
    const std::uint64_t groups_in_all = groups_.count + groups_.small_groups;
    memory_.check_parts(grid_->cells(), groups_in_all);
    const TouchPoses touch{points_.first_pose, points_.last_pose};
    list_small(tally_small_groups(*grid_, groups_, touch, progress_));
    const std::vector<Tally> groups = tally_groups(*grid_, groups_, touch, progress_);
    note_longest(groups);
    const PathStretches stretches(chainage_, options_.split);
    const GroupParts parts = cut(groups, stretches);
    memory_.check_parts(grid_->cells(), groups_in_all + parts.count());
    std::vector<std::uint32_t> part_of_row(points_.source.size());
    const std::vector<Tally> tallies =
        tally_parts(*grid_, groups_, parts, stretches, touch, part_of_row, progress_);
    make_conflicts(groups, parts, tallies);
    add_touched_first(tallies, part_of_row);
    add_trims(tallies, part_of_row);
    number(part_of_row, tallies.size());
    PointsOfConflicts to_free = points_to_free(part_of_row);
    grid_.reset();
    add_distances(part_of_row);
    add_depths(part_of_row);
    for (Conflict& conflict : out_.listed) complete(conflict);
    count_colliding(part_of_row);
    add_classes(part_of_row);
    add_shifts(std::move(to_free));
    rank(out_);
    return part_of_row;
  }

  void list_small(const std::vector<Tally>& tallies) {
    for (const Tally& tally : tallies) {
      out_.small.push_back({tally.points, points_.source[tally.first_row],
                            position_box(reader_.header().quantisation, tally.box),
                            tally.first_pose, tally.last_pose,
                            chainage_[tally.first_pose] + options_.chainage_start,
                            chainage_[end_of(tally.last_pose)] + options_.chainage_start,
                            station_of(tally.first_pose), station_of(end_of(tally.last_pose))});
    }
    std::ranges::sort(out_.small, {}, [](const SmallGroup& group) {
      return std::pair(group.chainage_from, group.source);
    });
  }

  /// The pose at which the contact of a last pose ends, which between poses is the end of its way.
  std::uint32_t end_of(std::uint32_t last_pose) const {
    const bool way = reader_.header().between_poses && last_pose + 1 < chainage_.size();
    return last_pose + (way ? 1 : 0);
  }

  std::optional<double> station_of(std::uint32_t pose) const {
    if (options_.station.empty()) return std::nullopt;
    return options_.station[pose];
  }

  double length_of(const Tally& tally) const {
    return chainage_[tally.latest_first_pose] - chainage_[tally.first_pose];
  }

  void note_longest(const std::vector<Tally>& groups) {
    std::uint32_t longest = 0;
    for (std::uint32_t i = 0; i < groups.size(); ++i) {
      const double length = length_of(groups[i]);
      if (length < out_.longest_group) continue;
      if (length == out_.longest_group && groups[i].points < out_.longest_group_points) continue;
      out_.longest_group = length;
      out_.longest_group_points = groups[i].points;
      longest = i;
    }
    if (spans_most_of_the_path(out_) && !boxes_.empty()) place_longest(longest);
  }

  /// Finds where the points of a group lie when they are first touched, and what that says of them.
  void place_longest(std::uint32_t group) {
    const double low = ground_height(unit_of(reader_.header()));
    double from = std::numeric_limits<double>::infinity(), to = -from;
    std::uint64_t in_lowest = 0, below = 0, left = 0, right = 0;
    bool is_inside = true;
    for (std::uint32_t cell = 0; cell < grid_->cells(); ++cell) {
      if (groups_.of_cell[cell] != group) continue;
      for (const GroupedPoint& p : std::as_const(*grid_).points(cell)) {
        const auto body =
            points_.body.empty() ? std::nullopt : std::optional<std::uint32_t>(points_.body[p.row]);
        const Pose* pose = pose_of(body, points_.first_pose[p.row]);
        if (pose == nullptr) continue;
        const Box box = turned(boxes_[body.value_or(0)], options_.forward, options_.up);
        const Vec3 place = position(reader_.header().quantisation, p.q[0], p.q[1], p.q[2]);
        const Vec3 there = ahead_left_up(place, *pose, options_.forward, options_.up);
        const double height = there.z - box.lo.z;
        from = std::min(from, height);
        to = std::max(to, height);
        in_lowest += height <= low ? 1 : 0;
        below += height < 0 ? 1 : 0;
        ++(there.y > box.centre().y ? left : right);
        is_inside = is_inside && there.y > box.lo.y && there.y < box.hi.y && there.z > box.lo.z &&
                    there.z < box.hi.z;
      }
    }
    if (!std::isfinite(from) || !std::isfinite(to)) return;
    out_.longest_group_height_from = from;
    out_.longest_group_height_to = to;
    // Each wheel track may be a group of its own; a kerb on one side is higher than the wheels
    // stand.
    const std::uint64_t all = left + right;
    const bool is_on_both_sides = left > 0 && right > 0;
    if (2 * below >= all || (is_on_both_sides && 2 * in_lowest >= all)) {
      out_.longest_group_is = GroupPlace::kGround;
    } else if (is_on_both_sides && is_inside) {
      out_.longest_group_is = GroupPlace::kInside;
    }
  }

  GroupParts cut(const std::vector<Tally>& groups, const PathStretches& stretches) const {
    GroupParts out;
    std::uint64_t next = 0;
    for (const Tally& group : groups) {
      const bool is_cut = options_.split > 0 && length_of(group) > options_.split;
      const std::uint32_t stretch = stretches[group.first_pose];
      out.first.push_back(next);
      out.stretch.push_back(stretch);
      out.is_cut.push_back(is_cut);
      next += is_cut ? stretches[group.latest_first_pose] - stretch + 1 : 1;
    }
    out.first.push_back(next);
    return out;
  }

  /// Makes a conflict for each part that is not empty, in the order of the parts. Its id is for now
  /// the part's index + 1.
  void make_conflicts(const std::vector<Tally>& groups, const GroupParts& parts,
                      const std::vector<Tally>& tallies) {
    const Quantisation& quantisation = reader_.header().quantisation;
    for (std::size_t group = 0; group < groups.size(); ++group) {
      for (std::uint64_t part = parts.first[group]; part < parts.first[group + 1]; ++part) {
        const Tally& tally = tallies[part];
        if (tally.points == 0) continue;
        Conflict conflict;
        conflict.id = static_cast<std::uint32_t>(part + 1);
        conflict.points = tally.points;
        conflict.source = points_.source[tally.first_row];
        conflict.group = points_.source[groups[group].first_row];
        conflict.box = position_box(quantisation, tally.box);
        conflict.centroid = centroid_of(tally, quantisation);
        conflict.first_pose = tally.first_pose;
        conflict.last_pose = tally.last_pose;
        conflict.chainage_from = chainage_[tally.first_pose];
        out_.listed.push_back(conflict);
      }
    }
  }

  static Vec3 centroid_of(const Tally& tally, const Quantisation& quantisation) {
    Vec3 out{};
    const auto points = static_cast<__int128>(tally.points);
    for (int k = 0; k < 3; ++k) {
      const __int128 whole = tally.sum[k] / points;
      const double part = static_cast<double>(tally.sum[k] % points) / static_cast<double>(points);
      const double mean = static_cast<double>(whole) + part;
      out[k] = mean * quantisation.scale[k] + quantisation.offset[k];
    }
    return out;
  }

  void number(std::vector<std::uint32_t>& part_of_row, std::size_t parts) {
    std::ranges::sort(out_.listed, [](const Conflict& a, const Conflict& b) {
      return a.chainage_from != b.chainage_from ? a.chainage_from < b.chainage_from
                                                : a.source < b.source;
    });
    std::vector<std::uint32_t> id_of_part(parts + 1);
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < out_.listed.size(); ++i) {
      places.push_back(first_places_[out_.listed[i].id - 1]);
      id_of_part[out_.listed[i].id] = static_cast<std::uint32_t>(i + 1);
      out_.listed[i].id = static_cast<std::uint32_t>(i + 1);
    }
    first_places_ = std::move(places);
    for (std::uint32_t& part : part_of_row) part = id_of_part[part];
  }

  /// The boxes of the model or of each body; empty where they are not known. The bodies of a
  /// vehicle have frames of their own, so no single box says on which side a conflict is.
  static std::vector<Box> boxes_of(const Result& result, const ConflictOptions& options) {
    std::vector<Box> boxes;
    for (const Body& body : options.bodies) boxes.push_back(box_of(body.model.vertices));
    if (result.bodies().empty()) boxes.push_back(result.model_box());
    return boxes;
  }

  /// Sets the sides, and finds the places by which conflicts without clearances are seen. Called
  /// before conflicts are numbered.
  void add_touched_first(const std::vector<Tally>& tallies,
                         std::span<const std::uint32_t> part_of_row) {
    const Quantisation& quantisation = reader_.header().quantisation;
    std::vector<TouchedFirst> firsts(tallies.size());
    for (Conflict& conflict : out_.listed) {
      const Tally& tally = tallies[conflict.id - 1];
      if (!points_.body.empty()) conflict.body = points_.body[tally.first_touched];
      conflict.first_body = conflict.body;
      firsts[conflict.id - 1] = {tally.first_pose, tally.first_touched, conflict.body,
                                 pose_of(conflict.body, tally.first_pose)};
    }
    const AheadLeftUp axes{options_.forward, options_.up};
    find_touched_first(*grid_, groups_, points_, part_of_row, quantisation, axes, firsts,
                       progress_);
    for (Conflict& conflict : out_.listed) {
      const TouchedFirst& first = firsts[conflict.id - 1];
      if (boxes_.empty() || first.pose == nullptr || !first.is_finite()) continue;
      const Box& box = boxes_[conflict.body.value_or(0)];
      conflict.first_touch = side_of(first.seen, box, options_.forward, options_.up);
    }
    for (const TouchedFirst& first : firsts) first_places_.push_back(first.place);
  }

  /// Sets the trims and the sides. Called before conflicts are numbered.
  void add_trims(const std::vector<Tally>& tallies, std::span<const std::uint32_t> part_of_row) {
    if (boxes_.empty()) return;
    const ResultHeader& header = reader_.header();
    const std::vector<MovingBody> bodies =
        moving_bodies(kNoModel, poses_, options_.bodies, header.floor);
    const BodiesAcross how{
        bodies, boxes_, {options_.forward, options_.up}, header.radius, header.between_poses};
    std::vector<PartAcross> parts(tallies.size());
    for (const Conflict& conflict : out_.listed) {
      parts[conflict.id - 1] = {conflict.first_body.value_or(0), conflict.first_pose,
                                end_of(conflict.last_pose)};
    }
    find_across_bodies(*grid_, groups_, part_of_row, header.quantisation, how, parts, progress_);
    for (Conflict& conflict : out_.listed) {
      const PartAcross& part = parts[conflict.id - 1];
      set_trims(part.found, how.box_from_floor(part.body), how.whole_box(part.body), header.radius,
                conflict);
    }
  }

  void add_distances(const std::vector<std::uint32_t>& conflict_of_row) {
    if (!(reader_.header().clearance > 0)) return;
    const auto least =
        least_distances(reader_, points_.source, conflict_of_row, out_.listed.size(), progress_);
    for (Conflict& conflict : out_.listed) {
      const ConflictDistance& found = least[conflict.id];
      if (reader_.header().model_solids > 0) {
        conflict.depth = std::max(0.0, -found.distance);
        conflict.points_inside = found.inside;
      }
      if (found.source == ConflictDistance::kNone) continue;
      conflict.least_distance = found.distance;
      conflict.nearest_pose = found.pose;
      conflict.nearest_source = found.source;
      conflict.nearest_point = found.xyz;
      if (found.body) conflict.body = found.body;
      conflict.encroachment = reader_.header().radius - found.distance;
      conflict.encroachment_is = bound_of(conflict);
    }
  }

  /// Sets the greatest depth of each conflict where the result has depths, unless exact ones of
  /// solids are known. Of equally deep points the first row decides, which has the least source.
  void add_depths(std::span<const std::uint32_t> conflict_of_row) {
    const ResultHeader& header = reader_.header();
    if (!header.depth || (header.model_solids > 0 && header.clearance > 0)) return;
    progress_.begin("depths", reader_.collisions(), "points");
    const auto is_near = [&](std::size_t row) {
      return !points_.kind.empty() && points_.kind[row] == CollidingPoints::kNear;
    };
    std::size_t row = 0;
    RowStream<Collisions> stream(reader_);
    for (Collisions rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      for (std::size_t i = 0; i < rows.size(); ++i, ++row) {
        while (is_near(row)) ++row;
        const std::uint32_t id = conflict_of_row[row];
        if (id == 0 || rows.depth_source[i] == Collisions::kNoPoint) continue;
        Conflict& conflict = out_.listed[id - 1];
        if (conflict.depth && rows.depth[i] <= *conflict.depth) continue;
        conflict.depth = rows.depth[i];
        conflict.depth_source = rows.depth_source[i];
      }
      progress_.advance(rows.size());
    }
    progress_.end();
  }

  /// Whether the encroachment is exact: of a solid, and of what is certainly inside one.
  Bound bound_of(const Conflict& conflict) const {
    const bool is_of_bodies = !reader_.header().bodies.empty();
    const bool is_solid = !is_of_bodies ? reader_.header().model_solids > 0
                                        : !options_.bodies.empty() && conflict.body &&
                                              options_.bodies[*conflict.body].model.is_solid();
    return is_solid || *conflict.least_distance < 0 ? Bound::kExact : Bound::kAtLeast;
  }

  void count_colliding(std::span<const std::uint32_t> conflict_of_row) {
    for (Conflict& conflict : out_.listed) conflict.colliding = conflict.points;
    for (std::size_t row = 0; row < points_.kind.size(); ++row) {
      const std::uint32_t id = conflict_of_row[row];
      if (id != 0 && points_.kind[row] == CollidingPoints::kNear) --out_.listed[id - 1].colliding;
    }
  }

  /// Counts the points of each class, and finds the class that most points of each conflict have.
  void add_classes(std::span<const std::uint32_t> conflict_of_row) {
    count_classes(points_.point_class, out_.classes);
    std::vector<std::uint64_t> keys;  // of each point its conflict and, in the low byte, its class
    for (std::size_t row = 0; row < points_.point_class.size(); ++row) {
      const std::uint64_t id = conflict_of_row[row];
      if (id != 0) keys.push_back(id << 8 | points_.point_class[row]);
    }
    tbb::parallel_sort(keys);
    for (auto first = keys.begin(); first != keys.end();) {
      const auto end = std::upper_bound(first, keys.end(), *first);
      const auto count = static_cast<std::uint64_t>(end - first);
      Conflict& conflict = out_.listed[(*first >> 8) - 1];
      if (count > conflict.main_class_points.value_or(0)) {
        conflict.main_class = static_cast<std::uint32_t>(*first & 0xff);
        conflict.main_class_points = count;
      }
      first = end;
    }
  }

  void complete(Conflict& conflict) const {
    conflict.chainage_from += options_.chainage_start;
    conflict.chainage_to = chainage_[end_of(conflict.last_pose)] + options_.chainage_start;
    conflict.station_from = station_of(conflict.first_pose);
    conflict.station_to = station_of(end_of(conflict.last_pose));
    const std::uint32_t at = conflict.nearest_pose.value_or(conflict.first_pose);
    const Pose* pose = pose_of(conflict.body, at);
    if (pose == nullptr) return;
    const Vec3 place = conflict.nearest_point.value_or(first_places_[conflict.id - 1]);
    const Vec3 there = ahead_left_up(place, *pose, options_.forward, options_.up);
    if (!std::isfinite(there.x) || !std::isfinite(there.y) || !std::isfinite(there.z)) return;
    conflict.lateral = there.y;
    conflict.height = there.z;
    const double ahead = ahead_along_path(place, at);
    if (!std::isfinite(ahead)) return;
    conflict.obstacle_chainage = chainage_[at] + ahead + options_.chainage_start;
  }

  /// How far a place lies ahead of a pose of the path, in the direction in which the path
  /// continues. Measured from the path's pose and not from the body's, whose own x axis may begin
  /// anywhere.
  double ahead_along_path(const Vec3& place, std::uint32_t at) const {
    const Pose& pose = poses_[at];
    const double ahead = ahead_left_up(place, pose, options_.forward, options_.up).x;
    const std::optional<Vec3> travel = travel_direction(poses_, at);
    if (!travel) return ahead;
    const double along = cosine(direction_ahead(pose, options_.forward), *travel);
    if (along >= kAlong) return ahead;
    if (along <= -kAlong) return -ahead;  // the vehicle goes backwards
    return dot(place - pose.position(), *travel);
  }

  /// The cosine of the angle between a vector and a unit vector.
  static double cosine(const Vec3& a, const Vec3& unit) { return dot(a, unit) / length(a); }

  /// The pose of the conflict's body at a pose of the path; null where the body has no pose there
  /// or is not known. Without bodies, the path's own pose.
  const Pose* pose_of(std::optional<std::uint32_t> body, std::uint32_t at) const {
    if (options_.bodies.empty()) return &poses_[at];
    return body ? pose_at(options_.bodies[*body], at) : nullptr;
  }

  /// Finds the shifts that free each conflict from all of its points.
  void add_shifts(PointsOfConflicts points) {
    if (!out_.knows_shifts) return;
    const Model& model = options_.model != nullptr ? *options_.model : kNoModel;
    const std::vector<MovingBody> bodies =
        moving_bodies(model, poses_, options_.bodies, reader_.header().floor);
    const double most = kMostOwnShift / metre_;
    progress_.begin("shifts", out_.listed.size(), "conflicts");
    std::vector<PointsToFree> sets;
    std::uint64_t pairs = 0;
    for (const Conflict& conflict : out_.listed) {
      sets.push_back({points.of(conflict.id), conflict.first_pose, end_of(conflict.last_pose)});
      const std::uint64_t poses = conflict.last_pose - conflict.first_pose + std::uint64_t{1};
      pairs += sets.back().points.size() * poses;
    }
    const LeastShift shifts(bodies, poses_, direction_to_left(options_.forward, options_.up),
                            reader_.header().radius, reader_.header().between_poses, pairs,
                            options_.threads);
    const std::vector<SideShifts> free =
        shifts.least(reader_.header().quantisation, sets, most, progress_);
    for (std::size_t i = 0; i < free.size(); ++i) {
      Conflict& conflict = out_.listed[i];
      if (conflict.colliding == 0) continue;
      // The points collide as it is, so a shift of 0 says only that the steps between poses, at
      // which shifts are tried, missed it.
      const auto known = [](std::optional<double> shift) {
        return shift && *shift > 0 ? shift : std::nullopt;
      };
      conflict.own_shift_left = known(free[i].left);
      conflict.own_shift_right = known(free[i].right);
    }
    progress_.end();
  }

  /// The colliding points of each conflict, which have to be freed, in no particular order. Near
  /// points need no shift.
  PointsOfConflicts points_to_free(std::span<const std::uint32_t> conflict_of_row) const {
    PointsOfConflicts out;
    if (!out_.knows_shifts) return out;
    const auto conflict_of = [&](const GroupedPoint& p) {
      const bool is_near = !points_.kind.empty() && points_.kind[p.row] == CollidingPoints::kNear;
      return is_near ? 0 : conflict_of_row[p.row];
    };
    // Visits the points of each cell that belong to one conflict and follow one another, in no
    // particular order.
    const auto for_runs = [&](auto visit) {
      using Range = tbb::blocked_range<std::uint32_t>;
      for_each_parallel(Range(0, grid_->cells(), 64), [&](const Range& cells) {
        for (std::uint32_t cell = cells.begin(); cell != cells.end(); ++cell) {
          if (PointGroups::is_small(groups_.of_cell[cell])) continue;
          const std::span<const GroupedPoint> all = std::as_const(*grid_).points(cell);
          for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
            const std::uint32_t id = conflict_of(all[begin]);
            while (end < all.size() && conflict_of(all[end]) == id) ++end;
            if (id != 0) visit(id - 1, all.subspan(begin, end - begin));
          }
        }
      });
    };
    std::vector<std::atomic<std::size_t>> next(out_.listed.size());
    for_runs([&](std::uint32_t i, std::span<const GroupedPoint> run) { next[i] += run.size(); });
    out.first.push_back(0);
    for (std::atomic<std::size_t>& count : next) {
      out.first.push_back(out.first.back() + count.exchange(out.first.back()));
    }
    out.points.resize(out.first.back());
    for_runs([&](std::uint32_t i, std::span<const GroupedPoint> run) {
      std::size_t at = next[i].fetch_add(run.size());
      for (const GroupedPoint& p : run) std::ranges::copy(p.q, out.points[at++].q);
    });
    return out;
  }

  const ResultReader& reader_;
  const std::vector<Pose>& poses_;
  const ConflictOptions& options_;
  const std::vector<Box> boxes_;
  const double metre_;  ///< length of the environment's unit
  Progress& progress_;
  const ConflictMemory memory_;
  const std::vector<double> chainage_;
  CollidingPoints points_;
  std::optional<CellGrid> grid_;
  PointGroups groups_;
  /// For each conflict, the place of the first point that is touched.
  std::vector<Vec3> first_places_;
  Conflicts out_;
};

}  // namespace

Conflicts find_conflicts(const Result& result, const std::vector<Pose>& poses,
                         const ConflictOptions& options, std::vector<std::uint32_t>* conflict_of,
                         std::vector<std::uint32_t>* conflict_of_near) {
  check_conflicts(result.reader(), poses, options);
  CallbackProgress progress(options.progress, options.stop);
  return in_threads(options.threads, [&] {
    return ConflictSearch(result, poses, options, progress).run(conflict_of, conflict_of_near);
  });
}

}  // namespace clearway
