#pragma once

#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/model_element.hpp"

namespace clearway {

/// What a descent of a model's tree does with a box.
enum class ModelStep { kSkip, kEnter, kTake };

/// View of a ModelTreeOf on the host or on a device. Does not own its arrays.
template <typename Element>
struct ModelTreeRefOf {
  static constexpr std::uint32_t kLeafElements = kIsTriangle<Element> ? 4 : 8;
  /// Greatest number of open parts of a descent; 2^32 elements are 31 levels
  static constexpr int kMostParts = 40;

  using Step = ModelStep;

  struct Nearest {
    std::uint32_t element;  ///< index in the order of the tree
    double squared_distance;
  };

  const Element* elements;
  const Box* boxes;  ///< box of node i, whose children are 2 i + 1 and 2 i + 2
  std::uint32_t size;
  std::uint32_t box_count;

  /// Descends the tree: step(box) says whether to skip the elements of the box, to enter it, or to
  /// take it. Returns whether any box was taken or visit(element) was true; stops at the first.
  template <typename StepInto, typename Visit>
  CLEARWAY_HD bool any(StepInto step, Visit visit) const {
    if (size == 0) return false;
    Part open[kMostParts];
    int count = 0;
    open[count++] = {0, 0, size};
    while (count > 0) {
      const Part part = open[--count];
      const Step next = step(boxes[part.node]);
      if (next == Step::kTake) return true;
      if (next == Step::kSkip) continue;
      if (part.end - part.begin <= kLeafElements) {
        for (std::uint32_t i = part.begin; i < part.end; ++i) {
          if (visit(elements[i])) return true;
        }
        continue;
      }
      open[count++] = right_of(part);
      open[count++] = left_of(part);
    }
    return false;
  }

  /// Whether visit(element) is true for any element whose computed squared distance to x is at most
  /// `squared_radius`; may visit some others. Stops at the first. A radius of NaN visits all.
  template <typename Visit>
  CLEARWAY_HD bool any_within(const Vec3& x, double squared_radius, Visit visit) const {
    return any(
        [&](const Box& box) {
          return least_squared_distance(box, x) > squared_radius ? Step::kSkip : Step::kEnter;
        },
        [&](const Element& m) { return !(squared_distance(x, m) > squared_radius) && visit(m); });
  }

  /// The element nearest to x in a model that is not empty. guess: any element, best a near one.
  CLEARWAY_HD Nearest nearest(const Vec3& x, std::uint32_t guess) const {
    Nearest best{guess, squared_distance(x, elements[guess])};
    Part open[kMostParts];
    double squared[kMostParts];  // squared distances to the boxes of the open parts
    int count = 0;
    squared[count] = 0;
    open[count++] = {0, 0, size};
    while (count > 0) {
      const Part part = open[--count];
      if (!(squared[count] < best.squared_distance)) continue;
      if (part.end - part.begin <= kLeafElements) {
        for (std::uint32_t i = part.begin; i < part.end; ++i) {
          const double here = squared_distance(x, elements[i]);
          if (here < best.squared_distance) best = {i, here};
        }
        continue;
      }
      const Part left = left_of(part), right = right_of(part);
      const double to_left = least_squared_distance(boxes[left.node], x);
      const double to_right = least_squared_distance(boxes[right.node], x);
      const bool left_first = to_left <= to_right;
      squared[count] = left_first ? to_right : to_left;
      open[count++] = left_first ? right : left;
      squared[count] = left_first ? to_left : to_right;
      open[count++] = left_first ? left : right;
    }
    return best;
  }

 private:
  struct Part {
    std::uint32_t node, begin, end;
  };

  CLEARWAY_HD static Part left_of(const Part& part) {
    return {2 * part.node + 1, part.begin, part.begin + (part.end - part.begin) / 2};
  }
  CLEARWAY_HD static Part right_of(const Part& part) {
    return {2 * part.node + 2, part.begin + (part.end - part.begin) / 2, part.end};
  }
};

using ModelTreeRef = ModelTreeRefOf<Vec3>;

}  // namespace clearway
