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
  /// model: not needed afterwards; the number of each solid must be below the number of triangles.
  explicit SolidParts(const Model& model, int threads = 1);

  /// The solids for look-ups. Valid while this object lives.
  SolidPartsRef ref() const {
    return {parts_.data(),
            triangles_.data(),
            boxes_.data(),
            static_cast<std::uint32_t>(parts_.size()),
            static_cast<std::uint32_t>(triangles_.size()),
            static_cast<std::uint32_t>(boxes_.size()),
            lattice_};
  }

  /// Bound on how far a place, and the triangles, are moved by rounding before the test whether the
  /// place lies inside; metres in the model's frame (docs/design/numerics.md, "Solids").
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
