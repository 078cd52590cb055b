#pragma once

#include <cstdint>

#include "core/geometry/inside.hpp"
#include "core/geometry/model_tree_ref.hpp"

namespace clearway {

/// The place of a solid's tree within the arrays of all solids.
struct SolidPart {
  std::uint32_t first, count;  ///< range of its triangles
  /// Range of the tree's boxes; the first one is the box of the solid
  std::uint32_t first_box, box_count;
};

/// View of SolidParts on the host or on a device. Does not own them.
struct SolidPartsRef {
  using Tree = ModelTreeRefOf<Triangle>;

  const SolidPart* parts = nullptr;
  const Triangle* triangles = nullptr;
  const Box* boxes = nullptr;
  std::uint32_t count = 0;  ///< number of solids
  std::uint32_t triangle_count = 0, box_count = 0;
  SolidLattice lattice;

  CLEARWAY_HD Tree tree(std::uint32_t solid) const {
    const SolidPart& part = parts[solid];
    return {triangles + part.first, boxes + part.first_box, part.count, part.box_count};
  }

  /// Whether any solid contains x, which is any place of the model's frame.
  CLEARWAY_HD bool contains(const Vec3& x) const {
    return any_with(
        x, [](std::uint32_t) { return false; }, [](std::uint32_t) { return true; });
  }

  /// Whether visit(solid) is true for any solid that contains x; stops at the first one. Solids for
  /// which skip(solid) is true are left out.
  template <typename Skip, typename Visit>
  CLEARWAY_HD bool any_with(const Vec3& x, Skip skip, Visit visit) const {
    if (!lattice.has_in_box(x)) return false;
    const SolidLattice::Place place = lattice.place_of(x);
    for (std::uint32_t solid = 0; solid < count; ++solid) {
      if (skip(solid) || winding(solid, x, place) == 0) continue;
      if (visit(solid)) return true;
    }
    return false;
  }

 private:
  /// The winding number of a solid around x. A box is skipped where its triangles add nothing: once
  /// rounded to the lattice, all their corners are on one side of x, or not above it. The margin of
  /// two lattice steps is more than that rounding moves a corner.
  CLEARWAY_HD int winding(std::uint32_t solid, const Vec3& x,
                          const SolidLattice::Place& place) const {
    int sum = 0;
    const double beside = 2 * lattice.step;
    tree(solid).any(
        [&](const Box& box) {
          const bool may_add = x.x <= box.hi.x && x.x + beside >= box.lo.x && x.y <= box.hi.y &&
                               x.y + beside >= box.lo.y && x.z <= box.hi.z;
          return may_add ? ModelStep::kEnter : ModelStep::kSkip;
        },
        [&](const Triangle& t) {
          sum += winding_above(lattice, place, t);
          return false;
        });
    return sum;
  }
};

}  // namespace clearway
