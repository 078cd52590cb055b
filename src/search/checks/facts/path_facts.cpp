#include "search/checks/facts/path_facts.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/trajectory/trajectory_summary.hpp"

namespace clearway {
namespace {

std::array<double, 9> unscaled(const Pose& pose) {
  std::array<double, 9> out{};
  const double scale = scale_of(pose);
  for (std::size_t k = 0; k < 9; ++k) out[k] = pose.rotation[k] / scale;
  return out;
}

/// The shortest piece in metres: farther than positions wander while a vehicle stands.
constexpr double kShortest = 0.5;

}  // namespace

Drive::Drive(const Question& question)
    : Drive(question.query,
            std::max(Sides(question.model).longest / 2, kShortest * question.metre)) {}

Drive::Drive(const Query& query, double length) {
  for (const Chord& chord : chords_of(query.poses, length)) {
    pieces_.push_back({chord.direction, unscaled(query.poses[chord.middle])});
  }
}

Vec3 Drive::along_axes() const {
  Vec3 shares{};
  double sum = 0;
  for (const Piece& piece : pieces_) {
    const auto& r = piece.rotation;
    const Vec3& d = piece.direction;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = r[k] * d.x + r[3 + k] * d.y + r[6 + k] * d.z;
      shares[static_cast<int>(k)] += along * along;
      sum += along * along;
    }
  }
  return {shares.x / sum, shares.y / sum, shares.z / sum};
}

double Drive::forwards(int axis) const {
  double sum = 0;
  for (const Piece& piece : pieces_) {
    const auto& r = piece.rotation;
    const Vec3& d = piece.direction;
    const auto k = static_cast<std::size_t>(axis);
    sum += r[k] * d.x + r[3 + k] * d.y + r[6 + k] * d.z;
  }
  return sum / static_cast<double>(pieces_.size());
}

double Drive::upright() const {
  double sum = 0;
  for (const Piece& piece : pieces_) sum += piece.rotation[8];
  return sum / static_cast<double>(pieces_.size());
}

double Drive::straightness() const {
  // The greatest eigenvalue of the sum of d d^T, by the power method.
  double m[3][3] = {};
  for (const Piece& piece : pieces_) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m[i][j] += piece.direction[i] * piece.direction[j];
    }
  }
  Vec3 v{1, 0.9, 0.8};
  double length = 0;
  for (int step = 0; step < 32; ++step) {
    Vec3 next{};
    for (int i = 0; i < 3; ++i) next[i] = m[i][0] * v.x + m[i][1] * v.y + m[i][2] * v.z;
    length = std::sqrt(squared_length(next.x, next.y, next.z));
    v = {next.x / length, next.y / length, next.z / length};
  }
  return length / static_cast<double>(pieces_.size());
}

std::vector<double> Drive::leans() const {
  std::vector<double> leans;
  for (const Piece& piece : pieces_) {
    const Vec3& d = piece.direction;
    const double level = std::hypot(d.x, d.y);
    if (!(level > 0)) continue;
    const double to_right = (piece.rotation[2] * d.y - piece.rotation[5] * d.x) / level;
    leans.push_back(std::asin(std::clamp(to_right, -1.0, 1.0)));
  }
  return leans;
}

double Drive::right_turns() const {
  constexpr double kHardly = 0.1;  // radians
  double right = 0, all = 0;
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    const Vec3 &a = pieces_[i - 1].direction, &b = pieces_[i].direction;
    const double turn = std::atan2(a.y * b.x - a.x * b.y, a.x * b.x + a.y * b.y);
    right += std::max(turn, 0.0);
    all += std::abs(turn);
  }
  return all < kHardly ? 0.5 : right / all;
}

bool Drive::never_turns() const {
  constexpr double kNoise = 0.02;
  return std::ranges::all_of(pieces_, [&](const Piece& piece) {
    for (std::size_t k = 0; k < 9; ++k) {
      if (std::abs(piece.rotation[k] - pieces_[0].rotation[k]) > kNoise) return false;
    }
    return true;
  });
}

