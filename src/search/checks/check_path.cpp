#include <algorithm>
#include <cmath>
#include <iterator>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/rigid.hpp"
#include "core/messages/messages.hpp"
#include "core/section/section_poses.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/path_facts.hpp"
#include "search/checks/question.hpp"
#include "search/checks/rounded_path.hpp"
#include "search/checks/single_floats.hpp"

namespace clearway {
namespace {

/// An upper bound on how far any model point moves from one pose to the next, cheap because most
/// steps are short. reach: greatest distance of the model from its origin.
double coarse_bound(const Pose& a, const Pose& b, double reach) {
  double turned = 0, moved = 0;
  for (int k = 0; k < 9; ++k) {
    const double d = b.rotation[k] - a.rotation[k];
    turned += d * d;
  }
  for (int k = 0; k < 3; ++k) {
    const double d = b.translation[k] - a.translation[k];
    moved += d * d;
  }
  return std::sqrt(moved) + std::sqrt(turned) * reach;
}

/// The distance from which on a motion that is not searched matters: the radius. The margin of a
/// section may be 0, because it only bounds what later checks may keep.
double least_motion(const Question& question) {
  constexpr double kLeastOfLoad = 0.15;  // metres
  const double asked = question.query.radius;
  return question.is_load() ? std::max(asked, kLeastOfLoad * question.metre) : asked;
}

/// Whether a step is longer than `most` by more than the rounding of its poses: steps that were
/// made as long as the radius cause no warning.
bool exceeds(double step, double most) {
  constexpr double kRounding = 1e-6;
  return step > most * (1 + kRounding);
}

/// Poses from which steps start, as users count them, in ascending order.
using Steps = std::vector<std::uint32_t>;

bool has(const Steps& steps, std::uint32_t pose) { return std::ranges::binary_search(steps, pose); }

/// Runs of the question's poses that follow one another on the path, each as the first index and
/// the one past the last. Between two runs the body has no pose, so there is no step.
std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_of(const Question& question) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> runs;
  const auto count = static_cast<std::uint32_t>(question.query.poses.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool follows = i > 0 && question.number_of(i) == question.number_of(i - 1) + 1;
    if (!follows) runs.push_back({i, i});
    runs.back().second = i + 1;
  }
  return runs;
}

std::span<const Pose> poses_of(const Question& question,
                               std::pair<std::uint32_t, std::uint32_t> run) {
  return std::span(question.query.poses).subspan(run.first, run.second - run.first);
}

/// The jumps of all runs; they name poses as users count them.
std::vector<Jump> jumps_in(const Question& question) {
  std::vector<Jump> jumps;
  for (const auto& run : runs_of(question)) {
    const auto steps = step_lengths(poses_of(question, run));
    for (Jump jump : jumps_of(steps, least_motion(question))) {
      jump.pose = question.number_of(run.first + static_cast<std::uint32_t>(jump.pose));
      jumps.push_back(jump);
    }
  }
  return jumps;
}

/// A step whose straight way can leave the true motion.
struct Deviation {
  /// Index in the question of the pose from which the step starts.
  std::uint32_t pose;
  double distance;
};

/// The deviations that are larger than `least`. Adds the number of all steps to `steps`.
std::vector<Deviation> deviations_above(const Question& question, double least,
                                        std::uint64_t& steps) {
  const double reach = farthest_from_origin(question.points);
  std::vector<Deviation> out;
  for (const auto& run : runs_of(question)) {
    const auto distances = chord_deviations(poses_of(question, run), reach);
    steps += distances.size();
    for (std::uint32_t i = 0; i < distances.size(); ++i) {
      if (distances[i] > least) out.push_back({run.first + i, distances[i]});
    }
  }
  return out;
}

/// Warns where the true motion from one pose to the next may leave the straight way that is
/// searched by more than the radius, and notes where by more than a tenth of it. Returns the poses
/// from which the steps that it warned of start.
Steps check_straight_ways(const Question& question, const std::vector<Jump>& jumps,
                          MessageLog& log) {
  constexpr double kToBeNoted = 0.1;  // share of the radius
  const double radius = least_motion(question);
  std::uint64_t steps = 0;
  std::vector<Deviation> found = deviations_above(question, kToBeNoted * radius, steps);
  if (found.empty()) return {};
  const Deviation worst = *std::ranges::max_element(found, {}, &Deviation::distance);
  const bool warns = worst.distance > radius;
  if (warns) std::erase_if(found, [&](const Deviation& d) { return !(d.distance > radius); });
  const Pose& a = question.query.poses[worst.pose];
  const Pose& b = question.query.poses[worst.pose + 1];
  const double turned = turn_between(a, b) / kDegree;
  const double moved = std::sqrt(squared_distance(a.position(), b.position()));
  const std::uint32_t number = question.number_of(worst.pose);
  std::string text = "at " + format_count(found.size()) + " of " + counted(steps, "step") +
                     " the true motion can leave the straight way between two poses, which is "
                     "what is searched, by more than " +
                     (warns ? "" : "a tenth of ") + (question.is_load() ? "" : "the radius of ") +
                     question.length(radius) + ": by up to " + question.length(worst.distance) +
                     " after pose " + std::to_string(number) + ", where the " + question.mover() +
                     " goes on by " + question.length(moved) + " and turns by " +
                     format_digits(turned, 3) + " degrees";
  Steps starts;
  for (const Deviation& d : found) starts.push_back(question.number_of(d.pose));
  const auto jump = std::ranges::find(jumps, std::size_t{number}, &Jump::pose);
  if (warns && jump != jumps.end()) {
    text += ". This step is " + format_digits(jump->length / jump->usual, 3) +
            " times as long as those around it, so poses may be missing there";
  }
  if (warns) text += ". What is beside the straight way can be missed";
  log.add(
      warning_or_note(warns, "large-steps", text,
                      {{"share", static_cast<double>(found.size()) / static_cast<double>(steps)},
                       {"largest", worst.distance},
                       {"pose", static_cast<double>(number)},
                       {"step", moved},
                       {"turn_degrees", turned}},
                      pose_ranges(starts, 1)));
  return warns ? starts : Steps();
}

/// Warns where the model moves farther than the radius between two poses, of which only the poses
/// are searched. known: steps that another warning is given for.
void check_poses_alone(const Question& question, const Steps& known, MessageLog& log) {
  const Query& query = question.query;
  const Vec3 far = reach_of(question.model);
  const double reach = std::sqrt(squared_length(far.x, far.y, far.z));
  Steps large;
  double largest = 0;
  std::uint64_t steps = 0;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i + 1 < query.poses.size(); ++i) {
    if (question.number_of(i + 1) != question.number_of(i) + 1) continue;  // no step
    ++steps;
    const Pose &a = query.poses[i], &b = query.poses[i + 1];
    if (coarse_bound(a, b, reach) <= query.radius) continue;
    const double step = displacement_bound(question.model, a, b);
    if (!exceeds(step, query.radius) || has(known, question.number_of(i))) continue;
    large.push_back(question.number_of(i));
    if (step > largest) {
      largest = step;
      at = question.number_of(i);
    }
  }
  if (large.empty()) return;
  MessageNumbers numbers{{"share", static_cast<double>(large.size()) / static_cast<double>(steps)},
                         {"largest", largest},
                         {"pose", static_cast<double>(at)}};
  if (!query.model.triangles.empty()) numbers.emplace_back("of_mesh", 1);
  log.warn("large-steps",
           "at " + format_count(large.size()) + " of " + format_count(steps) +
               " steps the model moves farther than the radius of " +
               question.length(query.radius) + ", at most " + question.length(largest) +
               " after pose " + std::to_string(at) + ". What lies between two poses can be missed",
           std::move(numbers), pose_ranges(large, 1));
}

