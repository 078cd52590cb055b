#include "findings/searched_places.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <unordered_map>

#include "core/geometry/floor.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct PoseHash {
  std::size_t operator()(const Pose& pose) const {
    std::uint64_t hash = 0;
    const auto add = [&](double number) {
      // 0 and -0 are equal, and so have one hash.
      hash = (hash ^ std::bit_cast<std::uint64_t>(number + 0.0)) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 29;
    };
    for (const double r : pose.rotation) add(r);
    for (const double t : pose.translation) add(t);
    return hash;
  }
};

/// For each pose of a, the first pose of b that equals it; kNone where there is none.
std::vector<std::uint32_t> equal_poses(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  std::unordered_map<Pose, std::uint32_t, PoseHash> number_of;
  for (std::uint32_t i = 0; i < b.size(); ++i) number_of.try_emplace(b[i], i);
  std::vector<std::uint32_t> out;
  out.reserve(a.size());
  for (const Pose& pose : a) {
    const auto found = number_of.find(pose);
    out.push_back(found == number_of.end() ? kNone : found->second);
  }
  return out;
}

/// The distance up to which a result has points: the margin, with an error budget the near radius.
double reach_of(const ResultHeader& header) {
  return header.budget ? header.budget->near_radius(header.radius) : header.radius;
}

/// For each body, or for the model, the height in its frame from which on a result has points.
std::vector<double> lowest_of(const ResultHeader& header) {
  const double lower = reach_of(header) - header.radius;
  std::vector<double> out;
  for (const std::optional<double>& floor : header.body_floors) {
    out.push_back(floor ? *floor - lower : kNoFloor);
  }
  if (out.empty()) {
    out.assign(std::max<std::size_t>(1, header.bodies.size()),
               header.floor ? *header.floor - lower : kNoFloor);
  }
  return out;
}

/// Whether b may leave out below a floor what a judged. Bodies of one name are compared, and all
/// with all where the names differ.
bool has_higher_floor(const ResultHeader& b, const ResultHeader& a) {
  const std::vector<double> in_a = lowest_of(a), in_b = lowest_of(b);
  if (a.bodies != b.bodies) return std::ranges::max(in_b) > std::ranges::min(in_a);
  for (std::size_t i = 0; i < in_b.size(); ++i) {
    if (in_b[i] > in_a[i]) return true;
  }
  return false;
}

}  // namespace

SearchedPlaces::SearchedPlaces(const Result& a, const std::vector<Pose>& poses_a, const Result& b,
                               const std::vector<Pose>& poses_b)
    : a_(a.reader().header()),
      b_(b.reader().header()),
      same_scan_(a_.environment_points == b_.environment_points &&
                 a_.environment_hash == b_.environment_hash) {
  compare_questions(poses_a, poses_b);
  const ResultFindings &in_a = a.reader().findings(), &in_b = b.reader().findings();
  compare_ignored(in_b);
  const bool more_withheld = in_b.withheld_points > in_a.withheld_points;
  if (!same_scan_ && more_withheld) everywhere_.insert("withheld");
  take_warnings(counted_answer(a.reader()), counted_answer(b.reader()));
}

void SearchedPlaces::compare_questions(const std::vector<Pose>& poses_a,
                                       const std::vector<Pose>& poses_b) {
  const bool same_model = a_.model_hash == b_.model_hash && a_.model_points == b_.model_points &&
                          a_.model_triangles == b_.model_triangles && a_.bodies == b_.bodies &&
                          a_.model_solids <= b_.model_solids;
  if (reach_of(b_) < reach_of(a_)) everywhere_.insert("radius");
  if (has_higher_floor(b_, a_)) everywhere_.insert("floor");
  const bool same_path = a_.poses == b_.poses && a_.trajectory_hash == b_.trajectory_hash;
  if (!same_scan_) {
    if (!same_model) everywhere_.insert("model");
    if (a_.between_poses && !b_.between_poses) everywhere_.insert("motion");
    // Where a body stands may depend on the whole path.
    if (!same_path && !a_.bodies.empty()) everywhere_.insert("path");
  }
  if (same_path) return;
  pose_of_b_ = equal_poses(poses_a, poses_b);
}

