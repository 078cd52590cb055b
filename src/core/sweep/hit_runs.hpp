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

/// Tests whole runs of poses against one point, on the host. It is for surfaces that run along the
/// scanned ones, as a load does in a tunnel that it just fits: there a point is equally far from
/// the model at hundreds of poses, so that bounds at single poses decide one pose each. A run of
/// poses is a parabola through the model's frame, and one search of the model decides about all of
/// them (docs/design/numerics.md, "Sweep", runs). What it needs is made by one thread when it is
/// first asked for; no thread waits for that.
template <typename Element>
class HitRuns {
 public:
  /// sweep: of a query without between_poses. All arguments must outlive this object.
  HitRuns(const MotionTree& motion, const ModelTreeOf<StoredElement<Element>>& model,
          const SweepRefOf<Element>& sweep)
      : motion_(motion), model_(model), sweep_(sweep) {}

  /// Whether runs can ever be searched: for surfaces and solids of moderate size, whose second tree
  /// takes little memory.
  bool is_available() const;
  /// Greatest memory of what prepare() makes, in bytes.
  std::uint64_t most_bytes() const;

  /// Whether runs can be searched now. Makes what that takes, unless another thread is doing so.
  /// The functions below are only for threads for which this returned true.
  bool prepare() const;

  /// Joins motion nodes in the order of their poses: halves are replaced by the node that they are
  /// halves of wherever that is one run.
  void join(std::vector<std::uint32_t>& nodes) const;

  /// Whether the poses of the node form one run.
  bool is_run(std::uint32_t node) const;

  /// What a search finds about a point at the poses of a run.
  enum class Answer {
    kNever,  ///< touched at none of the poses asked for
    kHit,
    kUnknown,  ///< undecided: for solids, a triangle is so near that the point may change sides
  };

  /// Whether the model touches e at a pose of a run that is below `end`. any: any such pose will
  /// do; otherwise the first is searched. A pose that is found lowers `end` to itself.
  Answer search(const Vec3& e, std::uint32_t run, bool any, std::uint32_t& end,
                SweepStatistics& statistics) const;

 private:
  /// Greatest number of triangles; their packets take 40 MB.
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
