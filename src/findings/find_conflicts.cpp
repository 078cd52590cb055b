#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
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
#include "findings/across_body.hpp"
#include "findings/certain_points.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/colliding_spacing.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/least_places.hpp"
#include "findings/point_blocks.hpp"
#include "findings/row_pieces.hpp"
#include "findings/shift/least_shift.hpp"
#include "findings/touched_first.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// Sums over a set of points, in integers, so that they are the same in any order.
struct Tally {
  static constexpr auto kMost = std::numeric_limits<std::int32_t>::max();
  static constexpr auto kLeast = std::numeric_limits<std::int32_t>::min();
  static constexpr auto kNoPose = std::numeric_limits<std::uint32_t>::max();
  static constexpr auto kNoSource = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t points = 0;
  std::uint64_t source = kNoSource;  ///< the smallest one
  std::uint32_t first_pose = kNoPose, latest_first_pose = 0, last_pose = 0;
  /// The body that touches the point of `first_touched`, which is the smallest source of those that
  /// are touched at the first pose.
  std::uint32_t first_body = 0;
  std::uint64_t first_touched = kNoSource;
  QuantumBox box{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};
  std::array<__int128, 3> sum{};

  void add(const Tally& other) {
    points += other.points;
    source = std::min(source, other.source);
    if (std::tie(other.first_pose, other.first_touched) < std::tie(first_pose, first_touched)) {
      first_pose = other.first_pose;
      first_touched = other.first_touched;
      first_body = other.first_body;
    }
    latest_first_pose = std::max(latest_first_pose, other.latest_first_pose);
    last_pose = std::max(last_pose, other.last_pose);
    box = box.united(other.box);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += other.sum[k];
  }
};

/// Tallies consecutive points that have the same number, and hands each such run on at its end, so
/// that locks are taken rarely.
class RunOfPoints {
 public:
  RunOfPoints(std::vector<Tally>& into, SharedLocks& locks) : into_(into), locks_(locks) {}
  RunOfPoints(const RunOfPoints&) = delete;
  RunOfPoints& operator=(const RunOfPoints&) = delete;
  ~RunOfPoints() { hand_on(); }

  void add(std::size_t number, const Tally& point) {
    if (number != number_) hand_on();
    number_ = number;
    tally_.add(point);
  }

 private:
  void hand_on() {
    if (tally_.points > 0) locks_.hold(number_, [&] { into_[number_].add(tally_); });
    tally_ = {};
  }

  std::vector<Tally>& into_;
  SharedLocks& locks_;
  std::size_t number_ = 0;
  Tally tally_;
};

/// The parts that groups are cut into. The parts of a group are consecutive, one for each stretch
/// of the path from the group's first to its last pose, and may be empty.
struct GroupParts {
  std::uint64_t first;    ///< the number of the group's first part
  std::uint32_t stretch;  ///< the stretch of that part
  bool is_cut;
};

/// The points of a conflict that are touched at its first pose, by the body that touches the first
/// of them.
struct TouchedFirst {
  std::uint64_t source;        ///< of the first of them
  const Pose* pose = nullptr;  ///< pose of the body there; null where it is not known
  Vec3 place{};                ///< place of the first of them
  /// The box around the points, with the axes ahead, to the left and up of the pose.
  Box seen{{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}};

  /// Whether all sides of `seen` are finite; false where the pose cannot be inverted.
  bool is_finite() const {
    const Vec3 size = seen.size();
    return std::isfinite(size.x) && std::isfinite(size.y) && std::isfinite(size.z);
  }

 private:
  static constexpr double kMost = std::numeric_limits<double>::infinity();
};

/// What find_conflicts() takes of the memory budget. The checks throw ResourceError with an amount
/// that is enough.
class ConflictMemory {
 public:
  ConflictMemory(std::uint64_t allowed, std::uint64_t points, std::uint64_t poses)
      : allowed_(allowed),
        points_(points),
        held_(kProgram + points * kBytesOfPoint +
              poses * (sizeof(Pose) + sizeof(double) + sizeof(std::uint32_t))) {}

