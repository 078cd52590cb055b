#include <tbb/task.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/shift.hpp"
#include "core/geometry/axes.hpp"
#include "core/geometry/floor.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/triangle.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "core/util/stopwatch.hpp"
#include "findings/check_conflicts.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"
#include "search/check_corridor.hpp"
#include "search/checks/query_warnings.hpp"
#include "search/kept_models.hpp"

namespace clearway {
namespace {

/// The shifts that are tried, in their order: by length, to the left before to the right.
class ShiftCandidates {
 public:
  /// Throws UsageError for a range or a step that make no sense.
  explicit ShiftCandidates(const ShiftOptions& options) : step_(options.step) {
    const double from = options.lateral_from, to = options.lateral_to;
    if (!(step_ > 0) || !std::isfinite(step_)) {
      throw UsageError("a step of " + format_number(step_) +
                       " m between shifts; expected a finite length " + "above 0");
    }
    if (!std::isfinite(from) || !std::isfinite(to) || !(from <= 0) || !(to >= 0)) {
      throw UsageError("shifts from " + format_number(from) + " to " + format_number(to) +
                       " m; expected a range that contains 0, such as from -2 to 2");
    }
    const double left = steps_to(to), right = steps_to(-from);
    if (!(left + right < static_cast<double>(kMostShifts))) {
      throw UsageError("shifts from " + format_number(from) + " to " + format_number(to) +
                       " m by steps of " + format_number(step_) + " m are more than " +
                       format_count(kMostShifts) + "; expected a longer step or a shorter range");
    }
    left_ = static_cast<std::uint64_t>(left);
    right_ = static_cast<std::uint64_t>(right);
  }

  /// The number of shifts, 0 included.
  std::uint64_t size() const { return 1 + left_ + right_; }

  /// The shift at a place of the order.
  double at(std::uint64_t rank) const {
    const std::uint64_t both = std::min(left_, right_);
    if (rank <= 2 * both) return multiple((rank + 1) / 2, rank % 2 == 1);
    return multiple(rank - both, left_ > right_);
  }

 private:
  /// How many whole steps there are to the end of a range; a quotient that rounding may have
  /// brought just below a whole number counts as that number.
  double steps_to(double end) const {
    constexpr double kRounding = 1e-9;
    return std::floor(end / step_ + kRounding);
  }

  /// The multiple of the step to 15 digits, so that three steps of 0.1 are 0.3.
  double multiple(std::uint64_t steps, bool left) const {
    if (steps == 0) return 0;
    const double length = rounded_to_15_digits(static_cast<double>(steps) * step_);
    return left ? length : -length;
  }

  static double rounded_to_15_digits(double value) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.14e", value);
    return std::strtod(text.data(), nullptr);
  }

  double step_;
  std::uint64_t left_ = 0, right_ = 0;
};

/// The direction in the environment in which a pose of the path is shifted: its left axis.
Vec3 left_of(const Pose& pose, Axis left) {
  const int column = line_of(left);
  const double sign = is_negative(left) ? -1 : 1;
  const double* r = pose.rotation;
  return {sign * r[column], sign * r[3 + column], sign * r[6 + column]};
}

Pose shifted(Pose pose, const Vec3& left, double shift) {
  for (int k = 0; k < 3; ++k) {
    pose.translation[k] = rounded_sum(pose.translation[k], rounded_product(shift, left[k]));
  }
  return pose;
}

/// At most so many points, taken evenly from those that are added.
class PointSample {
 public:
  explicit PointSample(std::size_t most) : most_(most) {}

  void add(const Vec3& point) {
    if (met_++ % every_ != 0) return;
    if (kept_.size() == most_) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < kept_.size(); i += 2) kept_[kept++] = kept_[i];
      kept_.resize(kept);
      every_ *= 2;
      if ((met_ - 1) % every_ != 0) return;
    }
    kept_.push_back(point);
  }

  const std::vector<Vec3>& points() const { return kept_; }

 private:
  std::size_t most_;
  std::uint64_t met_ = 0, every_ = 1;
  std::vector<Vec3> kept_;
};

/// What moves along the path, as all stretches share it.
struct MovingShapes {
  /// asked: the question about shifts. lower: by how much its floors are below those of the search.
  MovingShapes(const Query& query, const QueryParameters& asked, double lower, Axis left_axis,
               int threads)
      : bodies(moving_bodies(query.model, query.poses, query.bodies)),
        path(query.poses),
        left(left_axis) {
    for (MovingBody& body : bodies) {
      body.floor = body.floor ? *body.floor - lower : asked.floor;
      shapes.push_back(std::make_unique<ModelIndex>(body.model, threads, 1));
    }
  }

