#include "core/sweep/sweep_filter.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/query/search_result.hpp"
#include "core/util/bit_reversal_order.hpp"

namespace clearway {
namespace {

using Verdict = SweepVerdict;

double rounding_of(const Query& query, const MotionTree& motion, const ModelField& field,
                   const PackedCloud& cloud) {
  // Rounding of the question for the inside, expressed as an additional margin of the lattice.
  const double lattice = field.margin() + field.inside_rounding() / (1024 * kUnitRoundoff);
  const double rounding =
      motion.rounding(largest_coordinate(cloud) + query.radius, lattice) + 1e-150;
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

/// Cost beyond which a point grazes the model, so that its neighbours in the block are searched in
/// runs of poses (measured).
constexpr std::uint64_t kGrazingCost = 128;

/// Number of look-ups that take as long as one exact test.
constexpr std::uint64_t kTestsOfExact = 4;

}  // namespace

template <typename Element>
SweepFilterOf<Element>::SweepFilterOf(const Query& query, const MotionTree& motion,
                                      const ModelTreeOf<StoredElement<Element>>& model,
                                      const ModelField& field, const PackedCloud& cloud,
                                      int threads)
    : query_(query),
      motion_(motion),
      model_(model),
      ref_{.motion = motion.ref(),
           .model = model.ref(),
           .field = field.ref(),
           .wide = {},
           .radius = query.radius,
           .clearance = query.clearance,
           .profile = query.profile,
           .open_area =
               kOpenArea * spacing_of(model, query.clearance) * spacing_of(model, query.clearance),
           .rounding = rounding_of(query, motion, field, cloud),
           .first_pose = query.first_pose,
           .between_poses = query.between_poses},
      runs_(motion, model, ref_) {
  if (query.floor) {
    floors_ = MotionFloors(motion, threads);
    ref_.motion.floors = floors_.data();
    ref_.floor = *query.floor;
    ref_.floor_rounding = motion.height_rounding(largest_coordinate(cloud));
  }
  if (query.clearance > 0) {
    curves_ = MotionCurves(motion, model.box(), query.clearance * kRoundedUp + ref_.rounding,
                           spacing_of(model, query.clearance), threads);
    ref_.motion.curves = curves_.data();
  }
  if (query.clearance > 0 || (query.profile > 0 && !kIsTriangle<Element>)) {
    wide_ = WideTreeOf<StoredElement<Element>>(model);
    ref_.wide = wide_.ref();
  }
  if (query.profile > 0) {
    travel_ = ProfileTravel(ref_.motion, field.ref().model, query.floor.has_value(), threads);
  }
  for_plan_ = ref_;
  for_plan_.field = field.ref_as_made();
}

/// Visits nodes, which are in the order of their poses, and in that order the halves that visits
/// ask for. Returns true as soon as a visit ends the descent.
template <typename Element>
template <typename Visit>
bool SweepFilterOf<Element>::descend_in_order(std::span<const std::uint32_t> nodes,
                                              const Visit& visit) const {
  for (const std::uint32_t node : nodes) {
    const Step step = visit(node);
    if (step == Step::kEnd) return true;
    if (step == Step::kPast) continue;
    if (descend_in_order(halves(node), visit)) return true;
  }
  return false;
}

/// Visits both halves of a node before the halves of either, then goes on with the nearer one.
/// visit: also returns how near the model is. Returns true as soon as a visit ends the descent.
template <typename Element>
template <typename Visit>
bool SweepFilterOf<Element>::descend_nearer_first(std::uint32_t node, const Visit& visit) const {
  const std::array<std::uint32_t, 2> half = halves(node);
  double squared[2];
  bool open[2];
  for (int i = 0; i < 2; ++i) {
    const Step step = visit(half[i], squared[i]);
    if (step == Step::kEnd) return true;
    open[i] = step == Step::kHalves;
  }
  const int nearer = squared[1] < squared[0] ? 1 : 0;
  return (open[nearer] && descend_nearer_first(half[nearer], visit)) ||
         (open[1 - nearer] && descend_nearer_first(half[1 - nearer], visit));
}

template <typename Element>
bool SweepFilterOf<Element>::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                                    std::vector<std::uint32_t>& out,
                                    SweepStatistics& statistics) const {
  return narrow(ref_, box, nodes, 0, ref_.accepts_boxes(), out, statistics);
}

template <typename Element>
void SweepFilterOf<Element>::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                                    std::vector<std::uint32_t>& out) const {
  SweepStatistics not_counted;
  narrow(for_plan_, box, nodes, ref_.profile * kRoundedUp, false, out, not_counted);
}

/// least_distance: a distance within which every pose matters at least. accept: whether boxes may
/// be accepted as a whole.
template <typename Element>
bool SweepFilterOf<Element>::narrow(const SweepRefOf<Element>& ref, const Box& box,
                                    std::span<const std::uint32_t> nodes, double least_distance,
                                    bool accept, std::vector<std::uint32_t>& out,
                                    SweepStatistics& statistics) const {
  out.clear();
  const PointBox points(box);
  const double distance = std::max(
      least_distance,
      ref.clearance > 0 ? ref.clearance_limit(points.centre, points.rho, nodes.data(),
                                              static_cast<std::uint32_t>(nodes.size()), statistics)
                        : ref.radius);
  return descend_in_order(nodes, [&](std::uint32_t node) {
    ++statistics.node_tests;
    switch (ref.classify_box(ref.motion.nodes[node], points, distance, accept)) {
      case SweepBoxClass::kAccepted:
        return Step::kEnd;
      case SweepBoxClass::kSplit:
        return Step::kHalves;
      case SweepBoxClass::kKept:
        out.push_back(node);
        break;
      case SweepBoxClass::kDismissed:
        break;
    }
    return Step::kPast;
  });
}

