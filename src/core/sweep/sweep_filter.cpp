#include "core/sweep/sweep_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/query/search_result.hpp"
#include "core/sweep/tolerance.hpp"
#include "core/util/bit_reversal_order.hpp"

namespace clearway {
namespace {

using Verdict = SweepVerdict;

double rounding_of(const Query& query, double radius, const MotionTree& motion,
                   const ModelField& field, const PackedCloud& cloud) {
  // Rounding of the question for the inside, expressed as an additional margin of the lattice.
  const double lattice = field.margin() + field.inside_rounding() / (1024 * kUnitRoundoff);
  const double rounding = motion.rounding(largest_coordinate(cloud) + radius, lattice) + 1e-150;
  // Between poses: the part of a computed hit's error that does not grow with the step.
  return query.between_poses ? rounding + 8 * kUnitRoundoff * query.radius : rounding;
}

/// Bound on d x in squared spacings (measured): at a distance d from a surface, a curve that is
/// wrong by x leaves the model points of a strip of width sqrt(8 d x) open.
constexpr double kOpenArea = 1;

/// Share of the clearance compared with which a curve must be straight, too, because a triangle may
/// be longer than the clearance asked for.
constexpr double kSpacingOfClearance = 0.25;

template <typename Element>
double spacing_of(const ModelTreeOf<Element>& model, double clearance) {
  if (!kIsTriangle<Element> || !(clearance > 0)) return model.spacing();
  return std::min(model.spacing(), kSpacingOfClearance * clearance);
}

/// Number of tests beyond which a point grazes the model, so that its neighbours in the block are
/// searched in runs of poses (measured).
constexpr std::uint64_t kGrazingTests = 128;

/// Number of other tests that take as long as one exact test.
constexpr std::uint64_t kTestsOfExact = 4;

}  // namespace

template <typename Element>
SweepFilterOf<Element>::SweepFilterOf(const Query& query, const MotionTree& motion,
                                      const ModelTreeOf<StoredElement<Element>>& model,
                                      const ModelField& field, const PackedCloud& cloud,
                                      int threads, double tolerance)
    : query_(query),
      motion_(motion),
      model_(model),
      ref_{.motion = motion.ref(),
           .model = model.ref(),
           .field = field.ref(),
           .wide = {},
           .radius = search_radius(query.radius, tolerance),
           .resolved_from = query.radius,
           .clearance = query.clearance,
           .profile = query.profile,
           .open_area =
               kOpenArea * spacing_of(model, query.clearance) * spacing_of(model, query.clearance),
           .rounding =
               rounding_of(query, search_radius(query.radius, tolerance), motion, field, cloud),
           .first_pose = query.first_pose,
           .between_poses = query.between_poses},
      runs_(motion, model, ref_) {
  if (query.clearance > 0) {
    curves_ = MotionCurves(motion, model.box(), query.clearance * kRoundedUp + ref_.rounding,
                           spacing_of(model, query.clearance), threads);
    ref_.motion.curves = curves_.data();
    wide_ = WideTreeOf<StoredElement<Element>>(model);
    ref_.wide = wide_.ref();
  }
  for_plan_ = ref_;
  for_plan_.field = field.ref_as_made();
}

template <typename Element>
bool SweepFilterOf<Element>::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                                    std::vector<std::uint32_t>& out,
                                    SweepStatistics& statistics) const {
  return narrow(ref_, box, nodes, {0, ref_.accepts_boxes()}, out, statistics);
}

template <typename Element>
void SweepFilterOf<Element>::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                                    std::vector<std::uint32_t>& out) const {
  SweepStatistics not_counted;
  narrow(for_plan_, box, nodes, {ref_.profile * kRoundedUp, false}, out, not_counted);
}