/// A step of a load between whose ends it is not searched.
struct LoadStep {
  std::uint32_t pose = 0;  ///< index in the question of the pose from which the step starts
  double length = 0;       ///< from position to position
  double across = 0;       ///< how far the load moves across, as seen from itself
};

/// The steps of a load, without those that are `known`.
std::vector<LoadStep> steps_of_load(const Question& question, const Steps& known) {
  std::vector<LoadStep> steps;
  const std::vector<Pose>& poses = question.query.poses;
  for (const auto& [first, end] : runs_of(question)) {
    for (std::uint32_t i = first; i + 1 < end; ++i) {
      if (has(known, question.number_of(i))) continue;
      steps.push_back({i, std::sqrt(squared_distance(poses[i].position(), poses[i + 1].position())),
                       motion_of_step(poses[i], poses[i + 1], question.model).across});
    }
  }
  return steps;
}

/// The steps as stretches of the path, each from the pose where steps begin to that where they end.
std::vector<PoseRange> stretches_of(const Question& question, const std::vector<LoadStep>& steps) {
  const auto number = [&](const LoadStep& step) { return question.number_of(step.pose); };
  return pose_ranges(steps, 1, number);
}

void warn_of_gaps(const Question& question, std::vector<LoadStep> steps, double length,
                  MessageLog& log) {
  std::erase_if(steps, [&](const LoadStep& step) { return !exceeds(step.length, length); });
  const LoadStep longest = *std::ranges::max_element(steps, {}, &LoadStep::length);
  const SectionParameters& asked = *question.section;
  log.warn("large-steps",
           "the longest step, from pose " + std::to_string(question.number_of(longest.pose)) +
               ", is " + question.length(longest.length) + " and the load is " +
               question.length(asked.front - asked.rear) +
               " long: what lies between two poses may block nothing",
           {{"step", longest.length}, {"length", length}}, stretches_of(question, steps));
}

