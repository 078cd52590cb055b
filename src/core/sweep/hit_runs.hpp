#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/wide_tree.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "core/trajectory/motion_curves.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// Whole runs of poses against one point, on the host: for surfaces that run along what was
/// scanned, as a load does in a tunnel that it just fits. There a point is as far from the model at
/// hundreds of poses, so that bounds at single poses decide one pose each. A run of poses is a
/// parabola through the model's frame, and one search of the model decides about all of them
/// (docs/design/numerics.md, "Sweep", runs). What it needs is made when it is first asked for, by
/// one thread; nobody waits for that.
template <typename Element>
class HitRuns {
 public:
  /// All arguments outlive it. sweep: of a query without between_poses and tolerance.
  HitRuns(const MotionTree& motion, const ModelTreeOf<StoredElement<Element>>& model,
          const SweepRefOf<Element>& sweep)
      : motion_(motion), model_(model), sweep_(sweep) {}

  /// Whether runs can be searched: for surfaces and solids of moderate size, whose second tree then
  /// takes little memory.
  bool is_available() const;
  /// Of all that may be made.
  std::uint64_t most_bytes() const;

  /// Whether runs can be searched now. Makes what that takes, unless another thread does so. The
  /// functions below are for threads that were told so.
  bool prepare() const;

  /// The nodes, in the order of their poses, with halves replaced by what they are halves of
  /// wherever that is one run.
  void join(std::vector<std::uint32_t>& nodes) const;

  /// Whether the poses of the node are one run.
  bool is_run(std::uint32_t node) const;

  /// What is known of a point at the poses of a run.
  enum class Answer {
    kNever,  ///< touches it at none of the poses asked for
    kHit,
    kUnknown,  ///< solids only: no triangle touches it, but one is so near that it may change sides
  };

  /// Whether the model touches e at a pose of a run that is below `end`. any: the answer may be
  /// that of any such pose; otherwise it is that of the first. A hit lowers `end` to its pose.
  Answer search(const Vec3& e, std::uint32_t run, bool any, std::uint32_t& end,
                SweepStatistics& statistics) const;

 private:
  /// No more triangles: their packets take 40 MB.
  static constexpr std::uint32_t kMostTriangles = 1 << 18;

  struct Made {
    MotionCurves curves;
    WideTreeOf<StoredElement<Element>> wide;
  };

  enum State : int { kNotMade, kBeingMade, kMade };

  void make() const;
  const Made& made() const { return *made_; }

  const MotionTree& motion_;
  const ModelTreeOf<StoredElement<Element>>& model_;
  const SweepRefOf<Element>& sweep_;
  mutable std::atomic<State> state_ = kNotMade;
  mutable std::optional<Made> made_;
};

extern template class HitRuns<Vec3>;
extern template class HitRuns<Triangle>;
extern template class HitRuns<SolidTriangle>;

}  // namespace clearway
