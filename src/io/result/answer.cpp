#include "io/result/answer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "clearway/result.hpp"
#include "core/query/point_classes.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// Takes a place if it is the first one that is found, or less than the least so far.
template <typename IsLess>
void keep_least(const FoundPlace& place, std::optional<FoundPlace>& least, IsLess is_less) {
  if (!least || is_less(place, *least)) least = place;
}

bool is_earlier(const FoundPlace& a, const FoundPlace& b) { return a.pose < b.pose; }
bool is_nearer(const FoundPlace& a, const FoundPlace& b) { return a.distance < b.distance; }

/// Takes a point if it is the first one that is found, or deeper than the deepest so far.
void keep_deepest(const DeepestPoint& point, std::optional<DeepestPoint>& deepest) {
  if (!deepest || point.depth > deepest->depth) deepest = point;
}

/// The class of a row's point; nullopt where the scans have none.
template <typename Rows>
std::optional<std::uint8_t> class_of(const Rows& rows, std::size_t i) {
  return rows.point_class.empty() ? std::nullopt : std::optional(rows.point_class[i]);
}

/// The body of a row; 0 for one model.
template <typename Rows>
std::uint32_t body_of(const Rows& rows, std::size_t i) {
  return rows.body.empty() ? 0 : rows.body[i];
}

template <typename Rows>
void summarise_table(const ResultReader& result, TableSummary& summary) {
  RowStream<Rows> stream(result);
  for (Rows rows; stream.read(rows);) summarise(rows, summary);
}

}  // namespace

void summarise(const Collisions& rows, TableSummary& summary) {
  summary.colliding_points += rows.size();
  count_classes(rows.point_class, summary.classes);
  for (std::size_t i = 0; i < rows.depth.size(); ++i) {
    if (rows.depth_source[i] == Collisions::kNoPoint) continue;
    keep_deepest({rows.depth[i], rows.source[i], rows.xyz[i], rows.depth_source[i]},
                 summary.deepest);
  }
  const auto earliest = std::ranges::min_element(rows.first_pose);
  if (earliest == rows.first_pose.end()) return;
  const auto i = static_cast<std::size_t>(earliest - rows.first_pose.begin());
  keep_least({rows.source[i], *earliest, rows.xyz[i], 0, body_of(rows, i), class_of(rows, i)},
             summary.first_place, is_earlier);
}

void summarise(const Nearby& rows, TableSummary& summary) {
  summary.near_points += rows.size();
  count_classes(rows.point_class, summary.classes);
}

void summarise(const Clearances& rows, TableSummary& summary) {
  summary.clearance_points += rows.size();
  summary.inside_points += static_cast<std::uint64_t>(
      std::ranges::count_if(rows.distance, [](double distance) { return distance < 0; }));
  const auto nearest = std::ranges::min_element(rows.distance);
  if (nearest == rows.distance.end()) return;
  const auto i = static_cast<std::size_t>(nearest - rows.distance.begin());
  keep_least(
      {rows.source[i], rows.pose[i], rows.xyz[i], *nearest, body_of(rows, i), class_of(rows, i)},
      summary.least_clearance, is_nearer);
}

void summarise(const Profile& rows, TableSummary& summary, std::uint64_t first_pose) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.source[i] == Profile::kNoPoint) continue;
    ++summary.profile_poses;
    keep_least({rows.source[i], static_cast<std::uint32_t>(first_pose + i), rows.xyz[i],
                rows.distance[i], 0, class_of(rows, i)},
               summary.least_profile, is_nearer);
  }
}

void add_summary(const TableSummary& later, TableSummary& summary) {
  summary.colliding_points += later.colliding_points;
  summary.near_points += later.near_points;
  summary.clearance_points += later.clearance_points;
  summary.inside_points += later.inside_points;
  summary.profile_poses += later.profile_poses;
  for (const auto& [value, points] : later.classes) summary.classes[value] += points;
  const auto keep = [](const std::optional<FoundPlace>& place, std::optional<FoundPlace>& least,
                       auto is_less) {
    if (place) keep_least(*place, least, is_less);
  };
  if (later.deepest) keep_deepest(*later.deepest, summary.deepest);
  keep(later.first_place, summary.first_place, is_earlier);
  keep(later.least_clearance, summary.least_clearance, is_nearer);
  keep(later.least_profile, summary.least_profile, is_nearer);
}

Answer answer_of(const ResultHeader& header) {
  Answer answer;
  answer.parameters = header;
  answer.environment_points = header.environment_points;
  answer.model_points = header.model_points;
  answer.poses = header.poses;
  answer.model_solids = header.model_solids;
  answer.model_spacing = header.notes.model_spacing;
  answer.ignored = header.ignored;
  answer.budget = header.budget;
  answer.bodies = header.bodies;
  answer.body_floors = header.body_floors;
  if (header.part) answer.shard = header.part->shard;
  return answer;
}

bool say_the_same(const Message& a, const Message& b) {
  return a.code == b.code && a.text == b.text && a.stretches.empty() == b.stretches.empty();
}

void unite_stretches(const Message& other, Message& message) {
  if (other.stretches == message.stretches) return;
  std::vector<PoseRange> all = message.stretches;
  all.insert(all.end(), other.stretches.begin(), other.stretches.end());
  message.stretches = united_ranges(std::move(all));
}

void add_warnings(const std::vector<Message>& messages, std::vector<Message>& warnings) {
  for (const Message& message : messages) {
    if (message.severity != Message::Severity::kWarning) continue;
    const auto known = std::ranges::find_if(
        warnings, [&](const Message& other) { return say_the_same(other, message); });
    if (known == warnings.end()) {
      warnings.push_back(message);
    } else {
      unite_stretches(message, *known);
    }
  }
}

void add_findings(const ResultFindings& findings, Answer& answer) {
  answer.warnings = findings.warnings;
  answer.searched = findings.searched;
  answer.certain = findings.certain.value_or(CertainPoints{});
  answer.seen = findings.seen;
  answer.floor_colliding = findings.floor_colliding;
  answer.ignored_colliding = findings.ignored_colliding;
  answer.ignored_colliding_high = findings.ignored_colliding_high;
}

Answer counted_answer(const ResultReader& result) {
  Answer answer = answer_of(result.header());
  add_findings(result.findings(), answer);
  answer.colliding_points = result.collisions();
  answer.near_points = result.near();
  answer.clearance_points = result.clearances();
  return answer;
}

Answer answer_of(const ResultReader& result) {
  Answer answer = counted_answer(result);
  TableSummary summary;
  const ResultHeader& header = result.header();
  if (header.first_pose || header.depth || header.has_classes()) {
    summarise_table<Collisions>(result, summary);
  } else {
    summary.colliding_points = result.collisions();  // no row says more
  }
  summarise_table<Nearby>(result, summary);
  summarise_table<Clearances>(result, summary);
  std::uint64_t pose = 0;
  RowStream<ProfileRows> stream(result);
  for (ProfileRows rows; stream.read(rows); pose += rows.size()) summarise(rows, summary, pose);
  static_cast<TableSummary&>(answer) = summary;
  return answer;
}

}  // namespace clearway
