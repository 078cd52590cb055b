#include "core/trajectory/follow/towed.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// Longest sub-step, in metres of the path's way.
constexpr double kStep = 0.02;
/// Most that the path turns in a sub-step, in radians. On curves of more than 1 m this never
/// counts; it is for turns on the spot.
constexpr double kTurn = 0.02;
/// Greatest way, in metres, that a hitch may go back in one stretch.
constexpr double kMostBack = 0.1;
/// A hitch that is nearer than this to its last place, in metres, stands still. Far more than
/// coordinates of a map round to.
constexpr double kStill = 1e-6;
/// A body begins in line with its tower, which is forgotten after this many times its length.
constexpr double kTransientLengths = 3;
/// Longest path, in metres, that is driven in sub-steps.
constexpr double kLongestPath = 1e6;
/// Greatest angle between the tower's heading and the first way of the hitch that looks sound.
constexpr double kSoundAngle = std::numbers::pi / 3;

/// The place of a hitch, and which way its tower has up there.
struct Hitch {
  Vec3 place, up;
};

Hitch hitch_on(const Pose& tower, double at) {
  const Vec3 up = tower.rotated({0, 0, 1});
  return {tower.position() + at * tower.rotated({1, 0, 0}), 1 / length(up) * up};
}

/// Where a towed body is while its hitch moves. In the plane, the axle follows the hitch as a
/// tractrix; heights come from the way that the hitch has gone.
class TowedMotion {
 public:
  /// unit: metres per unit of the poses.
  TowedMotion(const BodyTowed& tow, double unit)
      : tow_(tow),
        length_(tow.hitch - tow.axle),
        most_back_(kMostBack / unit),
        still_(kStill / unit) {}

  bool has_begun() const { return has_begun_; }
  /// Whether the hitch has gone back too far for the body to have a place.
  bool is_pushed() const { return is_pushed_; }
  /// Whether the hitch is not as far along its way as it was before.
  bool is_back() const { return back_ > 0; }
  /// Whether the hitch left at once in another direction than the tower's x axis.
  bool began_askew() const { return began_askew_; }
  bool is_transient() const { return way_ <= kTransientLengths * length_; }
  /// The angle between the tower's heading and that with which the body began, radians.
  double turn_since_begin(const Pose& tower) const {
    return std::abs(std::remainder(heading_of(tower) - first_heading_, 2 * std::numbers::pi));
  }

  /// Puts the body in line with its tower.
  void begin(const Pose& tower) {
    hitch_ = hitch_on(tower, tow_.at);
    from_ = hitch_.place;
    heading_ = first_heading_ = heading_of(tower);
    track_ = {{0, hitch_.place.z, hitch_.up}};
    has_begun_ = true;
  }

  /// Moves the hitch to its place on the tower, straight from its last one.
  void move(const Pose& tower) {
    hitch_ = hitch_on(tower, tow_.at);
    const Vec3 step = hitch_.place - from_;
    const double way = std::hypot(step.x, step.y);
    // A shorter way is not lost, because it becomes part of a later one.
    if (!(way > still_)) return;
    const double direction = std::atan2(step.y, step.x);
    const double angle = std::remainder(direction - heading_, 2 * std::numbers::pi);
    if (is_first_move_) began_askew_ = std::abs(angle) > kSoundAngle;
    is_first_move_ = false;
    from_ = hitch_.place;
    if (std::abs(angle) > std::numbers::pi / 2) {
      move_back(way, -way * std::cos(angle));
    } else {
      move_on(way, direction, angle);
    }
  }

  BodyPose pose() const {
    const Sample behind = sample_behind();
    const double rise = hitch_.place.z - behind.height;
    const double size = std::hypot(length_, rise);
    const Vec3 x{length_ * std::cos(heading_) / size, length_ * std::sin(heading_) / size,
                 rise / size};
    return framed(x, 0.5 * (hitch_.up + behind.up), hitch_.place - tow_.hitch * x);
  }

 private:
  /// In plan, radians from the x axis of the world.
  static double heading_of(const Pose& tower) {
    const Vec3 x = tower.rotated({1, 0, 0});
    return std::atan2(x.y, x.x);
  }

  /// The height and the up direction of the hitch when it had gone `way` metres.
  struct Sample {
    double way, height;
    Vec3 up;
  };

  /// way: metres that the hitch goes; along: their part against the body's heading.
  void move_back(double way, double along) {
    stretch_ += way;
    back_ += along;
    if (stretch_ > most_back_ || back_ > most_back_) is_pushed_ = true;
  }