  std::vector<MovingBody> bodies;
  std::span<const Pose> path;
  Axis left;
  std::vector<std::unique_ptr<ModelIndex>> shapes;  ///< one for each body
};

/// Points that are known to stand in the way of a stretch. They rule out shifts without a search: a
/// shift is ruled out where the predicate says that one of them collides with one element of a
/// body, because every search of the shift would find that point.
class ObstaclePoints {
 public:
  /// moving: with the floors of the question that is asked.
  ObstaclePoints(const MovingShapes& moving, PoseRange stretch, double radius, bool ways,
                 const ShiftOptions& range)
      : moving_(moving),
        radius_(radius),
        ways_(ways),
        from_(range.lateral_from),
        to_(range.lateral_to) {
    for (std::size_t body = 0; body < moving.bodies.size(); ++body) {
      for (std::uint32_t i = stretch.first; i <= stretch.last; ++i) add_place(body, i, stretch);
    }
  }

  void add(std::span<const Vec3> points) {
    for (const Vec3& point : points) add(point);
    if (contacts_.size() > kMostContacts) contacts_.resize(kMostContacts);
  }

  /// Whether any of the points surely collides at this shift. Points that have ruled out shifts are
  /// asked first.
  bool rule_out(double shift) {
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (!collides_at(contacts_[i], shift)) continue;
      std::swap(contacts_[i], contacts_[i / 2]);
      return true;
    }
    return false;
  }

 private:
  /// The most pairs of a point and a pose that are kept, and those of one point.
  static constexpr std::size_t kMostContacts = 100'000, kMostPlacesOfPoint = 32;
  /// At how many places of a way the nearest element is looked up.
  static constexpr int kPartsOfWay = 4;

  /// A body at a pose, and at the end of its way from there.
  struct Place {
    const ModelIndex* shape;
    Pose pose;
    std::optional<Pose> next;
    Vec3 left, next_left;  ///< the directions of the shift in the environment
    Box reach;             ///< what comes within the radius of the body's box, in its own frame
    double floor;          ///< kNoFloor without one
  };
  struct Contact {
    Vec3 point;
    std::uint32_t place;
  };

  void add_place(std::size_t body, std::uint32_t i, PoseRange stretch) {
    const Pose* pose = moving_.bodies[body].pose_at(i);
    if (pose == nullptr) return;
    const ModelIndex& shape = *moving_.shapes[body];
    Place place{&shape,
                *pose,
                {},
                left_of(moving_.path[i], moving_.left),
                {},
                {},
                moving_.bodies[body].floor.value_or(kNoFloor)};
    place.reach = shape.box().grown(radius_);
    const Pose* next = ways_ && i < stretch.last ? moving_.bodies[body].pose_at(i + 1) : nullptr;
    if (next != nullptr) {
      place.next = *next;
      place.next_left = left_of(moving_.path[i + 1], moving_.left);
    }
    places_.push_back(place);
  }

  /// Adds the poses at which some shift of the range may bring the point within reach.
  void add(const Vec3& point) {
    near_.clear();
    for (std::uint32_t p = 0; p < places_.size(); ++p) {
      const Place& place = places_[p];
      Box seen = segment(seen_from(place.pose, place.left, from_, point),
                         seen_from(place.pose, place.left, to_, point));
      if (place.next) {
        seen = seen.united(segment(seen_from(*place.next, place.next_left, from_, point),
                                   seen_from(*place.next, place.next_left, to_, point)));
      }
      if (seen.meets(place.reach)) near_.push_back(p);
    }
    const std::size_t every = near_.size() / kMostPlacesOfPoint + 1;
    for (std::size_t k = 0; k < near_.size(); k += every) contacts_.push_back({point, near_[k]});
  }

  static Vec3 seen_from(const Pose& pose, const Vec3& left, double shift, const Vec3& point) {
    return pulled_back(shifted(pose, left, shift), point);
  }

  static Box segment(const Vec3& a, const Vec3& b) {
    Box box{a, a};
    box.extend(b);
    return box;
  }

  bool collides_at(const Contact& contact, double shift) const {
    const Place& place = places_[contact.place];
    const Pose pose = shifted(place.pose, place.left, shift);
    const Vec3 x = pulled_back(pose, contact.point);
    if (place.next) {
      return collides_on_way(place, pose, shifted(*place.next, place.next_left, shift),
                             contact.point, x);
    }
    if (!place.reach.contains(x) || !is_above_floor(pose, contact.point, place.floor)) return false;
    const ModelIndex& shape = *place.shape;
    if (shape.triangles.size() == 0) {
      const Vec3& m = shape.points.element(shape.points.nearest(x).element);
      return collides(contact.point, transform(pose, m), radius_);
    }
    const Triangle& t = shape.triangles.element(shape.triangles.nearest(x).element);
    return collides(contact.point, transform(pose, t), radius_) || shape.solids.ref().contains(x);
  }

  /// x, and where the point is seen from the next pose: the model point that is nearest to a place
  /// between them is tried, because model points move on straight segments.
  bool collides_on_way(const Place& place, const Pose& pose, const Pose& next, const Vec3& point,
                       const Vec3& x) const {
    const Vec3 end = pulled_back(next, point);
    if (!segment(x, end).meets(place.reach)) return false;
    if (!is_above_floor_on_way(pose, next, point, place.floor)) return false;
    const ModelTree& points = place.shape->points;
    if (points.size() == 0) return false;
    for (int part = 0; part <= kPartsOfWay; ++part) {
      const double share = static_cast<double>(part) / kPartsOfWay;
      const Vec3 seen{x.x + share * (end.x - x.x), x.y + share * (end.y - x.y),
                      x.z + share * (end.z - x.z)};
      const Vec3& m = points.element(points.nearest(seen).element);
      if (clearway::collides_on_way(point, transform(pose, m), transform(next, m), radius_)) {
        return true;
      }
    }
    return false;
  }

  const MovingShapes& moving_;
  const double radius_;
  const bool ways_;
  const double from_, to_;
  std::vector<Place> places_;
  std::vector<Contact> contacts_;
  std::vector<std::uint32_t> near_;  ///< of the point that is added
};