  /// Called before the points are read.
  void check_points() const {
    if (points_ > kMostPoints) {
      throw UsageError(format_count(points_) + " colliding points; conflicts are made of up to " +
                       format_count(kMostPoints));
    }
    check(held_, held_ + points_ * kBytesOfPointAtWork);
  }
  /// How many points may be at work at the same time.
  GroupingLimit at_work() const {
    return {(allowed_ - held_) / kBytesOfPointAtWork, [this](std::uint64_t points) {
              const std::uint64_t needed = held_ + points * kBytesOfPointAtWork;
              check(needed, needed);
            }};
  }
  /// Called before groups are summed up: checks the memory of so many groups and parts.
  void check_parts(std::uint64_t parts) const {
    if (parts > kMostPoints) {
      throw UsageError(format_count(parts) + " conflicts; expected fewer than " +
                       format_count(kMostPoints));
    }
    const std::uint64_t needed = held_ + parts * kBytesOfPart;
    check(needed, needed);
  }

 private:
  void check(std::uint64_t needed, std::uint64_t enough) const {
    if (needed <= allowed_) return;
    throw ResourceError(format_size(allowed_) + " of memory is too little: the conflicts of " +
                            counted(points_, "point") + " need at least " + format_size(needed),
                        Remedy::kMoreMemory, static_cast<double>(enough));
  }

  static constexpr std::uint64_t kProgram = std::uint64_t{32} << 20;  // with the reader's buffers
  static constexpr std::uint64_t kMostPoints = 0xffff'fffe;
  /// Bytes of a point as long as conflicts are made: its integers, its group, and in turn the size
  /// of its group, its new place among the points of its conflict, and its part of their tree.
  static constexpr std::uint64_t kBytesOfPoint = sizeof(QuantumPoint) + 2 * sizeof(std::uint32_t);
  static_assert(PointBlocks::kBytesOfPoint <= sizeof(std::uint32_t));
  /// Bytes of a group or part, with its conflict, which counts twice because vectors grow to twice
  /// their size, its tree, and what finding its trims and shifts takes.
  static constexpr std::uint64_t kBytesOfPart =
      sizeof(Tally) + sizeof(TouchedFirst) + sizeof(AcrossBody) + 2 * sizeof(Conflict) +
      sizeof(PointBlocks) + PointBlocks::kBytesOfTree + sizeof(PointsToFree) + 128;

  const std::uint64_t allowed_, points_, held_;
};

/// Points of a result in ascending order of their source, with the conflict of each, 0 for none.
struct JoinedPoints {
  std::vector<std::uint64_t> source;
  std::span<const std::uint32_t> conflict_of;
  std::size_t first = 0;  ///< below it, no source is among those of later clearances
};

/// The nearest point of each conflict, by its id, and how many of its points are inside solids.
struct ConflictDistances {
  LeastPlaces least;
  std::vector<std::atomic<std::uint64_t>> inside;
};

/// Joins the clearances with the points.
void join_distances(const ResultReader& result, std::array<JoinedPoints, 2> points,
                    ConflictDistances& out, Progress& progress) {
  progress.begin("distances", result.clearances(), "points");
  RowStream<Clearances> stream(result);
  for (Clearances rows; stream.read(rows);) {
    throw_if_stopped(progress);
    for (JoinedPoints& of : points) {
      const std::span left = std::span(of.source).subspan(of.first);
      in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
        auto at = std::ranges::lower_bound(left, rows.source[first]);
        for (std::size_t i = first; i < end; ++i) {
          while (at != left.end() && *at < rows.source[i]) ++at;
          if (at == left.end()) return;
          if (*at != rows.source[i]) continue;
          const std::uint32_t conflict =
              of.conflict_of[static_cast<std::size_t>(&*at - of.source.data())];
          if (conflict == 0) continue;
          FoundPlace found{rows.source[i], rows.pose[i], rows.xyz[i], rows.distance[i]};
          if (!rows.body.empty()) found.body = rows.body[i];
          out.least.offer(conflict, found);
          if (found.distance < 0) out.inside[conflict].fetch_add(1, std::memory_order_relaxed);
        }
      });
      of.first += static_cast<std::size_t>(std::ranges::upper_bound(left, rows.source.back()) -
                                           left.begin());
    }
    progress.advance(rows.size());
  }
  progress.end();
}

