#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/stations.hpp"
#include "clearway/unsearched.hpp"
#include "core/geometry/point_box.hpp"
#include "core/messages/messages.hpp"
#include "core/query/body_numbers.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/follow/path_stations.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "findings/certain_points.hpp"
#include "findings/check_conflicts.hpp"
#include "findings/least_places.hpp"
#include "findings/overthrow.hpp"
#include "findings/path_rows.hpp"
#include "findings/row_pieces.hpp"
#include "findings/touched_first.hpp"
#include "findings/unseen_lattice.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// One call of station_table(), step by step.
class TableMaker {
 public:
  TableMaker(const Result& result, const std::vector<Pose>& poses, const StationOptions& options,
             int threads, Progress& progress)
      : result_(result),
        reader_(result.reader()),
        header_(reader_.header()),
        poses_(poses),
        options_(options),
        threads_(threads),
        progress_(progress),
        rows_(chainage_of(poses), options.every),
        places_(kPlaces * rows_.size()),
        bodies_(moving_bodies(kNoModel, poses, options.bodies)) {
    for (const Body& body : options.bodies) boxes_.push_back(box_of(body.model.vertices));
    if (header_.bodies.empty()) boxes_.push_back(result.model_box());
  }

  StationTable run() {
    table_.bodies = header_.bodies;
    if (table_.bodies.empty()) table_.bodies.emplace_back();
    make_rows();
    if (rows_.size() == 0) return std::move(table_);
    add_profile();
    add_distances();
    take_places();
    add_overthrow();
    judge();
    limit_least();
    return std::move(table_);
  }

 private:
  inline static const Model kNoModel{};

  /// Whether the frames and boxes of all bodies are known.
  bool knows_bodies() const { return !boxes_.empty(); }

