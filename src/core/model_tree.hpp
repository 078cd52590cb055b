#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.hpp"
#include "core/vec3.hpp"

namespace clearway {

/// A balanced k-d tree over the model's points, for nearest neighbours and balls in the model's own
/// frame. Source: Bentley 1975; Friedman, Bentley, Finkel 1977.
class ModelTree {
 public:
  struct Nearest {
    std::uint32_t point;  ///< in the order of the tree
    double squared_distance;
  };

  explicit ModelTree(std::span<const Vec3> model);

  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
  bool empty() const { return points_.empty(); }
  const Vec3& point(std::uint32_t index) const { return points_[index]; }
  const Box& box() const { return box_; }

  /// An estimate of the distance between neighbouring points, metres: for choosing sizes, never for
  /// answers.
  double spacing() const { return spacing_; }

  /// The nearest point to x of a model that is not empty. `guess`: any point, better a near one.
  Nearest nearest(const Vec3& x, std::uint32_t guess = 0) const;

  /// Whether visit(point) is true for any point with a computed squared distance to x of at most
  /// `squared_radius`, and some others; stops at the first. A radius that is not a number visits
  /// all.
  template <typename Visit>
  bool any_within(const Vec3& x, double squared_radius, Visit visit) const {
    return any_within(0, size(), 0, x, squared_radius, visit);
  }

  /// The points with a computed squared distance to the box of at most `squared_radius` (which is a
  /// number), into `out`, replaced; false, and some of them, where they are more than `most`.
  bool within(const Box& box, double squared_radius, std::size_t most,
              std::vector<Vec3>& out) const {
    out.clear();
    return within(0, size(), 0, box, squared_radius, most, out);
  }

  enum class Step { kSkip, kEnter, kTake };

  /// Goes down the tree: step(box) tells whether to leave out the points of the box, to look
  /// closer, or to answer true. Whether any box was taken or visit(point) was true; stops at the
  /// first.
  template <typename StepInto, typename Visit>
  bool any(StepInto step, Visit visit) const {
    return !empty() && any(0, size(), 0, step, visit);
  }

  std::uint64_t allocated_bytes() const {
    return points_.capacity() * sizeof(Vec3) + boxes_.capacity() * sizeof(Box);
  }

 private:
  static constexpr std::uint32_t kLeafPoints = 8;

  void build(std::uint32_t begin, std::uint32_t end, std::size_t node);
  double median_leaf_diagonal() const;
  void search(std::uint32_t begin, std::uint32_t end, std::size_t node, const Vec3& x,
              Nearest& best) const;

  bool within(std::uint32_t begin, std::uint32_t end, std::size_t node, const Box& box,
              double squared_radius, std::size_t most, std::vector<Vec3>& out) const;

  template <typename Visit>
  bool any_within(std::uint32_t begin, std::uint32_t end, std::size_t node, const Vec3& x,
                  double squared_radius, Visit& visit) const {
    if (begin == end || least_squared_distance(boxes_[node], x) > squared_radius) return false;
    if (end - begin <= kLeafPoints) {
      for (std::uint32_t i = begin; i < end; ++i) {
        if (!(squared_distance(points_[i], x) > squared_radius) && visit(points_[i])) return true;
      }
      return false;
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    return any_within(begin, middle, 2 * node + 1, x, squared_radius, visit) ||
           any_within(middle, end, 2 * node + 2, x, squared_radius, visit);
  }

  template <typename StepInto, typename Visit>
  bool any(std::uint32_t begin, std::uint32_t end, std::size_t node, StepInto& step,
           Visit& visit) const {
    const Step next = step(boxes_[node]);
    if (next != Step::kEnter) return next == Step::kTake;
    if (end - begin <= kLeafPoints) {
      return std::any_of(points_.begin() + begin, points_.begin() + end, visit);
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    return any(begin, middle, 2 * node + 1, step, visit) ||
           any(middle, end, 2 * node + 2, step, visit);
  }

  std::vector<Vec3> points_;
  std::vector<Box> boxes_;  // of node i; children 2 i + 1 and 2 i + 2
  Box box_{};
  double spacing_ = 0;
};

}  // namespace clearway