/// A visit that ends at any pose of the node that touches e.
template <typename Element>
typename SweepFilterOf<Element>::Step SweepFilterOf<Element>::find_any_pose(
    const Vec3& e, std::uint32_t index, SweepStatistics& statistics, double& squared_lower) const {
  const MotionNode& node = motion_.nodes()[index];
  const Verdict verdict = ref_.look(e, node, statistics, squared_lower);
  if (verdict == Verdict::kDismissed) return Step::kPast;
  if (verdict == Verdict::kHitAtMid) return Step::kEnd;
  if (node.count > 1) return Step::kHalves;
  ++statistics.exact_tests;
  return ref_.collides_at(e, node) ? Step::kEnd : Step::kPast;
}

/// A visit that lowers `best` to a pose of the node that touches e, if one is less.
template <typename Element>
typename SweepFilterOf<Element>::Step SweepFilterOf<Element>::find_first_pose(
    const Vec3& e, std::uint32_t index, std::uint32_t& best, SweepStatistics& statistics) const {
  const MotionNode& node = motion_.nodes()[index];
  if (node.first >= best) return Step::kEnd;  // as are all nodes after it
  const Verdict verdict = ref_.look(e, node, statistics);
  if (verdict == Verdict::kDismissed) return Step::kPast;
  if (verdict == Verdict::kHitAtMid) best = std::min(best, ref_.first_pose_of_hit(node.mid));
  if (node.count > 1) return Step::kHalves;
  if (verdict == Verdict::kOpen) {
    ++statistics.exact_tests;
    if (ref_.collides_at(e, node)) best = node.first;
  }
  return Step::kPast;
}

/// Replaces the step into the halves of a node that is a run by a search of the run, if that
/// decides. any, end: as for HitRuns::search().
template <typename Element>
typename SweepFilterOf<Element>::Step SweepFilterOf<Element>::search_run(
    Step step, const Vec3& e, std::uint32_t node, bool any, std::uint32_t& end,
    SweepStatistics& statistics) const {
  using Answer = typename HitRuns<Element>::Answer;
  if (step != Step::kHalves || !runs_.is_run(node)) return step;
  const Answer answer = runs_.search(e, node, any, end, statistics);
  if (answer == Answer::kUnknown) return Step::kHalves;
  return any && answer == Answer::kHit ? Step::kEnd : Step::kPast;
}

template <typename Element>
bool SweepFilterOf<Element>::touches_below(const Vec3& e, std::uint32_t node,
                                           SweepStatistics& statistics) const {
  return descend_nearer_first(node, [&](std::uint32_t half, double& squared_lower) {
    return find_any_pose(e, half, statistics, squared_lower);
  });
}

template <typename Element>
void SweepFilterOf<Element>::lower_first_pose(const Vec3& e, std::uint32_t node,
                                              std::uint32_t& best,
                                              SweepStatistics& statistics) const {
  descend_in_order(halves(node),
                   [&](std::uint32_t half) { return find_first_pose(e, half, best, statistics); });
}

template <typename Element>
std::uint64_t SweepFilterOf<Element>::cost_of(const SweepStatistics& tests) {
  return tests.point_tests + kTestsOfExact * tests.exact_tests;
}

template <typename Element>
void SweepFilterOf<Element>::join_runs(std::uint64_t cost, std::span<const std::uint32_t> nodes,
                                       std::vector<std::uint32_t>& runs) const {
  runs.clear();
  if (cost <= kGrazingCost || !runs_.prepare()) return;
  runs.assign(nodes.begin(), nodes.end());
  runs_.join(runs);
}

template <typename Element>
bool SweepFilterOf<Element>::touches_runs(const Vec3& e, std::span<const std::uint32_t> nodes,
                                          SweepStatistics& statistics) const {
  const auto visit = [&](std::uint32_t node, double& squared_lower) {
    return find_any_pose(e, node, statistics, squared_lower);
  };
  return std::ranges::any_of(nodes, [&](std::uint32_t node) {
    double squared_lower;
    std::uint32_t end = kNoPose;
    const Step step = search_run(visit(node, squared_lower), e, node, true, end, statistics);
    return step == Step::kEnd || (step == Step::kHalves && descend_nearer_first(node, visit));
  });
}

template <typename Element>
std::uint32_t SweepFilterOf<Element>::first_pose_of_runs(const Vec3& e,
                                                         std::span<const std::uint32_t> nodes,
                                                         SweepStatistics& statistics) const {
  std::uint32_t best = kNoPose;
  const auto visit = [&](std::uint32_t node) { return find_first_pose(e, node, best, statistics); };
  std::ranges::any_of(nodes, [&](std::uint32_t node) {
    const Step step = search_run(visit(node), e, node, false, best, statistics);
    return step == Step::kEnd || (step == Step::kHalves && descend_in_order(halves(node), visit));
  });
  return best;
}

template class SweepFilterOf<Vec3>;
template class SweepFilterOf<Triangle>;
template class SweepFilterOf<SolidTriangle>;

}  // namespace clearway