/// The query of a stretch, whose poses are moved to each shift.
class ShiftedQuery {
 public:
  /// The bodies' poses of the stretch are counted from its first pose. Bodies that have no pose
  /// there are left out. lower: as for MovingShapes.
  ShiftedQuery(const Query& query, const QueryParameters& asked, double lower, PoseRange stretch,
               Axis left)
      : query_(query.model, {}, asked) {
    for (std::uint32_t i = stretch.first; i <= stretch.last; ++i) {
      path_.push_back(query.poses[i]);
      left_.push_back(left_of(query.poses[i], left));
    }
    for (const Body& body : query.bodies) {
      Body part{body.name, body.model, {}, {}};
      if (body.floor) part.floor = *body.floor - lower;
      for (std::size_t k = 0; k < body.poses.size(); ++k) {
        const std::uint32_t i = body.path_pose[k];
        if (i < stretch.first || i > stretch.last) continue;
        part.poses.push_back(body.poses[k]);
        part.path_pose.push_back(i - stretch.first);
      }
      if (part.poses.empty()) continue;
      poses_.push_back(part.poses);
      query_.bodies.push_back(std::move(part));
    }
    query_.poses.resize(path_.size());
    is_empty_ = query.model.empty() && query_.bodies.empty();
  }

  /// Whether nothing moves on the stretch.
  bool is_empty() const { return is_empty_; }

  const Query& at(double shift, double clearance = 0) {
    query_.clearance = clearance;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      query_.poses[i] = shifted(path_[i], left_[i], shift);
    }
    for (std::size_t b = 0; b < poses_.size(); ++b) {
      Body& body = query_.bodies[b];
      for (std::size_t k = 0; k < body.poses.size(); ++k) {
        body.poses[k] = shifted(poses_[b][k], left_[body.path_pose[k]], shift);
      }
    }
    return query_;
  }

 private:
  Query query_;
  std::vector<Pose> path_;
  std::vector<Vec3> left_;                ///< of each pose of the path
  std::vector<std::vector<Pose>> poses_;  ///< those of each body before a shift
  bool is_empty_ = false;
};

/// The question of each shifted stretch. With an error budget, a stretch is free where nothing is
/// closer than what a clear passage keeps free.
QueryParameters plain_parameters(const ResultHeader& header) {
  QueryParameters out;
  out.radius = header.budget ? header.budget->near_radius(header.radius) : header.radius;
  // The floor of the points that may be too close.
  if (header.floor) out.floor = *header.floor - (out.radius - header.radius);
  out.between_poses = header.between_poses;
  out.ignore_classes = header.ignore_classes;
  out.ignore_boxes = header.ignore_boxes;
  return out;
}

