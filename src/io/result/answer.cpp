#include "io/result/answer.hpp"

#include <cmath>
#include <limits>

#include "clearway/result.hpp"
#include "io/result/result_rows.hpp"

namespace clearway {
namespace {

/// Finds the first place: the row with the smallest first pose, and of several the one with the
/// smallest source, because rows ascend by source.
void fold_collisions(const ResultReader& result, Answer& answer) {
  if (!result.header().first_pose) return;
  std::optional<FoundPlace>& first = answer.first_place;
  ResultRowStream stream(result);
  for (ResultRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (first && rows.first_pose[i] >= first->pose) continue;
      first = {rows.source[i], rows.first_pose[i], rows.xyz[i], 0,
               rows.body.empty() ? 0 : rows.body[i]};
    }
  }
}

void fold_clearances(const ResultReader& result, Answer& answer) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::optional<FoundPlace>& least = answer.least_clearance;
  ClearanceRowStream stream(result);
  for (ClearanceRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows.distance[i] < 0) ++answer.inside_points;
      if (least && rows.distance[i] >= least->distance) continue;
      least = {rows.source[i], rows.pose[i],
               rows.xyz.empty() ? Vec3{kNone, kNone, kNone} : rows.xyz[i], rows.distance[i],
               rows.body.empty() ? 0 : rows.body[i]};
    }
  }
}

void fold_profile(const ResultReader& result, Answer& answer) {
  std::optional<FoundPlace>& least = answer.least_profile;
  std::uint32_t pose = 0;
  ProfileRowStream stream(result);
  for (ProfileRows rows; stream.read(rows);) {
    for (std::size_t i = 0; i < rows.size(); ++i, ++pose) {
      if (rows.source[i] == Profile::kNoPoint) continue;
      ++answer.profile_poses;
      if (least && rows.distance[i] >= least->distance) continue;
      least = {rows.source[i], pose, rows.xyz[i], rows.distance[i]};
    }
  }
}

/// The doubts that follow from the header's counts, for files of earlier releases, which kept none.
std::vector<Message> doubts_by_counts(const ResultHeader& header) {
  std::vector<Message> doubts;
  const auto add = [&](const char* code) {
    doubts.push_back({Message::Severity::kWarning, code, ""});
  };
  if (header.environment_points == 0) add("no-points");
  if (header.poses == 0) add("no-poses");
  if (header.ignored.points > 0 && header.ignored.points == header.environment_points) {
    add("all-ignored");
  }
  return doubts;
}

}  // namespace

Answer answer_of(const ResultHeader& header) {
  Answer answer;
  answer.parameters = header;
  answer.environment_points = header.environment_points;
  answer.model_points = header.model_points;
  answer.poses = header.poses;
  answer.model_solids = header.model_solids;
  answer.model_spacing = header.model_spacing.metres;
  answer.ignored = header.ignored;
  if (header.ignores_points()) {
    answer.ignored_colliding.reset();
    answer.ignored_colliding_high.reset();
  }
  answer.bodies = header.bodies;
  if (header.part) answer.shard = header.part->shard;
  answer.float_precision = header.float_precision;
  return answer;
}

void add_doubts(const std::vector<Message>& warnings, Answer& answer) {
  std::vector<Message> all = warnings;
  for (const std::string& code : answer.doubts) {
    all.push_back({Message::Severity::kWarning, code, ""});
  }
  answer.doubts = doubts_among(all);
}

void add_findings(const ResultFindings& findings, Answer& answer) {
  answer.doubts = findings.doubts;
  answer.searched = findings.searched;
  if (!answer.parameters.ignores_points()) return;
  answer.ignored_colliding = findings.ignored_colliding;
  answer.ignored_colliding_high = findings.ignored_colliding_high;
}

Answer counted_answer(const ResultReader& result) {
  Answer answer = answer_of(result.header());
  add_findings(result.findings(), answer);
  add_doubts(doubts_by_counts(result.header()), answer);
  if (result.header().part) add_doubts(result.header().part->warnings, answer);
  answer.colliding_points = result.collisions();
  answer.clearance_points = result.clearances();
  return answer;
}

Answer answer_of(const ResultReader& result) {
  Answer answer = counted_answer(result);
  fold_collisions(result, answer);
  fold_clearances(result, answer);
  fold_profile(result, answer);
  return answer;
}

}  // namespace clearway
