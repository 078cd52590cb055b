#pragma once

#include <cstdint>
#include <vector>

#include "clearway/model.hpp"
#include "core/geometry/solid_parts_ref.hpp"

namespace clearway {

/// The solids of a model, each with a tree over its triangles.
class SolidParts {
 public:
  SolidParts() = default;
  /// The model may go afterwards. The number of each solid is below the number of triangles.
  explicit SolidParts(const Model& model, int threads = 1);

  /// Valid while they live.
  SolidPartsRef ref() const {
    return {parts_.data(),
            triangles_.data(),
            boxes_.data(),
            static_cast<std::uint32_t>(parts_.size()),
            static_cast<std::uint32_t>(triangles_.size()),
            static_cast<std::uint32_t>(boxes_.size()),
            lattice_};
  }

  /// How far a place may be moved before it is asked whether it lies inside, metres in the model's
  /// frame; and the triangles with it (docs/design/numerics.md, "Solids").
  double rounding() const;

  std::uint64_t allocated_bytes() const {
    return parts_.capacity() * sizeof(SolidPart) + triangles_.capacity() * sizeof(Triangle) +
           boxes_.capacity() * sizeof(Box);
  }

 private:
  void add(const std::vector<Triangle>& solid, int threads);

  std::vector<SolidPart> parts_;
  std::vector<Triangle> triangles_;
  std::vector<Box> boxes_;
  SolidLattice lattice_;
};

}  // namespace clearway