/// One call of find_shifts(), step by step.
class ShiftSearch {
 public:
  ShiftSearch(const Session& session, const Result& result, const Query& query,
              const ShiftOptions& options, const ShiftCandidates& candidates, Progress& progress)
      : session_(session),
        reader_(result.reader()),
        run_(counted_answer(reader_)),
        query_(query),
        options_(options),
        candidates_(candidates),
        progress_(progress),
        asked_(plain_parameters(reader_.header())),
        lower_(asked_.radius - reader_.header().radius),
        threads_(threads_or_all(session.options().threads)),
        moving_(query, asked_, lower_, axis_to_left({options.forward, options.up}), threads_),
        chainage_(chainage_of(query.poses)) {}

  ShiftTable run(std::span<const Conflict> conflicts) {
    const Stopwatch clock;
    ShiftTable table;
    table.lateral_from = options_.lateral_from;
    table.lateral_to = options_.lateral_to;
    table.step = options_.step;
    const double farthest =
        std::max(std::abs(options_.lateral_from), std::abs(options_.lateral_to));
    CorridorCheck(session_.store().reader().metadata())
        .check(moving_bodies(query_), asked_.between_poses, asked_.radius + farthest);
    read_obstacles();
    progress_.begin("shifts", conflicts.size() + 1, "stretches");
    std::vector<Found> found(conflicts.size());
    in_parallel(conflicts.size(), [&](std::size_t i) { found[i] = find(row_of(conflicts[i]), 1); });
    for (Found& one : found) table.conflicts.push_back(one.row);
    table.path = find_whole(found);
    progress_.end();
    table.searches = table.path.searches;
    for (const StretchShift& row : table.conflicts) table.searches += row.searches;
    table.seconds = clock.seconds();
    return table;
  }

 private:
  /// The shift of a stretch, and where it stands in the order of the candidates.
  struct Found {
    StretchShift row;
    std::uint64_t rank = 0;  ///< the number of candidates where there is none
    /// Points that searches found on the way to it.
    std::vector<Vec3> obstacles = {};
  };

  /// The most points that are kept of a search, of a pose of the result, and of all of a stretch.
  static constexpr std::size_t kMostOfSearch = 256, kMostOfPose = 8, kMostOfStretch = 512;
  /// How many stretches are asked for at once. More would wait for each other.
  static constexpr std::size_t kMostAtOnce = 16;

  StretchShift row_of(const Conflict& conflict) const {
    StretchShift row;
    row.conflict = conflict.id;
    row.first_pose = conflict.first_pose;
    row.last_pose = conflict.last_pose;
    add_places(row);
    return row;
  }

  void add_places(StretchShift& row) const {
    const std::uint32_t end = range_of(row).last;
    row.chainage_from = chainage_[row.first_pose] + options_.chainage_start;
    row.chainage_to = chainage_[end] + options_.chainage_start;
    if (options_.station.empty()) return;
    row.station_from = options_.station[row.first_pose];
    row.station_to = options_.station[end];
  }

  PoseRange range_of(const StretchShift& row) const {
    const bool way = asked_.between_poses && row.last_pose + 1 < query_.poses.size();
    return {row.first_pose, row.last_pose + (way ? 1 : 0)};
  }

  /// Keeps a few colliding points of each pose, to begin with.
  void read_obstacles() {
    std::vector<PointSample> of_pose(query_.poses.size(), PointSample(kMostOfPose));
    RowStream<Collisions> stream(reader_);
    for (Collisions rows; stream.read(rows);) {
      throw_if_stopped(progress_);
      for (std::size_t i = 0; i < rows.size() && !rows.first_pose.empty(); ++i) {
        of_pose[rows.first_pose[i]].add(rows.xyz[i]);
        if (rows.last_pose[i] != rows.first_pose[i]) {
          of_pose[rows.last_pose[i]].add(rows.xyz[i]);
        }
      }
    }
    of_pose_.resize(of_pose.size());
    for (std::size_t i = 0; i < of_pose.size(); ++i) of_pose_[i] = of_pose[i].points();
  }

  std::vector<Vec3> known_points(PoseRange stretch) const {
    PointSample sample(kMostOfStretch);
    for (std::uint32_t i = stretch.first; i <= stretch.last; ++i) {
      for (const Vec3& point : of_pose_[i]) sample.add(point);
    }
    return sample.points();
  }