  /// The exact motion behind a hitch that goes straight: the tangent of half the angle between both
  /// directions falls exponentially.
  void move_on(double way, double direction, double angle) {
    // The part of the step in which the hitch only regains what it had gone back.
    const double along = way * std::cos(angle);
    const double again = std::min(back_, along);
    const double regained = again > 0 ? way * (again / along) : 0;
    const double fresh = way - regained;
    back_ -= again;
    regained_ = std::max(0.0, regained_ + regained - fresh);
    stretch_ = 0;
    way_ += fresh;
    // A hitch that jitters on the spot for long would turn the body by chance, step by step.
    const double turning = regained_ > most_back_ ? fresh : way;
    heading_ = direction - 2 * std::atan2(std::sin(angle / 2) * std::exp(-turning / length_),
                                          std::cos(angle / 2));
    if (way_ > track_.back().way) track_.push_back({way_, hitch_.place.z, hitch_.up});
    const double needed = way_ - length_ - most_back_;
    while (track_.size() > 2 && track_[1].way < needed) track_.pop_front();
  }

  /// The hitch when it was one length behind, or at the beginning if it has not gone as far.
  Sample sample_behind() const {
    const double way = way_ - back_ - length_;
    const auto after = std::ranges::upper_bound(track_, way, {}, &Sample::way);
    if (after == track_.begin()) return track_.front();
    if (after == track_.end()) return track_.back();
    const Sample& before = *(after - 1);
    const double share = (way - before.way) / (after->way - before.way);
    return {way, before.height + share * (after->height - before.height),
            before.up + share * (after->up - before.up)};
  }

  BodyTowed tow_;
  double length_, most_back_, still_;
  Hitch hitch_{};
  Vec3 from_{};               ///< the place to which the body has followed the hitch
  double heading_ = 0;        ///< of the body in the plane, radians from the x axis of the world
  double first_heading_ = 0;  ///< with which the body began
  double way_ = 0;            ///< how far the hitch has gone in the plane, back and again left out
  double back_ = 0;           ///< how far the hitch is behind the end of that way
  double regained_ = 0;       ///< what it has lately gone again after going back
  double stretch_ = 0;        ///< the way back that the hitch is on, in one stretch
  std::deque<Sample> track_;
  bool has_begun_ = false, is_first_move_ = true, is_pushed_ = false, began_askew_ = false;
};

/// A place while the path is travelled: pose `way`, or a sub-step of the way to the next pose.
struct SubStep {
  std::size_t way, number, parts;

  bool is_pose() const { return number == 0; }
};

/// The angle in radians between two rotations, which may be scaled alike.
double angle_between(const Pose& a, const Pose& b) {
  double product = 0, from = 0, to = 0;
  for (int i = 0; i < 9; ++i) {
    product += a.rotation[i] * b.rotation[i];
    from += a.rotation[i] * a.rotation[i];
    to += b.rotation[i] * b.rotation[i];
  }
  return std::acos(std::clamp((3 * product / std::sqrt(from * to) - 1) / 2, -1.0, 1.0));
}

/// All sub-steps of a path, one after the other.
class SubSteps {
 public:
  SubSteps(const PathStations& path, double unit) : path_(path), unit_(unit) { count_parts(); }

  /// Replaces `steps` by the next ones, some thousands; none at the end of the path.
  void next(std::vector<SubStep>& steps) {
    constexpr std::size_t kBlock = 4096;
    steps.clear();
    while (steps.size() < kBlock && at_.way < path_.poses().size()) {
      steps.push_back(at_);
      if (++at_.number < at_.parts) continue;
      at_ = {at_.way + 1, 0, 1};
      count_parts();
    }
  }

  PathMoment moment(const SubStep& step) const {
    const double station = path_.of_pose(step.way);
    if (step.is_pose()) return {{step.way, 0}, station};
    const double share = static_cast<double>(step.number) / static_cast<double>(step.parts);
    const double length = path_.way_length(step.way);
    // On the spot the parameter counts, because the path only turns there.
    if (!(length > 0)) return {{step.way, share}, station};
    return {path_.on_way(step.way, share * length), station + share * length};
  }

 private:
  void count_parts() {
    if (at_.way + 1 >= path_.poses().size()) return;
    const auto poses = path_.poses();
    const double turn = angle_between(poses[at_.way], poses[at_.way + 1]);
    const double parts =
        std::max(std::ceil(path_.way_length(at_.way) * unit_ / kStep), std::ceil(turn / kTurn));
    at_.parts = static_cast<std::size_t>(std::max(1.0, parts));
  }

  const PathStations& path_;
  double unit_;
  SubStep at_{0, 0, 1};
};

void refuse_long(const PathStations& path, double unit) {
  const double length = path.length() * unit;
  if (length <= kLongestPath) return;
  throw InputError("the path is " + format_brief(length / 1000) +
                   " km long; a towed body is moved in steps of 0.02 m, expected a path of at "
                   "most 1000 km");
}