/// Descends from `nodes` for a box. limits.distance: a distance within which every pose matters at
/// least.
template <typename Element>
bool SweepFilterOf<Element>::narrow(const SweepRefOf<Element>& ref, const Box& box,
                                    std::span<const std::uint32_t> nodes, Limits limits,
                                    std::vector<std::uint32_t>& out, SweepStatistics& statistics) {
  out.clear();
  const PointBox points(box);
  limits.distance = std::max(
      limits.distance,
      ref.clearance > 0 ? ref.clearance_limit(points.centre, points.rho, nodes.data(),
                                              static_cast<std::uint32_t>(nodes.size()), statistics)
                        : ref.radius);
  return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
    return narrow_node(ref, points, limits, node, out, statistics);
  });
}

template <typename Element>
bool SweepFilterOf<Element>::narrow_node(const SweepRefOf<Element>& ref, const PointBox& points,
                                         const Limits& limits, std::uint32_t index,
                                         std::vector<std::uint32_t>& out,
                                         SweepStatistics& statistics) {
  ++statistics.node_tests;
  const MotionNode& node = ref.motion.nodes[index];
  switch (ref.classify_box(node, points, limits.distance, limits.accept)) {
    case SweepBoxClass::kDismissed:
      return false;
    case SweepBoxClass::kAccepted:
      return true;
    case SweepBoxClass::kKept:
      out.push_back(index);
      return false;
    case SweepBoxClass::kSplit:
      break;
  }
  return narrow_node(ref, points, limits, index + 1, out, statistics) ||
         narrow_node(ref, points, limits, node.later, out, statistics);
}

template <typename Element>
Verdict SweepFilterOf<Element>::test(const Vec3& e, const MotionNode& node,
                                     SweepStatistics& statistics, double& squared_lower) const {
  const Verdict verdict = ref_.look(e, node, statistics, squared_lower);
  if (verdict != Verdict::kOpen || node.count > 1) return verdict;
  ++statistics.exact_tests;
  return ref_.collides_at(e, node) ? Verdict::kHitAtMid : Verdict::kDismissed;
}

/// Tests the middle poses of all nodes first, those far apart first, because most points that
/// collide do so at one of them; then searches the nodes that stayed open, in halves.
template <typename Element>
bool SweepFilterOf<Element>::touches(const Vec3& e, std::span<const std::uint32_t> nodes,
                                     SweepStatistics& statistics) const {
  ++statistics.points_tested;
  double squared_lower = 0;
  while (!nodes.empty()) {
    const std::span part =
        nodes.first(std::min<std::size_t>(nodes.size(), BitReversalOrder::kMost));
    nodes = nodes.subspan(part.size());
    std::uint64_t open = 0;  // the nodes that stayed open, as bits
    bool hit = false;
    BitReversalOrder(static_cast<std::uint32_t>(part.size())).for_each([&](std::uint32_t i) {
      const Verdict verdict = test(e, motion_.nodes()[part[i]], statistics, squared_lower);
      hit = verdict == Verdict::kHitAtMid;
      open |= std::uint64_t{verdict == Verdict::kOpen} << i;
      return !hit;
    });
    if (hit) return true;
    for (; open != 0; open &= open - 1) {
      const std::uint32_t node = part[static_cast<std::size_t>(std::countr_zero(open))];
      if (touches_below(e, node, statistics)) return true;
    }
  }
  return false;
}

/// Tests both halves of an open node, then goes into the nearer one first.
template <typename Element>
bool SweepFilterOf<Element>::touches_below(const Vec3& e, std::uint32_t index,
                                           SweepStatistics& statistics) const {
  const MotionNode* nodes = motion_.nodes().data();
  std::uint32_t half[2] = {index + 1, nodes[index].later};
  double squared[2];
  bool open[2];
  for (int i = 0; i < 2; ++i) {
    const Verdict verdict = test(e, nodes[half[i]], statistics, squared[i]);
    if (verdict == Verdict::kHitAtMid) return true;
    open[i] = verdict == Verdict::kOpen;
  }
  const int nearer = squared[1] < squared[0] ? 1 : 0;
  return (open[nearer] && touches_below(e, half[nearer], statistics)) ||
         (open[1 - nearer] && touches_below(e, half[1 - nearer], statistics));
}

