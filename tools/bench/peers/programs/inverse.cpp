// The inverse question, step by step from the plainest way to ask it to that of engine sweep: each
// point is pulled back into the frame of the model, which is searched there.

#include <cmath>
#include <optional>
#include <stdexcept>

#include "bench/peers/programs/nanoflann_tree.hpp"
#include "bench/peers/programs/peer.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "core/util/stopwatch.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::bench {
namespace {

using Bounds = ModelFieldRef::Bounds;

/// What each method does, by its name. All look for the model at single poses alone, where its box
/// is within reach.
struct Method {
  const char* name;
  bool in_tree;  ///< takes poses together, by the motion tree and the model's box
  bool exact;
};
constexpr Method kMethods[] = {{"poses", false, true},    // nanoflann, pose by pose
                               {"tree", true, true},      // nanoflann
                               {"field", true, true},     // the model field
                               {"voxels", true, false}};  // a plain distance field

/// Asks whether the model touches a point. bounds: of a place in the model's frame.
template <typename BoundsAt>
class Asking {
 public:
  Asking(const SweepRef& sweep, const Method& method, BoundsAt bounds)
      : sweep_(sweep), method_(method), bounds_(bounds) {}

  bool touches(const Vec3& e) const {
    double squared = 0;
    if (method_.in_tree) {
      const SweepVerdict verdict = look(e, sweep_.motion.nodes[0], squared);
      return verdict == SweepVerdict::kHitAtMid ||
             (verdict == SweepVerdict::kOpen && touches_below(e, 0));
    }
    for (std::uint32_t pose = 0; pose < sweep_.motion.pose_count; ++pose) {
      if (look(e, {pose, 1, pose, 0, 0}, squared) == SweepVerdict::kHitAtMid) return true;
    }
    return false;
  }

 private:
  /// kOpen only for more than one pose.
  SweepVerdict look(const Vec3& e, const MotionNode& node, double& squared) const {
    const InversePose& back = sweep_.motion.inverse_poses[node.mid];
    const Vec3 x = back.apply(e);
    squared = least_squared_distance(sweep_.field.model, x);
    if (farther(back.least, squared, sweep_.reach_of(node))) return SweepVerdict::kDismissed;
    if (node.count > 1) return SweepVerdict::kOpen;
    const Bounds bounds = bounds_(x);
    if (!method_.exact) {
      return bounds.squared_lower < sweep_.radius * sweep_.radius ? SweepVerdict::kHitAtMid
                                                                  : SweepVerdict::kDismissed;
    }
    const SweepVerdict verdict = sweep_.judge(e, node, FloorSide::kAbove, x, bounds.squared_lower,
                                              [&] { return bounds.near; });
    if (verdict != SweepVerdict::kOpen) return verdict;
    return sweep_.collides_at(e, node) ? SweepVerdict::kHitAtMid : SweepVerdict::kDismissed;
  }

  /// Both halves first, then below the nearer one.
  bool touches_below(const Vec3& e, std::uint32_t node) const {
    const std::uint32_t half[2] = {node + 1, sweep_.motion.nodes[node].later};
    double squared[2];
    bool open[2];
    for (int i = 0; i < 2; ++i) {
      const SweepVerdict verdict = look(e, sweep_.motion.nodes[half[i]], squared[i]);
      if (verdict == SweepVerdict::kHitAtMid) return true;
      open[i] = verdict == SweepVerdict::kOpen;
    }
    const int nearer = squared[1] < squared[0] ? 1 : 0;
    return (open[nearer] && touches_below(e, half[nearer])) ||
           (open[1 - nearer] && touches_below(e, half[1 - nearer]));
  }