/// Warns where the load moves across by more than what matters on a step, and notes where by more
/// than two cells. While a point is in the range of the load, it is seen at every pose; but where
/// it comes into the range between two poses, or leaves it, it may have reached deeper by as much.
void check_across(const Question& question, std::vector<LoadStep> steps, MessageLog& log) {
  constexpr double kCellsToBeNoted = 2;
  const double matters = least_motion(question), noted = kCellsToBeNoted * question.section->cell;
  const auto all = steps.size();
  const LoadStep worst = *std::ranges::max_element(steps, {}, &LoadStep::across);
  const bool warns = worst.across > matters;
  const double least = warns ? matters : noted;
  std::erase_if(steps, [&](const LoadStep& step) { return !(step.across > least); });
  if (steps.empty()) return;
  log.add(warning_or_note(
      warns, "large-steps",
      "at " + format_count(steps.size()) + " of " + counted(all, "step") +
          " the load turns so far that it moves across by more than " + question.length(least) +
          ": by up to " + question.length(worst.across) + " after pose " +
          std::to_string(question.number_of(worst.pose)) + ", where it goes on by " +
          question.length(worst.length) +
          ". What comes beside it between two poses can reach deeper into it than at either",
      {{"share", static_cast<double>(steps.size()) / static_cast<double>(all)},
       {"largest", worst.across},
       {"pose", static_cast<double>(question.number_of(worst.pose))},
       {"step", worst.length}},
      stretches_of(question, steps)));
}

/// Warns of what the load of a section passes between two poses, of which only the poses are
/// searched. known: steps that another warning is given for.
void check_load_at_poses(const Question& question, const Steps& known, MessageLog& log) {
  std::vector<LoadStep> steps = steps_of_load(question, known);
  if (steps.empty()) return;
  const SectionParameters& asked = *question.section;
  const double length = asked.front - asked.rear + 2 * asked.margin;
  if (std::ranges::any_of(steps,
                          [&](const LoadStep& step) { return exceeds(step.length, length); })) {
    warn_of_gaps(question, std::move(steps), length, log);
  } else {
    check_across(question, std::move(steps), log);
  }
}

/// Warns where the load of a section moves across by more than a cell between two poses, because
/// with motion between poses a check keeps half of that.
void check_growth(const Question& question, MessageLog& log) {
  const SectionParameters& asked = *question.section;
  const SectionMotion motion = section_motion(question.query.poses, asked);
  if (!(motion.across > asked.cell)) return;
  log.warn("motion-exceeds-cell",
           "from a pose to the next the load moves by up to " + question.length(motion.across) +
               " across, and the cells are " + question.length(asked.cell) +
               ": a check keeps half of that motion as a distance, so it stops loads that "
               "pass. Poses that are closer together keep less",
           {{"along", motion.along}, {"across", motion.across}});
}

Steps starts_of(const std::vector<Jump>& jumps) {
  Steps steps;
  for (const Jump& jump : jumps) steps.push_back(static_cast<std::uint32_t>(jump.pose));
  return steps;
}

void warn_of_jumps(const Question& question, std::vector<Jump> jumps, const Steps& warned,
                   const std::string& prefix, MessageLog& log) {
  std::erase_if(
      jumps, [&](const Jump& jump) { return has(warned, static_cast<std::uint32_t>(jump.pose)); });
  if (jumps.empty()) return;
  log.add(jump_warning(jumps, prefix, unit_name(question.unit),
                       question.query.between_poses ? std::string(". The ") + question.mover() +
                                                          " is searched on the straight way there"
                                                    : ". Nothing is searched on the way there"));
}

Steps united_steps(const Steps& a, const Steps& b) {
  Steps out;
  std::ranges::set_union(a, b, std::back_inserter(out));
  return out;
}

}  // namespace

StepChecks::StepChecks(const Question& path) : path_jumps_(starts_of(jumps_in(path))) {}