template <typename Element>
std::uint32_t SweepFilterOf<Element>::first_pose(const Vec3& e,
                                                 std::span<const std::uint32_t> nodes,
                                                 SweepStatistics& statistics) const {
  ++statistics.points_tested;
  std::uint32_t best = HitSet::kNever;
  for (const std::uint32_t node : nodes) {
    if (motion_.nodes()[node].first >= best) break;
    first_pose_below(e, node, best, statistics);
  }
  return best;
}

/// Lowers `best` to the least pose of the node whose way touches e, if that is less.
template <typename Element>
void SweepFilterOf<Element>::first_pose_below(const Vec3& e, std::uint32_t index,
                                              std::uint32_t& best,
                                              SweepStatistics& statistics) const {
  const MotionNode& node = motion_.nodes()[index];
  if (node.first >= best) return;
  const Verdict verdict = ref_.look(e, node, statistics);
  if (verdict == Verdict::kDismissed) return;
  if (verdict == Verdict::kHitAtMid) best = std::min(best, ref_.first_pose_of_hit(node.mid));
  if (node.count > 1) {
    first_pose_below(e, index + 1, best, statistics);
    first_pose_below(e, node.later, best, statistics);
  } else if (verdict == Verdict::kOpen) {
    ++statistics.exact_tests;
    if (ref_.collides_at(e, node)) best = node.first;
  }
}

template <typename Element>
bool SweepFilterOf<Element>::join_runs(const SweepStatistics& of_point,
                                       std::span<const std::uint32_t> nodes,
                                       std::vector<std::uint32_t>& runs) const {
  const std::uint64_t tests = of_point.point_tests + kTestsOfExact * of_point.exact_tests;
  if (tests <= kGrazingTests || !runs_.prepare()) return false;
  runs.assign(nodes.begin(), nodes.end());
  runs_.join(runs);
  return true;
}

template <typename Element>
bool SweepFilterOf<Element>::touches_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                                          SweepStatistics& statistics) const {
  using Answer = typename HitRuns<Element>::Answer;
  ++statistics.points_tested;
  for (const std::uint32_t index : nodes) {
    const MotionNode& node = motion_.nodes()[index];
    double squared_lower = 0;
    const Verdict verdict = test(e, node, statistics, squared_lower);
    if (verdict == Verdict::kHitAtMid) return true;
    if (verdict == Verdict::kDismissed) continue;
    std::uint32_t end = HitSet::kNever;
    const Answer answer =
        runs_.is_run(index) ? runs_.search(e, index, true, end, statistics) : Answer::kUnknown;
    if (answer == Answer::kHit) return true;
    if (answer == Answer::kUnknown && touches_below(e, index, statistics)) return true;
  }
  return false;
}

template <typename Element>
std::uint32_t SweepFilterOf<Element>::first_pose_of_runs(const Vec3& e,
                                                         std::span<const std::uint32_t> nodes,
                                                         SweepStatistics& statistics) const {
  using Answer = typename HitRuns<Element>::Answer;
  ++statistics.points_tested;
  std::uint32_t best = HitSet::kNever;
  for (const std::uint32_t index : nodes) {
    const MotionNode& node = motion_.nodes()[index];
    if (node.first >= best) break;
    const Verdict verdict = ref_.look(e, node, statistics);
    if (verdict == Verdict::kDismissed) continue;
    if (verdict == Verdict::kHitAtMid) best = std::min(best, node.mid);
    const Answer answer =
        runs_.is_run(index) ? runs_.search(e, index, false, best, statistics) : Answer::kUnknown;
    if (answer == Answer::kUnknown) first_pose_below(e, index, best, statistics);
  }
  return best;
}

template class SweepFilterOf<Vec3>;
template class SweepFilterOf<Triangle>;
template class SweepFilterOf<SolidTriangle>;

}  // namespace clearway