/// Bodies that are towed, directly or not, by one body or by the path's pose.
struct Chain {
  const PathStations* path;
  BodyMount mount;  ///< how the first tower follows the path
  std::span<const std::uint32_t> path_pose;
  std::vector<std::size_t> towed;  ///< each after its tower
};

/// Moves the bodies of one chain.
class ChainDrive {
 public:
  ChainDrive(const Chain& chain, std::span<const MountedBody> bodies, const Towing& towing,
             double unit, std::vector<FollowedPath>& followed)
      : chain_(chain), followed_(followed) {
    std::map<std::size_t, std::size_t> place_of;
    for (const std::size_t body : chain.towed) {
      const auto tower = towing.tower[body] ? place_of.find(*towing.tower[body]) : place_of.end();
      Link link{body, TowedMotion(std::get<BodyTowed>(bodies[body].mount), unit)};
      if (tower != place_of.end()) {
        link.tower = tower->second;
        links_[tower->second].tows = true;
      }
      place_of[body] = links_.size();
      links_.push_back(std::move(link));
    }
  }

  /// Whether no body goes on, because all are pushed.
  bool is_over() const {
    return std::ranges::all_of(links_, [](const Link& link) { return link.motion.is_pushed(); });
  }

  /// Moves the bodies to a sub-step. first: the pose that the first tower has there.
  void move(const SubStep& step, const BodyPose& first) {
    for (Link& link : links_) move(step, link, link.tower ? links_[*link.tower].now : first);
  }

 private:
  struct Link {
    std::size_t body;
    TowedMotion motion;
    std::optional<std::size_t> tower = {};  ///< of `links_`; none: the first tower
    bool tows = false;
    std::uint64_t back_from = 0;  ///< pose from whose next way on the hitch was last back
    BodyPose now = {};  ///< only where it is needed: at poses, and for bodies that it tows
  };

  std::uint64_t pose_number(std::size_t way) const {
    return chain_.path_pose.empty() ? way : chain_.path_pose[way];
  }

  void move(const SubStep& step, Link& link, const BodyPose& tower) {
    FollowedPath& followed = followed_[link.body];
    if (link.motion.is_pushed()) {
      link.now = {.state = kUndefined};
      return;
    }
    link.now = {.state = static_cast<std::uint8_t>(tower.state & (kOffPath | kUndefined))};
    if (tower.exists()) follow(step, link, tower.pose);
    if (!step.is_pose() || link.motion.is_pushed()) return;
    const std::uint64_t number = pose_number(step.way);
    add_pose(followed, number, link.now);
    if (!link.now.exists() || !link.motion.is_transient()) return;
    followed.transient.push_back(number);
    followed.transient_turn =
        std::max(followed.transient_turn, link.motion.turn_since_begin(tower.pose));
  }

  void follow(const SubStep& step, Link& link, const Pose& tower) {
    if (link.motion.has_begun()) {
      move_on(step, link, tower);
    } else if (step.is_pose()) {
      link.motion.begin(tower);
    } else {  // The body begins at a pose, so that nothing depends on the way before.
      link.now = {.state = kOffPath};
      return;
    }
    if (step.is_pose() || link.tows) link.now = link.motion.pose();
  }

  /// Says that the body's first pose is an odd one.
  static void add_turned(FollowedPath& followed) {
    if (!followed.of.empty() && (followed.turned.empty() || followed.turned[0] != followed.of[0])) {
      followed.turned.insert(followed.turned.begin(), followed.of[0]);
    }
  }

  void move_on(const SubStep& step, Link& link, const Pose& tower) {
    FollowedPath& followed = followed_[link.body];
    const bool was_back = link.motion.is_back(), was_askew = link.motion.began_askew();
    link.motion.move(tower);
    if (link.motion.began_askew() && !was_askew) add_turned(followed);
    if (!link.motion.is_back()) return;
    // A sub-step at a pose ends the way before it.
    const std::uint64_t number =
        pose_number(step.is_pose() && step.way > 0 ? step.way - 1 : step.way);
    auto& rolled = followed.rolled_back;
    if (!was_back) link.back_from = number;
    if (rolled.empty() || rolled.back() != number) rolled.push_back(number);
    if (link.motion.is_pushed()) followed.pushed_from = link.back_from;
  }

  const Chain& chain_;
  std::vector<FollowedPath>& followed_;
  std::vector<Link> links_;
};

void drive(const Chain& chain, std::span<const MountedBody> bodies, const Towing& towing,
           double unit, int threads, std::vector<FollowedPath>& followed) {
  const PathStations& path = *chain.path;
  refuse_long(path, unit);
  refuse_mirroring(path);
  ChainDrive drive(chain, bodies, towing, unit, followed);
  SubSteps way(path, unit);
  std::vector<SubStep> steps;
  std::vector<BodyPose> first;
  for (way.next(steps); !steps.empty() && !drive.is_over(); way.next(steps)) {
    first.resize(steps.size());
#pragma omp parallel for schedule(static, 64) num_threads(threads)
    for (std::size_t i = 0; i < steps.size(); ++i) {
      first[i] = body_pose_at(path, way.moment(steps[i]), chain.mount);
    }
    for (std::size_t i = 0; i < steps.size(); ++i) drive.move(steps[i], first[i]);
  }
}