  const SweepRef& sweep_;
  const Method& method_;
  BoundsAt bounds_;
};

/// Distances from the model at the nodes of a lattice, in floats, and between them interpolated.
class Voxels {
 public:
  Voxels(const ModelTree& tree, double edge, double margin, int threads)
      : edge_(edge), origin_(tree.box().lo) {
    for (int k = 0; k < 3; ++k) {
      origin_[k] -= margin + edge;
      size_[k] = 3 + static_cast<std::int64_t>((tree.box().hi[k] + margin - origin_[k]) / edge);
    }
    distances_.resize(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]));
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads)
    for (std::int64_t row = 0; row < size_[1] * size_[2]; ++row) {
      std::uint32_t near = 0;  // the nearest element of the node before is a good guess
      for (std::int64_t ix = 0; ix < size_[0]; ++ix) {
        const auto of = [&](int k, std::int64_t i) {
          return origin_[k] + edge * static_cast<double>(i);
        };
        const auto found =
            tree.nearest({of(0, ix), of(1, row % size_[1]), of(2, row / size_[1])}, near);
        near = found.element;
        distances_[static_cast<std::size_t>(row * size_[0] + ix)] =
            static_cast<float>(std::sqrt(found.squared_distance));
      }
    }
  }

  /// Nothing outside of the lattice.
  std::optional<double> distance(const Vec3& x) const {
    double share[3];
    std::int64_t at = 0;
    for (int k = 2; k >= 0; --k) {
      const double place = (x[k] - origin_[k]) / edge_;
      if (!(place >= 0 && place < static_cast<double>(size_[k] - 1))) return {};
      const auto node = static_cast<std::int64_t>(place);
      share[k] = place - static_cast<double>(node);
      at = at * size_[k] + node;
    }
    double corner[8];
    field_detail::load_corners(distances_.data() + at, static_cast<std::size_t>(size_[0]),
                               static_cast<std::size_t>(size_[0] * size_[1]), corner);
    return field_detail::interpolated(share, corner);
  }

 private:
  double edge_;
  Vec3 origin_;
  std::int64_t size_[3];
  std::vector<float> distances_;
};

class Inverse : public Peer {
 public:
  Inverse(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "inverse"}, {"settings", options.method}}),
        points_(points),
        store_(options.environment),
        method_(std::ranges::find(kMethods, options.method, &Method::name)) {
    if (method_ == std::end(kMethods)) throw std::invalid_argument("no method " + options.method);
  }

  /// Makes the trees of the model and the motion, and the model field, as a search of sweep does;
  /// but voxels once for all searches.
  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    const Query query(std::vector<Vec3>(model.begin(), model.end()),
                      std::vector<Pose>(poses.begin(), poses.end()), {.radius = options_.radius});
    const int threads = options_.threads;
    const ModelTree tree(model, threads);
    const MotionTree motion(query.poses, tree.box(), false, threads);
    const ModelField field(tree, query.radius,
                           {.fineness = 2, .cheaply_finer = true, .by_need = true}, threads);
    const SweepFilterOf<Vec3> filter(query, motion, tree, field, store_, threads);
    const SweepRef& sweep = filter.ref();
    if (options_.method == "field") {
      ask(sweep, marks, [&](const Vec3& x) { return sweep.field.bounds(x); });
    } else if (options_.method == "voxels") {
      if (!voxels_) {
        const Stopwatch clock;
        voxels_.emplace(tree, options_.cell, query.radius, threads);
        about_["voxels_seconds"] = clock.seconds();
      }
      ask(sweep, marks, [&](const Vec3& x) -> Bounds {
        const std::optional<double> distance = voxels_->distance(x);
        return {distance ? *distance * *distance : least_squared_distance(tree.box(), x),
                ModelFieldRef::kNone};
      });
    } else {
      const NanoflannPoints adaptor{{sweep.model.elements, model.size()}};
      NanoflannTree near(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints));
      near.buildIndex();
      ask(sweep, marks, [&](const Vec3& x) -> Bounds {
        const double place[3] = {x.x, x.y, x.z};
        std::uint32_t element;
        double squared;
        near.knnSearch(place, 1, &element, &squared);
        return {squared * (1 - 1e-12), element};  // it is rounded
      });
    }
  }

 private:
  template <typename BoundsAt>
  void ask(const SweepRef& sweep, Marks& marks, BoundsAt bounds) const {
    const Asking asking(sweep, *method_, bounds);
#pragma omp parallel for schedule(dynamic, 1024) num_threads(options_.threads)
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (asking.touches(points_[i])) marks.mark(i);
    }
  }

  std::span<const Vec3> points_;
  StoreReader store_;
  const Method* method_;
  std::optional<Voxels> voxels_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Inverse>(points, options);
}

}  // namespace clearway::bench