namespace {

/// At most this many poses are searched for gaps of the scan.
constexpr std::size_t kCoverPoses = 16'384;
constexpr std::size_t kMeasuredPoses = 64;
// The next three lengths are in metres.
constexpr double kFar = 10;
constexpr double kNear = 3;
constexpr double kLongestBlock = 5;
/// Where a gap is known, it begins where the scan is farther away than this, metres.
constexpr double kRim = 1;
/// The scan has a gap where it is this many times farther away than is usual on the path.
constexpr double kUnusual = 4;

}  // namespace

std::vector<std::uint32_t> spread_poses(std::size_t poses, std::size_t most) {
  const std::size_t count = std::min(poses, most);
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(static_cast<std::uint32_t>(count == 1 ? 0 : i * (poses - 1) / (count - 1)));
  }
  return out;
}

Box body_slice(const Box& model) {
  Box slice = model;
  const int axis = model.longest_axis();
  const Vec3 centre = model.centre();
  const double half = Sides(model).middle / 2;
  slice.lo[axis] = centre[axis] - half;
  slice.hi[axis] = centre[axis] + half;
  return slice;
}

PathCover::PathCover(const Question& question)
    : scan_(question.cloud, kLongestBlock * question.metre) {
  const double asked = std::max(question.query.radius, question.query.clearance);
  const double coarse = std::max(asked, kUnusual * scan_.typical_block());
  far_ = std::max({kFar * question.metre, Sides(question.model).longest / 2, coarse});
  measure(question);
  reach_ = std::max(std::clamp(kUnusual * usual_, kNear * question.metre, far_), coarse);
  look(question);
  extend_stretches(question);
}

void PathCover::measure(const Question& question) {
  const Box slice = body_slice(question.model);
  std::vector<double> distances;
  for (const std::uint32_t i : spread_poses(question.query.poses.size(), kMeasuredPoses)) {
    distances.push_back(scan_.nearest(moved(slice, question.query.poses[i]), far_).distance);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  usual_ = *middle;
}

void PathCover::look(const Question& question) {
  const Box slice = body_slice(question.model);
  const std::vector<Pose>& poses = question.query.poses;
  std::uint32_t before = 0;
  bool was_outside = false;
  for (const std::uint32_t i : spread_poses(poses.size(), kCoverPoses)) {
    const bool is_outside = !scan_.within(moved(slice, poses[i]), reach_);
    const double way = clearway::length(poses[i].position() - poses[before].position());
    length_ += way;
    length_outside_ += way * (int{was_outside} + int{is_outside}) / 2;
    if (is_outside && !was_outside) stretches_outside_.push_back({i == 0 ? 0 : before + 1, i});
    if (was_outside) stretches_outside_.back().last = is_outside ? i : i - 1;
    before = i;
    was_outside = is_outside;
    ++looked_at_;
    if (!is_outside) continue;
    if (outside_ == 0) first_outside_ = i;
    last_outside_ = i;
    ++outside_;
  }
}

/// Poses less than `reach()` beyond the end of the scan are no gap by themselves, but belong to the
/// gap that follows.
void PathCover::extend_stretches(const Question& question) {
  const Box slice = body_slice(question.model);
  const std::vector<Pose>& poses = question.query.poses;
  const double rim = std::min(reach_, std::max(kUnusual * usual_, kRim * question.metre));
  const auto is_beyond = [&](std::size_t i) { return !scan_.within(moved(slice, poses[i]), rim); };
  std::vector<PoseRange> all;
  for (PoseRange stretch : stretches_outside_) {
    const std::uint32_t least = all.empty() ? 0 : all.back().last + 1;
    while (stretch.first > least && is_beyond(stretch.first - 1)) --stretch.first;
    while (stretch.last + std::size_t{1} < poses.size() && is_beyond(stretch.last + 1)) {
      ++stretch.last;
    }
    if (!all.empty() && stretch.first <= all.back().last + 1) {
      all.back().last = std::max(all.back().last, stretch.last);
    } else {
      all.push_back(stretch);
    }
  }
  stretches_outside_ = std::move(all);
}

}  // namespace clearway