/// One call of find_conflicts(), step by step. Rows are numbered through all colliding points and
/// then all near ones.
class ConflictSearch {
 public:
  inline static const Model kNoModel{};
  /// The cosine of 45 degrees: the model moves along its forward axis up to this angle.
  static constexpr double kAlong = 0.7071067811865476;

  ConflictSearch(const Result& result, const std::vector<Pose>& poses,
                 const ConflictOptions& options, Progress& progress)
      : reader_(result.reader()),
        header_(reader_.header()),
        poses_(poses),
        options_(options),
        bodies_(moving_bodies(options.model != nullptr ? *options.model : kNoModel, poses,
                              options.bodies, header_.floor)),
        boxes_(boxes_of(result, options)),
        metre_(metres_per_unit(header_)),
        progress_(progress),
        memory_(options.memory_bytes, reader_.collisions() + reader_.near(), poses.size()),
        chainage_(chainage_of(poses)) {}

  Conflicts run(std::vector<std::uint32_t>* conflict_of,
                std::vector<std::uint32_t>* conflict_of_near) {
    out_.path_length = chainage_.empty() ? 0 : chainage_.back();
    out_.colliding_points = reader_.collisions();
    out_.near_points = reader_.near();
    out_.knows_trims = !boxes_.empty();
    out_.knows_shifts =
        !options_.bodies.empty() || (options_.model != nullptr && !options_.model->empty());
    if (conflict_of != nullptr) conflict_of->clear();
    if (conflict_of_near != nullptr) conflict_of_near->clear();
    if (out_.colliding_points + out_.near_points == 0) {
      choose_grouping();
      return std::move(out_);
    }
    memory_.check_points();
    read();
    choose_grouping();
    group();
    list();
    look_at_rows();
    if (out_.knows_shifts || out_.knows_trims) look_at_places();
    quanta_ = {};
    add_distances();
    for (Conflict& conflict : out_.listed) complete(conflict);
    rank(out_);
    const auto near = of_row_.begin() + static_cast<std::ptrdiff_t>(out_.colliding_points);
    if (conflict_of_near != nullptr) conflict_of_near->assign(near, of_row_.end());
    of_row_.erase(near, of_row_.end());
    if (conflict_of != nullptr) *conflict_of = std::move(of_row_);
    return std::move(out_);
  }

 private:
  void read() {
    quanta_.resize(out_.colliding_points + out_.near_points);
    if (header_.budget) certain_.resize(quanta_.size());
    progress_.begin("read", quanta_.size(), "points");
    for_each_rows(reader_, [&](const auto& rows, std::size_t first) {
      throw_if_stopped(progress_);
      requantize(reader_, rows, std::span(quanta_).subspan(first));
      count_classes(rows.point_class, out_.classes);
      if constexpr (requires { rows.certain; }) {
        for (std::size_t i = 0; i < rows.certain.size(); ++i) {
          certain_[first + i] = rows.certain[i] != 0;
        }
      }
      progress_.advance(rows.size());
    });
    progress_.end();
  }

  static double metres_per_unit(const ResultHeader& header) {
    const double metre = metres_of(unit_of(header));
    return metre > 0 ? metre : 1;
  }

