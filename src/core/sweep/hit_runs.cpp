#include "core/sweep/hit_runs.hpp"

#include <algorithm>

#include "core/geometry/triangle.hpp"
#include "core/sweep/triangle_curve.hpp"

namespace clearway {
namespace {

/// Share of the radius compared with which a curve's error and the spacing of its poses must be
/// small, because points at a distance between the radius and the radius plus that error go to the
/// predicate.
constexpr double kSpacingOfRadius = 0.5;

}  // namespace

template <typename Element>
bool HitRuns<Element>::is_available() const {
  return kIsTriangle<Element> && model_.size() <= kMostTriangles && !sweep_.between_poses;
}

/// Counts twice as many packets as full ones would be, because packets may be half empty.
template <typename Element>
std::uint64_t HitRuns<Element>::most_bytes() const {
  if (!is_available()) return 0;
  const std::uint64_t packets = 2 * (model_.size() / PacketOf<Element>::kMost + 1);
  return motion_.nodes().size() * sizeof(MotionCurve) +
         packets * (sizeof(PacketOf<Element>) +
                    2 * (sizeof(WideBoxes::Node) + sizeof(WideBoxes::Slabs)) / WideBoxes::kWidth);
}

template <typename Element>
bool HitRuns<Element>::prepare() const {
  State seen = state_.load(std::memory_order_acquire);
  if (seen != kNotMade) return seen == kMade;
  if (!is_available() || !state_.compare_exchange_strong(seen, kBeingMade)) return false;
  make();
  state_.store(kMade, std::memory_order_release);
  return true;
}

template <typename Element>
void HitRuns<Element>::make() const {
  const double spacing = std::min(model_.spacing(), kSpacingOfRadius * sweep_.radius);
  made_.emplace(Made{
      MotionCurves(motion_, model_.box(), sweep_.radius * kRoundedUp + sweep_.rounding, spacing),
      WideTreeOf<StoredElement<Element>>(model_)});
}

template <typename Element>
bool HitRuns<Element>::is_run(std::uint32_t node) const {
  return made().curves.at(node).is_smooth();
}

template <typename Element>
void HitRuns<Element>::join(std::vector<std::uint32_t>& nodes) const {
  const auto count = static_cast<std::uint32_t>(nodes.size());
  nodes.resize(
      motion_.ref().join(nodes.data(), count, [&](std::uint32_t node) { return is_run(node); }));
}

/// If no triangle is within the ball of the curve, no triangle touches e at any pose of the run,
/// and no wall comes between e and the model on the way from one pose to the next, so that e is
/// inside at all poses or at none.
template <typename Element>
typename HitRuns<Element>::Answer HitRuns<Element>::search(const Vec3& e, std::uint32_t run,
                                                           bool any, std::uint32_t& end,
                                                           SweepStatistics& statistics) const {
  if constexpr (!kIsTriangle<Element>) {
    return Answer::kUnknown;
  } else {
    ++statistics.exact_tests;
    const MotionNode& node = motion_.nodes()[run];
    const MotionCurve smooth = made().curves.at(run);
    const double error = smooth.is_one_place() ? 0 : static_cast<double>(smooth.error);
    const double ball = sweep_.ball_around_curve(sweep_.radius * kRoundedUp + sweep_.rounding,
                                                 static_cast<double>(smooth.least), error);
    const double squared_ball = ball * ball * kRoundedUp;
    const TriangleCurve curve(sweep_.motion, node, e);
    bool is_near = false, is_hit = false;
    const auto visit_pose = [&](std::uint32_t pose, const Triangle& t) {
      if (pose >= end || !collides(e, transform(sweep_.motion.poses[pose], t), sweep_.radius) ||
          !sweep_.counts(e, pose)) {
        return false;
      }
      end = pose;
      is_hit = true;
      return any;
    };
    made().wide.ref().any_nearest_first(
        curve.hull(), [&] { return squared_ball; },
        [&](const FloatPacket& packet, float(&out)[FloatPacket::kMost]) {
          curve.to_triangles(packet, out);
        },
        [&](const FloatPacket& packet, std::uint32_t i) {
          is_near = true;
          const Triangle& t = sweep_.model.elements[packet.index[i]];
          if (smooth.is_one_place()) return visit_pose(node.first, t);
          return curve.any_place(
              packet, i, node.count, [&] { return squared_ball; },
              [&](std::uint32_t k) { return visit_pose(node.first + k, t); });
        });
    if constexpr (kIsSolid<Element>) {
      if (is_near) return is_hit && any ? Answer::kHit : Answer::kUnknown;
      const Pose& pose = sweep_.motion.poses[node.first];
      if (!sweep_.field.inside.solids.contains(pulled_back(pose, e))) return Answer::kNever;
      for (std::uint32_t i = node.first; i < std::min(end, node.first + node.count); ++i) {
        if (!sweep_.counts(e, i)) continue;
        end = i;
        return Answer::kHit;
      }
      return Answer::kNever;
    }
    return is_hit ? Answer::kHit : Answer::kNever;
  }
}

template class HitRuns<Vec3>;
template class HitRuns<Triangle>;
template class HitRuns<SolidTriangle>;

}  // namespace clearway