  void make_rows() {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      StationRow& out = table_.rows.emplace_back();
      out.chainage_from = rows_.from(row) + options_.chainage_start;
      out.chainage_to = rows_.to(row) + options_.chainage_start;
      out.station_from = station_at(rows_.from(row));
      out.station_to = station_at(rows_.to(row));
      out.overthrow.resize(table_.bodies.size());
    }
  }

  std::optional<double> station_at(double chainage) const {
    if (options_.station.empty()) return std::nullopt;
    return value_at(rows_.chainage(), options_.station, chainage);
  }

  /// Adds the least distance of the poses of each row.
  void add_profile() {
    if (!(header_.profile > 0)) return;
    progress_.begin("profile", poses_.size(), "poses");
    RowStream<ProfileRows> stream(reader_);
    std::uint32_t pose = 0;
    for (ProfileRows rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      for (std::size_t i = 0; i < rows.size(); ++i, ++pose) {
        if (rows.source[i] == Profile::kNoPoint) continue;
        places_.offer(kPlaces * rows_.of_pose(pose),
                      {rows.source[i], pose, rows.xyz[i], rows.distance[i]});
      }
      progress_.advance(rows.size());
    }
    progress_.end();
    if (!decides_by_profile()) return;
    out_of_radius_.resize(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto& least = places_[kPlaces * i];
      out_of_radius_[i] = !least || !(least->distance < header_.radius);
    }
  }

  /// Whether the profile shows on which rows anything collides at all.
  bool decides_by_profile() const {
    return header_.profile >= header_.radius && !header_.between_poses;
  }

  /// Says below or above which distance the least one is, where it is not known.
  void limit_least() {
    RowSet with_pose(rows_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) with_pose.add(rows_.of_pose(i));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      StationRow& row = table_.rows[i];
      if (row.verdict == Verdict::kConflict) {
        // What collides may have its clearance on another row, where it is nearer.
        if (row.least && row.least->distance < header_.radius) continue;
        row.least.reset();
        row.least_below = header_.radius;
      } else if (row.verdict == Verdict::kClear && !row.least && header_.profile > 0 &&
                 with_pose.contains(i)) {
        row.least_above = header_.profile;
      }
    }
  }

  void add_distances() {
    if (!(header_.clearance > 0)) {
      table_.warnings.push_back(
          warning("no-clearances", reader_.name() +
                                       ": has no clearances, so the table has no distances to the "
                                       "left, to the right and above"));
      return;
    }
    const bool sides = knows_bodies();
    if (!sides) {
      table_.warnings.push_back(
          warning("sides-unknown",
                  reader_.name() +
                      ": without the bodies of the vehicle the table cannot say which points are "
                      "to the left, to the right or above"));
    }
    std::vector<Box> boxes;
    for (const Box& box : boxes_) boxes.push_back(turned(box, options_.forward, options_.up));
    progress_.begin("distances", reader_.clearances(), "points");
    RowStream<Clearances> stream(reader_);
    for (Clearances rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
          FoundPlace found{rows.source[i], rows.pose[i], rows.xyz[i], rows.distance[i]};
          if (!rows.body.empty()) found.body = rows.body[i];
          const std::size_t first_place = kPlaces * rows_.of_pose(found.pose);
          places_.offer(first_place, found);
          if (sides) offer_side(found, boxes, first_place);
        }
      });
      progress_.advance(rows.size());
    }
    progress_.end();
  }

  /// boxes: of the bodies, along the axes of ahead_left_up().
  void offer_side(const FoundPlace& found, std::span<const Box> boxes, std::size_t first_place) {
    const auto may_be_least = [&](std::size_t side) {
      return places_.may_be_least(first_place + side, found.distance);
    };
    if (!may_be_least(1) && !may_be_least(2) && !may_be_least(3)) return;
    const Pose* pose = bodies_[found.body].pose_at(found.pose);
    if (pose == nullptr) return;
    const Vec3 there = ahead_left_up(found.xyz, *pose, options_.forward, options_.up);
    const Box& box = boxes[found.body];
    const std::size_t side = there.y > box.hi.y   ? 1
                             : there.y < box.lo.y ? 2
                             : there.z > box.hi.z ? 3
                                                  : 0;
    if (side > 0) places_.offer(first_place + side, found);
  }

  void take_places() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      StationRow& row = table_.rows[i];
      const auto place = [&](std::size_t k) { return places_[kPlaces * i + k]; };
      std::tie(row.least, row.left, row.right, row.above) =
          std::tuple(place(0), place(1), place(2), place(3));
    }
  }

  void add_overthrow() {
    if (!knows_bodies()) return;
    std::optional<PathStations> path;
    try {
      path.emplace(poses_, threads_);
    } catch (const InputError& error) {
      table_.warnings.push_back(
          warning("no-overthrow", std::string("the overthrow is not known: ") + error.what()));
      return;
    }
    progress_.begin("overthrow", bodies_.size(), "bodies");
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      throw_if_stopped(progress_);
      const std::vector<Overthrow> found =
          overthrow_of(*path, bodies_[b], boxes_[b], options_.forward, options_.up);
      for (std::size_t k = 0; k < found.size(); ++k) {
        const auto& poses = bodies_[b].path_pose;
        Overthrow& all = table_.rows[rows_.of_pose(poses.empty() ? k : poses[k])].overthrow[b];
        all.end = std::max(all.end, found[k].end);
        all.middle = std::max(all.middle, found[k].middle);
      }
      progress_.advance(1);
    }
    progress_.end();
  }

  /// The rows of a pose, or of the way that begins with it, as a half-open range.
  std::array<std::size_t, 2> rows_of(std::uint32_t pose) const {
    const bool way = header_.between_poses && pose + std::size_t{1} < poses_.size();
    return {rows_.of_pose(pose), rows_.of_pose(pose + (way ? 1 : 0)) + 1};
  }

  static void add(const std::array<std::size_t, 2>& range, RowSet& set) {
    for (std::size_t row = range[0]; row < range[1]; ++row) set.add(row);
  }

  /// Adds the rows in a range on which a body may come within `distance` of a place; all of them
  /// where the boxes of the bodies are not known.
  void add_near(const Vec3& place, double distance, std::size_t from, std::size_t to,
                RowSet& set) const {
    if (from >= to || set.next_outside(from) >= to) return;
    if (!knows_bodies()) return add({from, to}, set);
    reach_->add_near(place, distance, from, to, set);
  }

  /// Calls visit(rows, i, row of the table, sets) for every row of a table of the result, by many
  /// threads, and adds what they put into their sets to these.
  template <typename Rows, typename Visit>
  void add_rows(const std::vector<RowSet*>& sets, const Visit& visit) {
    tbb::enumerable_thread_specific<std::vector<RowSet>> of_threads(
        std::vector<RowSet>(sets.size(), RowSet(rows_.size())));
    RowStream<Rows> stream(reader_);
    std::size_t before = 0;
    for (Rows rows; stream.read(rows); before += rows.size()) {
      throw_if_stopped(progress_);
      in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
        auto& own = of_threads.local();
        for (std::size_t i = first; i < end; ++i) visit(rows, i, before + i, own);
      });
      progress_.advance(rows.size());
    }
    for (const auto& own : of_threads) {
      for (std::size_t k = 0; k < sets.size(); ++k) {
        for (std::size_t row = 0; row < rows_.size(); ++row) {
          if (own[k].contains(row)) sets[k]->add(row);
        }
      }
    }
  }

  /// Adds the rows on which a point collides: those of its first and its last pose, and of those
  /// between them the ones on which a body may touch it.
  void add_touched(const Collisions& rows, std::size_t i, RowSet& set) const {
    const auto first = rows_of(rows.first_pose[i]);
    add(first, set);
    const auto last = rows_of(rows.last_pose[i]);
    add(last, set);
    if (out_of_radius_.empty()) {
      return add_near(rows.xyz[i], header_.radius, first[1], last[0], set);
    }
    // The profile leaves out rows on which nothing collides, although a body's box may be near.
    for (std::size_t from = first[1]; from < last[0];) {
      std::size_t to = from;
      while (to < last[0] && !out_of_radius_[to]) ++to;
      add_near(rows.xyz[i], header_.radius, from, to, set);
      from = to + 1;
    }
  }

  /// With an error budget, whether each colliding point is one of ten or more that hang together
  /// and are certainly too close.
  std::vector<bool> find_certain() {
    std::vector<QuantumPoint> quanta(reader_.collisions());
    std::vector<bool> certain;
    RowStream<Collisions> stream(reader_);
    for (Collisions rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      requantize(reader_, rows, std::span(quanta).subspan(certain.size()));
      for (const std::uint8_t one : rows.certain) certain.push_back(one != 0);
    }
    return in_certain_groups(quanta, header_.quantisation, header_.gap, progress_, {}, &certain);
  }

  void judge() {
    RowSet conflict(rows_.size()), near(rows_.size()), unseen(rows_.size());
    if (knows_bodies()) reach_.emplace(bodies_, boxes_, rows_, header_.between_poses);
    find_touched(conflict, near);
    find_near(near);
    find_unseen(unseen);
    find_unsearched();
    const std::vector<RowDoubt> doubts = find_doubts();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      StationRow& row = table_.rows[i];
      if (conflict.contains(i)) {
        row.verdict = Verdict::kConflict;
        continue;
      }
      if (near.contains(i)) row.reasons.push_back(Reason::kNear);
      if (unseen.contains(i)) row.reasons.push_back(Reason::kNotScanned);
      for (const RowDoubt& doubt : doubts) {
        if (doubt.rows.contains(i)) row.doubts.push_back(doubt.code);
      }
      if (!row.doubts.empty()) row.reasons.push_back(Reason::kQuestionInDoubt);
      if (!row.reasons.empty() || !row.is_searched) row.verdict = Verdict::kUndecided;
    }
  }

  /// The rows that the warnings with one code put in doubt.
  struct RowDoubt {
    std::string code;
    RowSet rows;
  };

  /// The doubts in alphabetical order of their codes.
  std::vector<RowDoubt> find_doubts() const {
    const Answer answer = counted_answer(reader_);
    std::vector<RowDoubt> doubts;
    for (const std::string& code : answer.doubts()) {
      RowDoubt& doubt = doubts.emplace_back(RowDoubt{code, RowSet(rows_.size())});
      for (const Message& warning : answer.warnings) {
        if (warning.code != code) continue;
        const Doubt about = answer.doubt_of(warning);
        if (about == Doubt::kQuestion) add({0, rows_.size()}, doubt.rows);
        if (about != Doubt::kStretch) continue;
        for (const PoseRange& stretch : warning.stretches) add_stretch(stretch, doubt.rows);
      }
    }
    return doubts;
  }

  /// Adds the rows from the first to the last pose of a stretch.
  void add_stretch(const PoseRange& stretch, RowSet& set) const {
    if (stretch.first >= poses_.size()) return;
    const std::size_t last = std::min<std::size_t>(stretch.last, poses_.size() - 1);
    add({rows_.of_pose(stretch.first), rows_.of_pose(last) + 1}, set);
  }

  void find_touched(RowSet& conflict, RowSet& near) {
    const std::vector<bool> certain = header_.budget ? find_certain() : std::vector<bool>();
    progress_.begin("contacts", reader_.collisions(), "points");
    add_rows<Collisions>({&conflict, &near},
                         [&](const Collisions& rows, std::size_t i, std::size_t row, auto& sets) {
                           add_touched(rows, i, sets[!header_.budget || certain[row] ? 0 : 1]);
                         });
    progress_.end();
  }

  /// Adds the rows on which near points are near: that of their first pose, and later ones on which
  /// a body may come as near again, because no search looks for their last poses. The same holds
  /// for points that collide but are not certain to, where the budget keeps more space free than
  /// the radius.
  void find_near(RowSet& near) {
    if (!header_.budget) return;
    const double distance = header_.budget->near_radius(header_.radius);
    progress_.begin("near points", reader_.collisions() + reader_.near(), "points");
    add_rows<Collisions>({&near},
                         [&](const Collisions& rows, std::size_t i, std::size_t, auto& sets) {
                           add_near(rows.xyz[i], distance, 0, rows_.size(), sets[0]);
                         });
    add_rows<Nearby>({&near}, [&](const Nearby& rows, std::size_t i, std::size_t, auto& sets) {
      const auto first = rows_of(rows.first_pose[i]);
      add(first, sets[0]);
      add_near(rows.xyz[i], distance, first[1], rows_.size(), sets[0]);
    });
    progress_.end();
  }

  void find_unseen(RowSet& unseen) {
    const auto& seen = reader_.findings().seen;
    if (!seen || seen->listed_groups == 0) return;
    const UnseenCubes cubes = result_.unseen();
    const CubeLattice lattice = lattice_of_unseen(header_, *seen);
    std::vector<std::uint64_t> sizes;
    for (const std::uint32_t group : cubes.group) {
      if (group >= sizes.size()) sizes.resize(group + std::size_t{1});
      ++sizes[group];
    }
    const double distance =
        header_.budget ? header_.budget->near_radius(header_.radius) : header_.radius;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      if (i % 4096 == 0) throw_if_stopped(progress_);
      if (sizes[cubes.group[i]] < header_.seen_min) continue;
      const auto first = rows_of(cubes.first_pose[i]);
      add(first, unseen);
      const Vec3 middle = middle_of_cube(lattice, header_.quantisation, cubes.cube[i]);
      add_near(middle, distance, first[1], rows_.size(), unseen);
    }
  }

  /// Finds the rows on which a body was not searched, or no pose was.
  void find_unsearched() {
    if (!header_.bodies.empty() && options_.bodies.empty()) {
      const auto& searched = reader_.findings().searched;
      const bool all = searched && searched->whole == searched->path;
      for (StationRow& row : table_.rows) row.is_searched = all;
      if (!all) {
        table_.warnings.push_back(
            warning("searched-unknown",
                    reader_.name() +
                        ": some bodies have no pose on a part of the path, and without the vehicle "
                        "it is not known where; no stretch is called clear"));
      }
      return;
    }
    for (const UnsearchedStretch& gap : unsearched_stretches(poses_, options_.bodies)) {
      const std::size_t from = rows_.of_pose(gap.first_pose), to = rows_.of_pose(gap.last_pose);
      const std::size_t before = rows_.of_pose(gap.first_pose - (gap.first_pose > 0 ? 1 : 0));
      const std::size_t after =
          rows_.of_pose(std::min<std::size_t>(gap.last_pose + std::size_t{1}, poses_.size() - 1));
      for (std::size_t row = before; row <= after; ++row) {
        const bool meets =
            std::max(gap.chainage_from, rows_.from(row)) < std::min(gap.chainage_to, rows_.to(row));
        if (meets || (row >= from && row <= to)) table_.rows[row].is_searched = false;
      }
    }
    if (poses_.size() == 1 && !options_.bodies.empty()) note_single_pose();
    if (header_.between_poses && poses_.size() > 1) return;
    RowSet with_pose(rows_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) with_pose.add(rows_.of_pose(i));
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      if (!with_pose.contains(row)) table_.rows[row].is_searched = false;
    }
  }

  /// A path of one pose has no stretch between poses that could be unsearched.
  void note_single_pose() {
    for (const Body& body : options_.bodies) {
      if (body.poses.empty()) table_.rows.front().is_searched = false;
    }
  }

  const Result& result_;
  const ResultReader& reader_;
  const ResultHeader& header_;
  const std::vector<Pose>& poses_;
  const StationOptions& options_;
  const int threads_;
  Progress& progress_;
  const PathRows rows_;
  /// For each row the nearest place of all, to the left, to the right, and above
  static constexpr std::size_t kPlaces = 4;
  LeastPlaces places_;
  const std::vector<MovingBody> bodies_;
  std::vector<Box> boxes_;  ///< one for each of bodies_, or none where they are not known
  std::optional<BoxReach> reach_;
  /// The rows at none of whose poses anything collides; empty where the profile does not show it.
  std::vector<bool> out_of_radius_;
  StationTable table_;
};

void check_options(const ResultReader& result, const std::vector<Pose>& poses,
                   const StationOptions& options) {
  ConflictOptions checked;
  checked.chainage_start = options.chainage_start;
  checked.forward = options.forward;
  checked.up = options.up;
  checked.bodies = options.bodies;
  checked.station = options.station;
  check_conflicts(result, poses, checked);
}

}  // namespace

StationTable station_table(const Result& result, const std::vector<Pose>& poses,
                           const StationOptions& options) {
  check_options(result.reader(), poses, options);
  CallbackProgress progress(options.progress, options.stop);
  const int threads = threads_or_all(options.threads);
  return in_threads(threads,
                    [&] { return TableMaker(result, poses, options, threads, progress).run(); });
}

}  // namespace clearway