void StepChecks::check(const Question& question, MessageLog& log) {
  const std::vector<Jump> jumps = jumps_in(question);
  if (question.query.between_poses) {
    if (question.is_load()) check_growth(question, log);
    warned_ = united_steps(warned_, check_straight_ways(question, jumps, log));
  } else if (question.is_load()) {
    check_load_at_poses(question, starts_of(jumps), log);
  } else {
    check_poses_alone(question, united_steps(path_jumps_, starts_of(jumps)), log);
  }
  warn_of_jumps(question, jumps, united_steps(warned_, path_jumps_), "", log);
}

void StepChecks::check_path(const Question& path, MessageLog& log) const {
  warn_of_jumps(path, jumps_in(path), warned_, "the path: ", log);
}

namespace {

// The least shares of the motion along one axis of the model. 0.9 means 18 degrees aside on
// average.
constexpr double kAlongAxis = 0.9;
constexpr double kSurelyAlongAxis = 0.95;

double greatest_share(const Vec3& shares) { return std::max({shares.x, shares.y, shares.z}); }

bool warn_of_rotations(const Question& question, const Drive& drive, MessageLog& log) {
  const double share = greatest_share(drive.along_axes());
  if (share >= kAlongAxis) return false;
  constexpr double kTurns = 0.97;
  const bool still = drive.never_turns() && drive.straightness() < kTurns;
  const std::string why =
      still ? "All rotations are the same although the path turns: do the poses lack their "
              "rotations?"
            : "Check order, sign and zero direction of the angles, and the frame that the poses "
              "are of";
  log.warn("rotations",
           "the " + question.mover() + " does not move along one of its own axes: only " +
               share_text(share) + " of the motion is along the likeliest. " + why,
           {{"share", share}});
  return true;
}

bool warn_of_tilt(const Question& question, const Drive& drive, MessageLog& log) {
  const double upright = drive.upright();
  constexpr double kTilted = 0.5;  // 60 degrees on average
  if (upright >= kTilted) return false;
  log.warn("tilted",
           "the " + question.mover() + "'s z axis " +
               (upright < -kTilted ? "points down" : "does not point up") +
               " along the path: the poses seem to be of a frame with other axes, such as a "
               "camera's, or with z down",
           {{"mean_z", upright}});
  return true;
}

/// Warns where the model leans steadily to one side. Roads bank by 4 degrees at most, and rails by
/// 7 degrees in curves, towards the inside.
void warn_of_lean(const Question& question, const Drive& drive, MessageLog& log) {
  constexpr double kLeans = 4.5, kSteady = 1.5;  // degrees
  constexpr double kCurve = 0.8;
  std::vector<double> leans = drive.leans();
  if (leans.empty()) return;
  std::sort(leans.begin(), leans.end());
  const auto at = [&](double share) {
    return leans[static_cast<std::size_t>(share * static_cast<double>(leans.size() - 1))] / kDegree;
  };
  const double lean = at(0.5);
  if (std::abs(lean) < kLeans || at(0.95) - lean > kSteady || lean - at(0.05) > kSteady) return;
  const double right = drive.right_turns();
  if ((lean > 0 ? right : 1 - right) >= kCurve) return;  // it leans into a curve
  log.warn("leans",
           "along the whole path the " + question.mover() + " leans to the " +
               (lean > 0 ? "right" : "left") + " by " + format_digits(std::abs(lean), 3) +
               " degrees, also where it does not turn: are the poses of a scanner or an inertial "
               "unit that is mounted askew? If the ground has this slope, this is all right",
           {{"degrees", lean}});
}

void warn_of_flat_model(const Question& question, int axis, MessageLog& log) {
  log.warn("flat-model",
           "the model is flat: " + question.size() + ". It moves along its " + "xyz"[axis] +
               " axis, along which it has no length. A vehicle needs more room in curves than its "
               "profile. Give the whole vehicle",
           {{"thickness", question.model.hi[axis] - question.model.lo[axis]}});
}

void warn_sideways(const Question& question, const Drive& drive, MessageLog& log) {
  const Vec3 shares = drive.along_axes();
  if (greatest_share(shares) < kAlongAxis) return;
  const int axis = shares.x >= shares.y && shares.x >= shares.z ? 0 : shares.y >= shares.z ? 1 : 2;
  const int longest = question.model.longest_axis();
  constexpr double kLonger = 1.3;
  const double side = question.model.hi[axis] - question.model.lo[axis];
  const double other = question.model.hi[longest] - question.model.lo[longest];
  constexpr double kFlatSide = 0.01;
  if (side < kFlatSide * other) {
    warn_of_flat_model(question, axis, log);
    return;
  }
  const bool across = longest != 2 && other > kLonger * side;
  if (axis != 2 && !across) return;
  std::vector<std::pair<std::string, double>> numbers{{"share", shares[axis]}};
  if (!question.is_load()) numbers.push_back({"model_longest", Sides(question.model).longest});
  log.warn("sideways",
           "the " + question.mover() + " moves along its " + "xyz"[axis] + " axis, but " +
               (question.is_load() ? "its range is along x" : "is " + question.size()) +
               (axis == 2 ? ": z is expected to point up. " : ": it drives sideways. ") +
               (question.is_load() ? "Turn the rotations of the poses"
                                   : "Turn the model, or the rotations of the poses"),
           std::move(numbers));
}

/// Notes that the model moves backwards. This is not a mistake where the vehicle reverses, or its
/// front points along -x; otherwise its parts meet the scan on the wrong side.
void tell_backwards(const Question& question, const Drive& drive, MessageLog& log) {
  const double along = drive.forwards(0);
  if (along > -kAlongAxis) return;
  log.add(note("drives-backwards",
               "the " + question.mover() +
                   " moves backwards, against its x axis: if it does not reverse, turn the poses" +
                   (question.is_load() ? "" : " or the model") +
                   " by 180 degrees, because left and right are swapped",
               {{"share", -along}}));
}

/// Whether the poses hardly turn the model. If so, it is not a crane that slews on the spot.
bool hardly_turns(const Question& question) {
  constexpr double kThirtyDegrees = 0.866;
  const Pose& first = question.query.poses.front();
  return std::ranges::all_of(question.query.poses, [&](const Pose& pose) {
    double trace = 0;
    for (int k = 0; k < 9; ++k) trace += pose.rotation[k] * first.rotation[k];
    return (trace / (scale_of(pose) * scale_of(first)) - 1) / 2 > kThirtyDegrees;
  });
}

/// Whether the model moves as a vehicle does, although in steps that are much too small.
bool is_small_drive(const Question& question, double across) {
  constexpr double kPieces = 50;
  if (!(across > 0)) return false;
  const Drive drive(question.query, across / kPieces);
  return drive.is_one() && greatest_share(drive.along_axes()) > kSurelyAlongAxis;
}

void warn_of_tiny_path(const Question& question, MessageLog& log) {
  const auto& poses = question.query.poses;
  constexpr std::size_t kMany = 10;
  if (poses.size() < kMany) return;
  const double across = 2 * half_diagonal(box_of_positions(poses));
  const double longest = Sides(question.model).longest;
  constexpr double kHuge = 200;  // metres: a longer model has the wrong unit itself
  if (!(across < longest / 4) || longest > kHuge * question.metre) return;
  if (!hardly_turns(question) && !is_small_drive(question, across)) return;
  log.warn("tiny-path",
           "all " + format_count(poses.size()) + " poses lie within " + question.length(across) +
               ", and the " + question.mover() + " is " + question.length(longest) +
               " long: is the path in another unit, such as kilometres or degrees?",
           {{"path", across}, {"model_longest", longest}});
}

/// Whether a message of reading the trajectory says already how its rotations are wrong. The reader
/// knows more than the poses alone show, such as whether they were angles or quaternions.
bool is_diagnosed(std::span<const Message> of_inputs) {
  constexpr std::string_view kDiagnoses[] = {"rotation-missing", "rotation-too-small",
                                             "poses-inverse",    "turns-against-path",
                                             "quaternion-order", "upside-down"};
  return std::ranges::any_of(of_inputs, [&](const Message& message) {
    return std::ranges::find(kDiagnoses, message.code) != std::end(kDiagnoses);
  });
}

}  // namespace

void check_path_digits(const Question& question, MessageLog& log) {
  std::vector<Vec3> places;
  for (const Pose& pose : question.query.poses) places.push_back(pose.position());
  warn_of_single_precision(question, places, "the positions of the path",
                           "Export the path in double precision", log);
  warn_of_rounded_path(question, log);
}

void check_heading(const Question& question, std::span<const Message> of_inputs, MessageLog& log) {
  warn_of_tiny_path(question, log);
  const Drive drive(question);
  if (!drive.is_one() || is_diagnosed(of_inputs)) return;
  if (warn_of_tilt(question, drive, log) || warn_of_rotations(question, drive, log)) return;
  warn_of_lean(question, drive, log);
  warn_sideways(question, drive, log);
  tell_backwards(question, drive, log);
}

}  // namespace clearway