/// The number of the first tower of a towed body; none where it is the path's pose.
std::optional<std::size_t> first_tower(std::size_t body, std::span<const MountedBody> bodies,
                                       const Towing& towing) {
  std::optional<std::size_t> first = towing.tower[body];
  while (first && std::holds_alternative<BodyTowed>(bodies[*first].mount)) {
    first = towing.tower[*first];
  }
  return first;
}

/// Fills in the order of towing; towed bodies that it never reaches tow each other in a ring.
void set_order(std::span<const std::string> names, std::span<const BodyMount> mounts,
               Towing& towing) {
  std::vector<bool> placed;
  for (const BodyMount& mount : mounts) placed.push_back(!std::holds_alternative<BodyTowed>(mount));
  for (bool any = true; any;) {
    any = false;
    for (std::size_t i = 0; i < mounts.size(); ++i) {
      if (placed[i] || (towing.tower[i] && !placed[*towing.tower[i]])) continue;
      towing.order.push_back(i);
      placed[i] = any = true;
    }
  }
  const auto lost = std::ranges::find(placed, false);
  if (lost == placed.end()) return;
  // The tower of a tower and so on ends up in the ring, of which the text names one body after the
  // other.
  auto body = static_cast<std::size_t>(lost - placed.begin());
  for (std::size_t i = 0; i < mounts.size(); ++i) body = *towing.tower[body];
  std::string ring = names[body];
  for (std::size_t next = *towing.tower[body]; next != body; next = *towing.tower[next]) {
    ring += " is towed by " + names[next] + ", which";
  }
  towing.order.clear();
  towing.fault =
      Towing::Fault{body, "the bodies tow each other in a ring: " + ring + " is towed by " +
                              names[body] + "; expected one of them to follow the path"};
}

}  // namespace

Towing towing_of(std::span<const std::string> names, std::span<const BodyMount> mounts) {
  Towing towing{
      .tower = std::vector<std::optional<std::size_t>>(mounts.size()), .order = {}, .fault = {}};
  const auto find_fault = [&](std::size_t i, const BodyTowed& tow) -> std::optional<std::string> {
    const auto found = std::ranges::find(names, tow.by);
    if (found == names.end())
      return "no body is named \"" + tow.by + "\"; expected the name of another body";
    if (std::find(found + 1, names.end(), tow.by) != names.end()) {
      return "two bodies are named \"" + tow.by + "\"";
    }
    towing.tower[i] = static_cast<std::size_t>(found - names.begin());
    if (towing.tower[i] == i) return "the body would tow itself";
    return std::nullopt;
  };
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    const auto* tow = std::get_if<BodyTowed>(&mounts[i]);
    if (tow == nullptr || tow->by.empty()) continue;
    if (const auto what = find_fault(i, *tow)) {
      towing.fault = Towing::Fault{i, *what};
      return towing;
    }
  }
  set_order(names, mounts, towing);
  return towing;
}

std::vector<FollowedPath> follow_towed(std::span<const MountedBody> bodies, const Towing& towing,
                                       double metres, int threads) {
  std::vector<Chain> chains;
  std::map<std::optional<std::size_t>, std::size_t> chain_of;
  for (const std::size_t body : towing.order) {
    const auto first = first_tower(body, bodies, towing);
    const auto [found, is_new] = chain_of.emplace(first, chains.size());
    if (is_new && first) {
      const MountedBody& tower = bodies[*first];
      const bool own = std::holds_alternative<BodyOwnPoses>(tower.mount);
      chains.push_back(
          {tower.path, own ? BodyMount(BodyStation{0}) : tower.mount, tower.path_pose, {}});
    } else if (is_new) {
      chains.push_back({bodies[body].path, BodyStation{0}, bodies[body].path_pose, {}});
    }
    chains[found->second].towed.push_back(body);
  }
  std::vector<FollowedPath> followed(bodies.size());
  for (const Chain& chain : chains) drive(chain, bodies, towing, metres, threads, followed);
  return followed;
}

std::string pushed_text(const FollowedPath& followed, const PathStations& path) {
  const std::uint64_t pose = *followed.pushed_from;
  return "its hitch goes backwards by more than 0.1 m, from pose " + std::to_string(pose) +
         " of the path (from 0), " + format_brief(path.of_pose(pose)) +
         " m along it. A towed body that is pushed is not stable, so where it goes cannot be "
         "computed; expected a path that is driven forwards, along its x axis, or a trajectory of "
         "the body's own";
}

}  // namespace clearway