  /// Calls visit(i) for each i below `count`, several at once. A thread that waits within visit()
  /// for the tasks of its own search does not begin another visit meanwhile.
  template <typename Visit>
  void in_parallel(std::size_t count, const Visit& visit) const {
    std::atomic<std::size_t> next = 0;
    const auto visit_next = [&](std::size_t) {
      for (std::size_t i = next++; i < count && !tbb::is_current_task_group_canceling();
           i = next++) {
        tbb::this_task_arena::isolate([&] { visit(i); });
      }
    };
    in_threads(threads_, [&] { for_each_parallel(std::min(count, kMostAtOnce), visit_next); });
  }

  /// Finds the first candidate from `rank` on that frees the stretch of the row. points: further
  /// points that may stand in the way.
  Found find(StretchShift row, std::uint64_t rank, std::span<const Vec3> points = {}) const {
    const PoseRange stretch = range_of(row);
    Found found{std::move(row), candidates_.size()};
    found.row.warned_of = doubts_of_run(stretch);
    if (!found.row.warned_of.empty()) {
      progress_.advance(1);
      return found;
    }
    ShiftedQuery moved(query_, asked_, lower_, stretch, moving_.left);
    ObstaclePoints obstacles(moving_, stretch, asked_.radius, asked_.between_poses, options_);
    obstacles.add(known_points(stretch));
    obstacles.add(points);
    std::vector<std::string> doubts;
    for (; rank < candidates_.size(); ++rank) {
      throw_if_stopped(progress_);
      const double shift = candidates_.at(rank);
      if (moved.is_empty()) break;
      if (obstacles.rule_out(shift)) continue;
      ++found.row.searches;
      const SessionAnswer answer = session_.search(moved.at(shift), question());
      if (answer.collisions().size() == 0) {
        const std::vector<std::string> in_doubt = doubts_at_shift(answer);
        if (!in_doubt.empty()) {
          if (doubts.empty()) doubts = in_doubt;
          continue;
        }
        if (!answer.warnings.empty()) found.row.warned_of = new_warnings(answer, moved, shift);
        break;
      }
      PointSample sample(kMostOfSearch);
      for (const Vec3& point : answer.collisions().xyz) sample.add(point);
      obstacles.add(sample.points());
      found.obstacles.insert(found.obstacles.end(), sample.points().begin(), sample.points().end());
    }
    found.rank = rank;
    if (rank < candidates_.size()) {
      found.row.shift = candidates_.at(rank);
      if (!moved.is_empty()) found.row.least_distance = least_distance(moved, *found.row.shift);
    } else {
      found.row.warned_of = std::move(doubts);
    }
    progress_.advance(1);
    return found;
  }

  /// Codes of the warnings that nothing, or no ground, was scanned at a place.
  static constexpr std::array<std::string_view, 4> kOfPlace{"floats", "leaves-scan",
                                                            "nothing-below", "out-of-reach"};
  static bool is_of_place(std::string_view code) {
    return std::ranges::find(kOfPlace, code) != kOfPlace.end();
  }

  /// The codes of the warnings that put a stretch in doubt wherever it is shifted, because the run
  /// gave them and they are not about a place.
  std::vector<std::string> doubts_of_run(PoseRange stretch) const {
    std::set<std::string> codes;
    for (const Message& warning : run_.warnings) {
      if (is_of_place(warning.code)) continue;
      const Doubt doubt = run_.doubt_of(warning);
      const auto meets = [&](const PoseRange& poses) {
        return poses.first <= stretch.last && stretch.first <= poses.last;
      };
      if (doubt == Doubt::kQuestion ||
          (doubt == Doubt::kStretch && std::ranges::any_of(warning.stretches, meets))) {
        codes.insert(warning.code);
      }
    }
    return {codes.begin(), codes.end()};
  }

  /// The codes of the warnings about a place that put the answer at a shift in doubt. What the run
  /// was warned of along its whole path, such as ground that was removed on purpose, does not.
  /// Below the ground is a place for what leaves points out, since else the ground would collide.
  std::vector<std::string> doubts_at_shift(const Answer& answer) const {
    std::vector<std::string> codes = answer.doubts();
    const std::vector<std::string> known = run_.warned_of();
    const bool leaves_out = asked_.ignores_points() || has_floor(query_);
    std::erase_if(codes, [&](const std::string& code) {
      const bool matters = is_of_place(code) || (leaves_out && code == "below-ground");
      return !matters || std::ranges::binary_search(known, code);
    });
    return codes;
  }