  /// Chooses the gap and the least number of points, where the options leave them open.
  void choose_grouping() {
    out_.spacing = colliding_spacing(std::span(quanta_).first(out_.colliding_points),
                                     header_.quantisation, progress_);
    const Grouping usual = usual_grouping(out_.colliding_points > 0, out_.spacing, metre_);
    out_.gap = options_.gap > 0 ? options_.gap : usual.gap;
    out_.min_points = options_.min_points > 0 ? options_.min_points : usual.min_points;
  }

  void group() {
    const GroupingLimit limit = memory_.at_work();
    if (header_.budget) {
      certain_ = in_certain_groups(quanta_, header_.quantisation, header_.gap, progress_, limit,
                                   &certain_);
    }
    groups_ = group_points(quanta_, Neighbourhood(header_.quantisation, out_.gap), out_.min_points,
                           progress_, limit);
    out_.groups = groups_.count + groups_.small_groups;
    out_.small_groups = groups_.small_groups;
    out_.small_points = groups_.small_points;
  }

  static constexpr std::size_t kNotTallied = ~std::size_t{0};

  /// Tallies points in one pass over the rows. number_of(row, first pose): the number of the tally
  /// that a row counts for, or kNotTallied.
  template <typename NumberOf>
  std::vector<Tally> tally(std::size_t count, const NumberOf& number_of) const {
    std::vector<Tally> tallies(count);
    SharedLocks locks;
    for_each_rows(reader_, [&](const auto& rows, std::size_t first_row) {
      throw_if_stopped(progress_);
      in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
        RunOfPoints run(tallies, locks);
        for (std::size_t i = first; i < end; ++i) {
          const std::size_t row = first_row + i, number = number_of(row, rows.first_pose[i]);
          if (number == kNotTallied) continue;
          const auto& [x, y, z] = quanta_[row].q;
          run.add(number, {.points = 1,
                           .source = rows.source[i],
                           .first_pose = rows.first_pose[i],
                           .latest_first_pose = rows.first_pose[i],
                           .last_pose = last_pose_of(rows, i),
                           .first_body = rows.body.empty() ? 0 : rows.body[i],
                           .first_touched = rows.source[i],
                           .box = {{x, y, z}, {x, y, z}},
                           .sum = {x, y, z}});
        }
      });
    });
    return tallies;
  }

  /// Lists the conflicts.
  void list() {
    memory_.check_parts(out_.groups);
    const std::vector<Tally> groups = tally(out_.groups, [&](std::size_t row, std::uint32_t) {
      const std::uint32_t group = groups_.of_point[row];
      return PointGroups::is_small(group) ? groups_.count + (group & ~PointGroups::kSmall) : group;
    });
    const auto listed = std::span(groups).first(groups_.count);
    list_small(std::span(groups).subspan(groups_.count));
    note_longest(listed);
    const PathStretches stretches(chainage_, options_.split);
    const std::vector<GroupParts> parts = cut(listed, stretches);
    memory_.check_parts(out_.groups + parts.back().first);
    // From here on, the number of a row's part and one more, and 0 for rows of small groups.
    of_row_ = std::move(groups_.of_point);
    const std::vector<Tally> tallies =
        tally(parts.back().first, [&](std::size_t row, std::uint32_t first_pose) {
          const std::uint32_t group = std::exchange(of_row_[row], 0);
          if (PointGroups::is_small(group)) return kNotTallied;
          std::uint64_t part = parts[group].first;
          if (parts[group].is_cut) part += stretches[first_pose] - parts[group].stretch;
          of_row_[row] = static_cast<std::uint32_t>(part + 1);
          return static_cast<std::size_t>(part);
        });
    for (std::size_t group = 0; group < listed.size(); ++group) {
      for (std::uint64_t part = parts[group].first; part < parts[group + 1].first; ++part) {
        if (tallies[part].points > 0) add_conflict(part, tallies[part], listed[group].source);
      }
    }
    number(tallies);
  }

  void list_small(std::span<const Tally> groups) {
    for (const Tally& tally : groups) {
      out_.small.push_back({tally.points, tally.source,
                            position_box(header_.quantisation, tally.box), tally.first_pose,
                            tally.last_pose, chainage_[tally.first_pose] + options_.chainage_start,
                            chainage_[end_of(tally.last_pose)] + options_.chainage_start,
                            station_of(tally.first_pose), station_of(end_of(tally.last_pose))});
    }
    std::ranges::sort(out_.small, {}, [](const SmallGroup& group) {
      return std::pair(group.chainage_from, group.source);
    });
  }

  /// The pose at which the contact of a last pose ends, which between poses is the end of its way.
  std::uint32_t end_of(std::uint32_t last_pose) const {
    const bool way = header_.between_poses && last_pose + 1 < chainage_.size();
    return last_pose + (way ? 1 : 0);
  }

  std::optional<double> station_of(std::uint32_t pose) const {
    if (options_.station.empty()) return std::nullopt;
    return options_.station[pose];
  }

  double length_of(const Tally& tally) const {
    return chainage_[tally.latest_first_pose] - chainage_[tally.first_pose];
  }

  void note_longest(std::span<const Tally> groups) {
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
    const double low = ground_height(unit_of(header_));
    double from = std::numeric_limits<double>::infinity(), to = -from;
    std::uint64_t in_lowest = 0, below = 0, left = 0, right = 0;
    bool is_inside = true;
    for_each_rows(reader_, [&](const auto& rows, std::size_t first_row) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (groups_.of_point[first_row + i] != group) continue;
        const auto body = body_of(rows, i);
        const Pose* pose = pose_of(body, rows.first_pose[i]);
        if (pose == nullptr) continue;
        const Box box = turned(boxes_[body.value_or(0)], options_.forward, options_.up);
        const Vec3 there = ahead_left_up(rows.xyz[i], *pose, options_.forward, options_.up);
        const double height = there.z - box.lo.z;
        from = std::min(from, height);
        to = std::max(to, height);
        in_lowest += height <= low ? 1 : 0;
        below += height < 0 ? 1 : 0;
        ++(there.y > box.centre().y ? left : right);
        is_inside = is_inside && there.y > box.lo.y && there.y < box.hi.y && there.z > box.lo.z &&
                    there.z < box.hi.z;
      }
    });
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

  /// The body that touches a point at its first pose.
  template <typename Rows>
  static std::optional<std::uint32_t> body_of(const Rows& rows, std::size_t i) {
    return rows.body.empty() ? std::nullopt : std::optional(rows.body[i]);
  }

  /// The parts of each group, and at the end the number of all parts.
  std::vector<GroupParts> cut(std::span<const Tally> groups, const PathStretches& stretches) const {
    std::vector<GroupParts> out;
    std::uint64_t next = 0;
    for (const Tally& group : groups) {
      const bool is_cut = options_.split > 0 && length_of(group) > options_.split;
      const std::uint32_t stretch = stretches[group.first_pose];
      out.push_back({next, stretch, is_cut});
      next += is_cut ? stretches[group.latest_first_pose] - stretch + 1 : 1;
    }
    out.push_back({next, 0, false});
    return out;
  }

  /// Adds the conflict of a part, whose id is for now the part's number.
  void add_conflict(std::uint64_t part, const Tally& tally, std::uint64_t group) {
    Conflict& conflict = out_.listed.emplace_back();
    conflict.id = static_cast<std::uint32_t>(part);
    conflict.points = conflict.colliding = tally.points;
    conflict.source = tally.source;
    conflict.group = group;
    conflict.box = position_box(header_.quantisation, tally.box);
    conflict.centroid = centroid_of(tally, header_.quantisation);
    conflict.first_pose = tally.first_pose;
    conflict.last_pose = tally.last_pose;
    conflict.chainage_from = chainage_[tally.first_pose];
    if (header_.has_first_bodies()) conflict.body = conflict.first_body = tally.first_body;
    if (header_.budget) conflict.certain = false;
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

  /// Gives the conflicts their ids, and the rows those of their conflicts.
  void number(std::span<const Tally> tallies) {
    std::ranges::sort(out_.listed, {}, [](const Conflict& conflict) {
      return std::pair(conflict.chainage_from, conflict.source);
    });
    std::vector<std::uint32_t> id_of(tallies.size() + 1);
    for (Conflict& conflict : out_.listed) {
      const Tally& tally = tallies[conflict.id];
      touched_.push_back({tally.first_touched, pose_of(conflict.body, conflict.first_pose)});
      id_of[conflict.id + 1] = static_cast<std::uint32_t>(touched_.size());
      conflict.id = id_of[conflict.id + 1];
    }
    for (std::uint32_t& part : of_row_) part = id_of[part];
  }

  /// The boxes of the model or of each body; empty where they are not known. The bodies of a
  /// vehicle have frames of their own, so no single box says on which side a conflict is.
  static std::vector<Box> boxes_of(const Result& result, const ConflictOptions& options) {
    std::vector<Box> boxes;
    for (const Body& body : options.bodies) boxes.push_back(box_of(body.model.vertices));
    if (result.bodies().empty()) boxes.push_back(result.model_box());
    return boxes;
  }

  /// Finds in one pass over the rows how many points of each conflict collide, which are touched
  /// first, the greatest depths, which conflicts are certain, and the classes.
  void look_at_rows() {
    SharedLocks locks;
    std::map<std::uint64_t, std::uint64_t> classes;  // points by conflict and class
    for_each_rows(reader_, [&](const auto& rows, std::size_t first) {
      throw_if_stopped(progress_);
      const std::span<const std::uint32_t> of_row = std::span(of_row_).subspan(first, rows.size());
      add_touched(rows, of_row, locks);
      add_classes(rows.point_class, of_row, classes);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (of_row[i] == 0) continue;
        Conflict& conflict = out_.listed[of_row[i] - 1];
        if (header_.budget && certain_[first + i]) conflict.certain = true;
        if constexpr (requires { rows.depth; }) {
          if (has_depths()) add_depth(rows.depth[i], rows.depth_source[i], conflict);
        } else {
          --conflict.colliding;
        }
      }
    });
    for (const auto& [key, count] : classes) {
      Conflict& conflict = out_.listed[(key >> 8) - 1];
      if (count <= conflict.main_class_points.value_or(0)) continue;
      conflict.main_class = static_cast<std::uint32_t>(key & 0xff);
      conflict.main_class_points = count;
    }
    for (Conflict& conflict : out_.listed) {
      const TouchedFirst& first = touched_[conflict.id - 1];
      if (boxes_.empty() || first.pose == nullptr || !first.is_finite()) continue;
      const Box& box = boxes_[conflict.body.value_or(0)];
      conflict.first_touch = side_of(first.seen, box, options_.forward, options_.up);
    }
  }

  template <typename Rows>
  void add_touched(const Rows& rows, std::span<const std::uint32_t> of_row, SharedLocks& locks) {
    in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (of_row[i] == 0) continue;
        const Conflict& conflict = out_.listed[of_row[i] - 1];
        if (rows.first_pose[i] != conflict.first_pose) continue;
        if (body_of(rows, i) != conflict.first_body) continue;
        TouchedFirst& touched = touched_[of_row[i] - 1];
        const Vec3 there = touched.pose == nullptr ? Vec3{}
                                                   : ahead_left_up(rows.xyz[i], *touched.pose,
                                                                   options_.forward, options_.up);
        locks.hold(of_row[i], [&] {
          if (rows.source[i] == touched.source) touched.place = rows.xyz[i];
          touched.seen.extend(there);
        });
      }
    });
  }

  static void add_classes(std::span<const std::uint8_t> point_class,
                          std::span<const std::uint32_t> of_row,
                          std::map<std::uint64_t, std::uint64_t>& classes) {
    auto known = classes.end();
    for (std::size_t i = 0; i < point_class.size(); ++i) {
      if (of_row[i] == 0) continue;
      const std::uint64_t key = std::uint64_t{of_row[i]} << 8 | point_class[i];
      if (known == classes.end() || known->first != key) known = classes.try_emplace(key).first;
      ++known->second;
    }
  }

  /// Whether depths are taken from the rows, because exact ones of solids are not known.
  bool has_depths() const {
    return header_.depth && !(header_.model_solids > 0 && header_.clearance > 0);
  }

  /// Takes the depth of a point if it is the greatest so far. The first of equally deep points
  /// counts, which has the least source.
  static void add_depth(double depth, std::uint64_t source, Conflict& conflict) {
    if (source == Collisions::kNoPoint || (conflict.depth && depth <= *conflict.depth)) return;
    conflict.depth = depth;
    conflict.depth_source = source;
  }

  /// Finds what depends on where all points of each conflict lie: shifts and trims.
  void look_at_places() {
    const std::vector<std::size_t> first = order_by_conflict();
    std::vector<std::optional<PointBlocks>> trees(out_.listed.size());
    const auto make_trees = [&](std::uint64_t Conflict::*points) {
      for_each_parallel(trees.size(), [&](std::size_t i) {
        const std::span of = std::span(quanta_).subspan(first[i], out_.listed[i].*points);
        trees[i].reset();
        if (!of.empty() && !progress_.stop_requested()) trees[i].emplace(header_.quantisation, of);
      });
      throw_if_stopped(progress_);
    };
    make_trees(&Conflict::colliding);
    if (out_.knows_shifts) add_shifts(trees);
    if (out_.near_points > 0) make_trees(&Conflict::points);
    if (out_.knows_trims) add_trims(trees);
  }

  /// Sorts the points by their conflicts; those of a conflict stay in the order of their rows, so
  /// that near ones are the last. Returns where the points of each conflict begin.
  std::vector<std::size_t> order_by_conflict() {
    std::vector<std::size_t> first{0};
    for (const Conflict& conflict : out_.listed) first.push_back(first.back() + conflict.points);
    std::vector<std::size_t> next = first;
    std::vector<std::uint32_t> place;
    place.reserve(of_row_.size());
    for (const std::uint32_t id : of_row_) {
      place.push_back(static_cast<std::uint32_t>(next[id == 0 ? first.size() - 1 : id - 1]++));
    }
    for (std::uint32_t i = 0; i < place.size(); ++i) {
      while (place[i] != i) {
        const std::uint32_t to = place[i];
        std::swap(quanta_[i], quanta_[to]);
        std::swap(place[i], place[to]);
      }
    }
    return first;
  }

  /// Finds the shifts that free each conflict from all of its colliding points.
  void add_shifts(std::span<const std::optional<PointBlocks>> trees) {
    progress_.begin("shifts", out_.listed.size(), "conflicts");
    std::vector<PointsToFree> sets;
    std::uint64_t pairs = 0;
    for (const Conflict& conflict : out_.listed) {
      const auto& tree = trees[conflict.id - 1];
      sets.push_back({tree ? &*tree : nullptr, conflict.first_pose, end_of(conflict.last_pose)});
      const std::uint64_t poses = conflict.last_pose - conflict.first_pose + std::uint64_t{1};
      pairs += conflict.colliding * poses;
    }
    const ShiftQuestion asked{.bodies = bodies_,
                              .path = poses_,
                              .left = direction_to_left(options_.forward, options_.up),
                              .radius = header_.radius,
                              .ways = header_.between_poses,
                              .pairs = pairs,
                              .most = kMostOwnShift / metre_,
                              .threads = options_.threads};
    const std::vector<SideShifts> free = least_shifts(asked, sets, progress_);
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

  /// Sets the trims and the sides.
  void add_trims(std::span<const std::optional<PointBlocks>> trees) {
    const BodiesAcross how{
        bodies_, boxes_, {options_.forward, options_.up}, header_.radius, header_.between_poses};
    std::vector<PointsBeside> points;
    for (const Conflict& conflict : out_.listed) {
      points.push_back({*trees[conflict.id - 1], conflict.first_body.value_or(0),
                        conflict.first_pose, end_of(conflict.last_pose)});
    }
    const std::vector<AcrossBody> found = find_across_bodies(how, points, progress_);
    for (std::size_t i = 0; i < found.size(); ++i) {
      set_trims(found[i], how.box_from_floor(points[i].body), how.whole_box(points[i].body),
                header_.radius, out_.listed[i]);
    }
  }

  void add_distances() {
    if (!(header_.clearance > 0)) return;
    ConflictDistances distances{LeastPlaces(out_.listed.size() + 1),
                                std::vector<std::atomic<std::uint64_t>>(out_.listed.size() + 1)};
    const std::span<const std::uint32_t> of_row = of_row_;
    join_distances(reader_,
                   {{{reader_.column(&Collisions::source), of_row.first(out_.colliding_points)},
                     {reader_.column(&Nearby::source), of_row.subspan(out_.colliding_points)}}},
                   distances, progress_);
    for (Conflict& conflict : out_.listed) {
      const std::optional<FoundPlace>& found = distances.least[conflict.id];
      if (header_.model_solids > 0) {
        conflict.depth = found ? std::max(0.0, -found->distance) : 0.0;
        conflict.points_inside = distances.inside[conflict.id];
      }
      if (!found) continue;
      conflict.least_distance = found->distance;
      conflict.nearest_pose = found->pose;
      conflict.nearest_source = found->source;
      conflict.nearest_point = found->xyz;
      if (!header_.bodies.empty()) conflict.body = found->body;
      conflict.encroachment = header_.radius - found->distance;
      conflict.encroachment_is = bound_of(conflict);
    }
  }

  /// Whether the encroachment is exact: of a solid, and of what is certainly inside one.
  Bound bound_of(const Conflict& conflict) const {
    const bool is_of_bodies = !header_.bodies.empty();
    const bool is_solid = !is_of_bodies ? header_.model_solids > 0
                                        : !options_.bodies.empty() && conflict.body &&
                                              options_.bodies[*conflict.body].model.is_solid();
    return is_solid || *conflict.least_distance < 0 ? Bound::kExact : Bound::kAtLeast;
  }

  void complete(Conflict& conflict) const {
    conflict.chainage_from += options_.chainage_start;
    conflict.chainage_to = chainage_[end_of(conflict.last_pose)] + options_.chainage_start;
    conflict.station_from = station_of(conflict.first_pose);
    conflict.station_to = station_of(end_of(conflict.last_pose));
    const std::uint32_t at = conflict.nearest_pose.value_or(conflict.first_pose);
    const Pose* pose = pose_of(conflict.body, at);
    if (pose == nullptr) return;
    const Vec3 place = conflict.nearest_point.value_or(touched_[conflict.id - 1].place);
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

  const ResultReader& reader_;
  const ResultHeader& header_;
  const std::vector<Pose>& poses_;
  const ConflictOptions& options_;
  const std::vector<MovingBody> bodies_;
  const std::vector<Box> boxes_;
  const double metre_;  ///< length of the environment's unit
  Progress& progress_;
  const ConflictMemory memory_;
  const std::vector<double> chainage_;
  std::vector<QuantumPoint> quanta_;  ///< of each row; at the end by conflict
  /// With an error budget, whether each row is certain, and after group() whether it is one of a
  /// certain group
  std::vector<bool> certain_;
  PointGroups groups_;
  std::vector<std::uint32_t> of_row_;  ///< the conflict of each row, 0 for none
  std::vector<TouchedFirst> touched_;  ///< of each conflict
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