void SearchedPlaces::compare_ignored(const ResultFindings& findings) {
  const bool more_classes = !std::ranges::includes(a_.ignore_classes, b_.ignore_classes);
  // The ground that both ignore collides in both. What is higher was hit, or classified anew.
  const std::uint64_t hidden =
      more_classes ? findings.ignored_colliding : findings.ignored_colliding_high;
  if (!b_.ignore_classes.empty() && hidden > 0) everywhere_.insert("ignored");
}

void SearchedPlaces::take_warnings(const Answer& a, const Answer& b) {
  for (const Message& warning : b.warnings) {
    const Doubt doubt = b.doubt_of(warning);
    if (doubt == Doubt::kQuestion) {
      everywhere_.insert(warning.code);
    } else if (doubt == Doubt::kStretch) {
      add_stretches(warning.code, warning.stretches);
    } else if (may_miss(warning.code)) {
      add_fault(a, warning);
    }
  }
}

void SearchedPlaces::add_fault(const Answer& a, const Message& warning) {
  // What a missed too, such as anything on one side of the path, b need not have found either.
  std::vector<PoseRange> in_a;
  bool any = false, whole = false;
  for (const Message& other : a.warnings) {
    if (!have_same_fault(other, warning)) continue;
    any = true;
    whole |= other.stretches.empty();
    in_a.insert(in_a.end(), other.stretches.begin(), other.stretches.end());
  }
  const bool same_path = pose_of_b_.empty();
  if (warning.stretches.empty()) {
    if (whole) return;
    if (!any || !same_path || b_.poses == 0) {
      everywhere_.insert(warning.code);
      return;
    }
    const auto last = static_cast<std::uint32_t>(b_.poses - 1);
    return add_stretches(warning.code, without({{0, last}}, in_a));
  }
  if (!same_path) return add_stretches(warning.code, warning.stretches);
  if (!whole) add_stretches(warning.code, without(warning.stretches, in_a));
}

void SearchedPlaces::add_stretches(const std::string& code,
                                   const std::vector<PoseRange>& stretches) {
  for (const PoseRange& stretch : stretches) stretches_.push_back({code, stretch});
}

std::optional<std::uint32_t> SearchedPlaces::pose_of_b(std::uint32_t pose) const {
  if (pose_of_b_.empty()) return pose;
  const std::uint32_t found = pose < pose_of_b_.size() ? pose_of_b_[pose] : kNone;
  if (found == kNone) return std::nullopt;
  // Between poses, what collides may do so on the way to the next pose.
  const bool way = a_.between_poses && pose + std::size_t{1} < pose_of_b_.size();
  if (way && pose_of_b_[pose + 1] != found + 1) return std::nullopt;
  return found;
}

void SearchedPlaces::add_reasons(const Vec3& place, std::uint32_t first, std::uint32_t last,
                                 std::set<std::string>& reasons) const {
  reasons.insert(everywhere_.begin(), everywhere_.end());
  const auto holds = [&](const Box& box) { return box.contains(place); };
  if (std::ranges::any_of(b_.ignore_boxes, holds)) reasons.insert("ignored");
  const std::optional<std::uint32_t> from = pose_of_b(first), to = pose_of_b(last);
  if (!from && !to) {
    if (!same_scan_) reasons.insert("path");
    return;
  }
  const std::uint32_t one = from ? *from : *to, other = to ? *to : *from;
  const std::uint32_t begin = std::min(one, other), end = std::max(one, other);
  for (const DoubtfulStretch& stretch : stretches_) {
    const bool meets = stretch.poses.first <= end && begin <= stretch.poses.last;
    if (meets) reasons.insert(stretch.code);
  }
}

}  // namespace clearway
