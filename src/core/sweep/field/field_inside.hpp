#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/solid_parts.hpp"
#include "core/sweep/field/field_inside_ref.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

/// Knows which nodes and coarse cells of a ModelField lie inside solids (docs/design/model.md).
class FieldInside {
 public:
  static constexpr std::uint32_t kBrickWords =
      FieldInsideRef::words_for(ModelFieldRef::kBrickNodes);
  static constexpr std::uint64_t kBrickBytes = kBrickWords * sizeof(std::uint32_t);

  /// solids: must outlive this object.
  explicit FieldInside(const SolidParts& solids) : solids_(solids) {}

  /// Makes room for bricks and finds the cells that are inside. size, origin, step: those of the
  /// coarse nodes; brick_of: kNoBrick for cells without a nearby surface.
  void lay_out(const std::uint32_t (&size)[3], const Vec3& origin, double step,
               std::span<const std::uint32_t> brick_of, std::uint32_t bricks);

  /// Finds the nodes of a brick that are inside. corner, voxel, squared: as for BrickNearest::find.
  void make_brick(std::uint32_t brick, const Vec3& corner, double voxel, const float* squared);

  FieldInsideRef ref() const { return {solids_.ref(), cells_.data(), nodes_.get()}; }
  double rounding() const { return solids_.rounding(); }
  std::uint64_t allocated_bytes() const { return cells_.capacity() + bricks_ * kBrickBytes; }

 private:
  const SolidParts& solids_;
  std::vector<std::uint8_t> cells_;
  std::uint64_t bricks_ = 0;
  std::unique_ptr<std::uint32_t[]> nodes_;
};

}  // namespace clearway
