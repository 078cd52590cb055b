#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "clearway/conflicts.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/body_pose.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/callback_progress.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/colliding_points.hpp"
#include "findings/conflict_memory.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/join_cells.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/least_distances.hpp"
#include "findings/path_stretches.hpp"
#include "findings/side.hpp"
#include "findings/tally_points.hpp"
#include "io/result/result_rows.hpp"
#include "io/system/thread_limit.hpp"

namespace clearway {
namespace {

/// The work on one result, step by step.
class ConflictSearch {
 public:
  ConflictSearch(const Result& result, const std::vector<Pose>& poses,
                 const ConflictOptions& options, Progress& progress)
      : reader_(result.reader()),
        poses_(poses),
        options_(options),
        boxes_(boxes_of(result, options)),
        progress_(progress),
        memory_(options.memory_bytes, reader_.collisions(), poses.size()),
        chainage_(chainage_of(poses)) {}

  Conflicts run(std::vector<std::uint32_t>* conflict_of) {
    out_.path_length = chainage_.empty() ? 0 : chainage_.back();
    out_.colliding_points = reader_.collisions();
    if (conflict_of != nullptr) conflict_of->clear();
    if (out_.colliding_points == 0) return std::move(out_);
    memory_.check_points();
    points_ = read_colliding_points(reader_, progress_);
    group();
    std::vector<std::uint32_t> part_of_row = list();
    if (conflict_of != nullptr) *conflict_of = std::move(part_of_row);
    return std::move(out_);
  }

 private:
  void group() {
    const Neighbourhood neighbourhood(reader_.header().quantisation, options_.gap);
    grid_.emplace(points_.quanta, neighbourhood,
                  [this](std::uint64_t cells) { memory_.check_cells(cells); });
    points_.quanta = {};
    UnionFind sets(grid_->cells());
    join_cells(*grid_, neighbourhood, sets, progress_);
    groups_ = number_groups(*grid_, sets, options_.min_points);
    out_.groups = groups_.count + groups_.small_groups;
    out_.small_groups = groups_.small_groups;
    out_.small_points = groups_.small_points;
  }

  /// Returns the conflict of each row.
  std::vector<std::uint32_t> list() {
    memory_.check_parts(grid_->cells(), groups_.count);
    const std::vector<Tally> groups = tally_groups(*grid_, groups_, points_.first_pose, progress_);
    note_longest(groups);
    const PathStretches stretches(chainage_, options_.split);
    const GroupParts parts = cut(groups, stretches);
    memory_.check_parts(grid_->cells(), groups_.count + parts.count());
    std::vector<std::uint32_t> part_of_row(points_.source.size());
    const std::vector<Tally> tallies =
        tally_parts(*grid_, groups_, parts, stretches, points_.first_pose, part_of_row, progress_);
    grid_.reset();
    make_conflicts(groups, parts, tallies);
    number(part_of_row, tallies.size());
    if (!reader_.header().bodies.empty()) add_first_bodies(part_of_row);
    add_distances(part_of_row);
    for (Conflict& conflict : out_.listed) complete(conflict);
    return part_of_row;
  }

  double length_of(const Tally& tally) const {
    return chainage_[tally.last_pose] - chainage_[tally.first_pose];
  }

  void note_longest(const std::vector<Tally>& groups) {
    for (const Tally& group : groups) {
      const double length = length_of(group);
      if (length < out_.longest_group) continue;
      if (length == out_.longest_group && group.points < out_.longest_group_points) continue;
      out_.longest_group = length;
      out_.longest_group_points = group.points;
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
      next += is_cut ? stretches[group.last_pose] - stretch + 1 : 1;
    }
    out.first.push_back(next);
    return out;
  }

  /// One for each part that is not empty, in the order of the parts; id: the part's number + 1.
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
        conflict.chainage_to = chainage_[tally.last_pose];
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
    for (std::size_t i = 0; i < out_.listed.size(); ++i) {
      id_of_part[out_.listed[i].id] = static_cast<std::uint32_t>(i + 1);
      out_.listed[i].id = static_cast<std::uint32_t>(i + 1);
    }
    for (std::uint32_t& part : part_of_row) part = id_of_part[part];
  }

  /// Of the model's points, or those of each body; none where they are not known. Of a vehicle's
  /// bodies each has its own frame, so that no one box says on which side a conflict is.
  static std::vector<Box> boxes_of(const Result& result, const ConflictOptions& options) {
    std::vector<Box> boxes;
    for (const Body& body : options.bodies) boxes.push_back(box_of(body.model));
    if (!result.bodies().empty()) return boxes;
    const std::optional<Box> box = options.model_box ? options.model_box : result.model_box();
    if (box) boxes.push_back(*box);
    return boxes;
  }

  void add_first_bodies(const std::vector<std::uint32_t>& conflict_of_row) {
    ResultRowStream stream(reader_);
    std::size_t row = 0;
    for (ResultRows rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      for (std::size_t i = 0; i < rows.size(); ++i, ++row) {
        if (conflict_of_row[row] == 0) continue;
        Conflict& conflict = out_.listed[conflict_of_row[row] - 1];
        if (!conflict.body && rows.first_pose[i] == conflict.first_pose) {
          conflict.body = rows.body[i];
        }
      }
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
    }
  }

  void complete(Conflict& conflict) const {
    conflict.chainage_from += options_.chainage_start;
    conflict.chainage_to += options_.chainage_start;
    const Pose* pose = pose_of(conflict);
    if (pose == nullptr) return;
    const Vec3 place = conflict.nearest_point.value_or(conflict.centroid);
    const Vec3 there = ahead_left_up(place, *pose, options_.forward, options_.up);
    if (std::isfinite(there.y) && std::isfinite(there.z)) {
      conflict.lateral = there.y;
      conflict.height = there.z;
    }
    if (boxes_.empty()) return;
    const Box& box = boxes_[conflict.body.value_or(0)];
    conflict.side = side_of(place, *pose, box, options_.forward, options_.up);
  }

  /// That it is seen from: where its body is, if bodies are given; null where that has none.
  const Pose* pose_of(const Conflict& conflict) const {
    const std::uint32_t at = conflict.nearest_pose.value_or(conflict.first_pose);
    if (options_.bodies.empty()) return &poses_[at];
    return conflict.body ? pose_at(options_.bodies[*conflict.body], at) : nullptr;
  }

  const ResultReader& reader_;
  const std::vector<Pose>& poses_;
  const ConflictOptions& options_;
  const std::vector<Box> boxes_;
  Progress& progress_;
  const ConflictMemory memory_;
  const std::vector<double> chainage_;
  CollidingPoints points_;
  std::optional<CellGrid> grid_;
  PointGroups groups_;
  Conflicts out_;
};

}  // namespace

Conflicts find_conflicts(const Result& result, const std::vector<Pose>& poses,
                         const ConflictOptions& options, std::vector<std::uint32_t>* conflict_of) {
  check_conflicts(result.reader(), poses, options);
  CallbackProgress progress(options.progress, options.stop);
  const int threads =
      options.threads > 0 ? options.threads : tbb::this_task_arena::max_concurrency();
  return ThreadLimit(threads).run(
      [&] { return ConflictSearch(result, poses, options, progress).run(conflict_of); });
}

}  // namespace clearway