  /// The codes of place that the checks give at a shift and not without it. answer: that of the
  /// shift.
  std::vector<std::string> new_warnings(const SessionAnswer& answer, ShiftedQuery& moved,
                                        double shift) const {
    const MessageCallback quiet;
    const auto codes_at = [&](double at) {
      std::vector<Message> found;
      MessageLog log(quiet, found);
      warn_of_query(session_.store().reader(), moved.at(at), answer.ignored, {}, log);
      std::set<std::string> codes;
      for (const Message& warning : found) {
        if (is_of_place(warning.code)) codes.insert(warning.code);
      }
      return codes;
    };
    const std::set<std::string> there = codes_at(shift), here = codes_at(0);
    std::vector<std::string> codes;
    std::ranges::set_difference(there, here, std::back_inserter(codes));
    return codes;
  }

  std::optional<double> least_distance(ShiftedQuery& moved, double shift) const {
    const ResultHeader& header = reader_.header();
    if (!(header.clearance > asked_.radius)) return std::nullopt;
    const SessionAnswer answer = session_.search(moved.at(shift, header.clearance), question());
    if (!answer.least_clearance) return std::nullopt;
    return answer.least_clearance->distance;
  }

  /// The whole path. A shift of it frees every stretch, so it is not less than any of theirs.
  StretchShift find_whole(const std::vector<Found>& conflicts) const {
    StretchShift row;
    if (query_.poses.empty()) return row;
    row.last_pose = static_cast<std::uint32_t>(query_.poses.size() - 1);
    add_places(row);
    std::uint64_t rank = 0;
    PointSample points(kMostOfStretch);
    for (const Found& found : conflicts) {
      rank = std::max(rank, found.rank);
      for (const Vec3& point : found.obstacles) points.add(point);
    }
    row = find(row, rank, points.points()).row;
    if (row.shift || !row.warned_of.empty()) return row;
    // What no shift frees without a doubt, no shift of the whole path does.
    std::set<std::string> doubts;
    for (const Found& found : conflicts) {
      if (!found.row.shift) doubts.insert(found.row.warned_of.begin(), found.row.warned_of.end());
    }
    row.warned_of.assign(doubts.begin(), doubts.end());
    return row;
  }

  QuestionOptions question() const {
    QuestionOptions out;
    out.stop = options_.stop;
    return out;
  }

  const Session& session_;
  const ResultReader& reader_;
  const Answer run_;  ///< of the run whose result it is
  const Query& query_;
  const ShiftOptions& options_;
  const ShiftCandidates& candidates_;
  Progress& progress_;
  const QueryParameters asked_;
  const double lower_;  ///< by how much the floors are below those of the search, metres
  const int threads_;
  const MovingShapes moving_;
  const std::vector<double> chainage_;
  std::vector<std::vector<Vec3>> of_pose_;  ///< some points that collide at each pose
};

void check_stretches(const ResultReader& result, std::span<const Conflict> conflicts) {
  for (const Conflict& conflict : conflicts) {
    if (conflict.first_pose <= conflict.last_pose && conflict.last_pose < result.header().poses) {
      continue;
    }
    throw UsageError("conflict " + std::to_string(conflict.id) + " is at poses " +
                     std::to_string(conflict.first_pose) + " to " +
                     std::to_string(conflict.last_pose) + ", and " + result.name() + " has " +
                     counted(result.header().poses, "pose") +
                     "; expected the conflicts of this result");
  }
}

}  // namespace

ShiftTable find_shifts(const Session& session, const Result& result, const Query& query,
                       std::span<const Conflict> conflicts, const ShiftOptions& options) {
  const ShiftCandidates candidates(options);
  ConflictOptions seen;
  seen.forward = options.forward;
  seen.up = options.up;
  seen.chainage_start = options.chainage_start;
  seen.station = options.station;
  seen.bodies = query.bodies;
  check_conflicts(result.reader(), query.poses, seen);
  check_searched(result.reader(), session.store().reader(),
                 {query.model, query.bodies, query.poses});
  check_stretches(result.reader(), conflicts);
  CallbackProgress progress(options.progress, options.stop);
  return ShiftSearch(session, result, query, options, candidates, progress).run(conflicts);
}

}  // namespace clearway
