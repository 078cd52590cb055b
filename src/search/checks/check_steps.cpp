#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/rigid.hpp"
#include "core/trajectory/step_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

/// An upper bound of the way of any model point from one pose to the next, cheap because most steps
/// are short. reach: greatest distance of the model from its origin.
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
    for (Jump jump : jumps_of(steps, question.query.radius)) {
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
  const double reach = farthest_from_origin(question.query.model.vertices);
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
  const double radius = question.query.radius;
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
  std::string text =
      "at " + format_count(found.size()) + " of " + counted(steps, "step") +
      " the true motion can leave the straight way between two poses, which is "
      "what is searched, by more than " +
      (warns ? "" : "a tenth of ") + "the radius of " + length_text(radius, question.unit) +
      ": by up to " + length_text(worst.distance, question.unit) + " after pose " +
      std::to_string(number) + ", where the model goes on by " + length_text(moved, question.unit) +
      " and turns by " + figure(turned) + " degrees";
  const auto jump = std::ranges::find(jumps, std::size_t{number}, &Jump::pose);
  if (warns && jump != jumps.end()) {
    text += ". This step is " + figure(jump->length / jump->usual) +
            " times as long as those around it, so poses may be missing there";
  }
  if (warns) text += ". What is beside the straight way can be missed";
  log.add({warns ? Message::Severity::kWarning : Message::Severity::kNote,
           "large-steps",
           text,
           {{"share", static_cast<double>(found.size()) / static_cast<double>(steps)},
            {"largest", worst.distance},
            {"pose", static_cast<double>(number)},
            {"step", moved},
            {"turn_degrees", turned}}});
  Steps told;
  for (const Deviation& d : found) {
    if (warns) told.push_back(question.number_of(d.pose));
  }
  return told;
}

/// Warns where the model moves farther than the radius between two poses, of which only the poses
/// are searched. known: steps that another warning is given for.
void check_poses_alone(const Question& question, const Steps& known, MessageLog& log) {
  const Query& query = question.query;
  const Vec3 far = reach_of(question.model);
  const double reach = std::sqrt(squared_length(far.x, far.y, far.z));
  std::uint64_t large = 0;
  double largest = 0;
  std::uint64_t steps = 0;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i + 1 < query.poses.size(); ++i) {
    if (question.number_of(i + 1) != question.number_of(i) + 1) continue;  // no step
    ++steps;
    const Pose &a = query.poses[i], &b = query.poses[i + 1];
    if (coarse_bound(a, b, reach) <= query.radius) continue;
    const double step = displacement_bound(question.model, a, b);
    if (!(step > query.radius) || has(known, question.number_of(i))) continue;
    ++large;
    if (step > largest) {
      largest = step;
      at = question.number_of(i);
    }
  }
  if (large == 0) return;
  log.warn("large-steps",
           "at " + format_count(large) + " of " + format_count(steps) +
               " steps the model moves farther than the radius of " +
               length_text(query.radius, question.unit) + ", at most " +
               length_text(largest, question.unit) + " after pose " + std::to_string(at) +
               ". What lies between two poses can be missed",
           {{"share", static_cast<double>(large) / static_cast<double>(steps)},
            {"largest", largest},
            {"pose", static_cast<double>(at)}});
}

Steps starts_of(const std::vector<Jump>& jumps) {
  Steps steps;
  for (const Jump& jump : jumps) steps.push_back(static_cast<std::uint32_t>(jump.pose));
  return steps;
}

void warn_of_jumps(const Question& question, std::vector<Jump> jumps, const Steps& told,
                   const std::string& prefix, MessageLog& log) {
  std::erase_if(jumps,
                [&](const Jump& jump) { return has(told, static_cast<std::uint32_t>(jump.pose)); });
  if (jumps.empty()) return;
  log.add(jump_warning(jumps, prefix, unit_name(question.unit),
                       question.query.between_poses
                           ? ". The model is searched on the straight way there"
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
    told_ = united_steps(told_, check_straight_ways(question, jumps, log));
  } else {
    check_poses_alone(question, united_steps(path_jumps_, starts_of(jumps)), log);
  }
  warn_of_jumps(question, jumps, united_steps(told_, path_jumps_), "", log);
}

void StepChecks::check_path(const Question& path, MessageLog& log) const {
  warn_of_jumps(path, jumps_in(path), told_, "the path: ", log);
}

}  // namespace clearway
