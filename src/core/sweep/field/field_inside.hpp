#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/solid_parts.hpp"
#include "core/sweep/field/field_inside_ref.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

/// Which nodes and coarse cells of a ModelField lie inside solids (docs/design/solids.md).
class FieldInside {
 public:
  static constexpr std::uint32_t kBrickWords =
      FieldInsideRef::words_for(ModelFieldRef::kBrickNodes);
  static constexpr std::uint64_t kBrickBytes = kBrickWords * sizeof(std::uint32_t);

  /// Outlives it.
  explicit FieldInside(const SolidParts& solids) : solids_(solids) {}

  /// Makes room for bricks. size, origin, step: of the coarse nodes; brick_of: kNoBrick for the
  /// cells that no surface is near.
  void lay_out(const std::uint32_t (&size)[3], const Vec3& origin, double step,
               std::span<const std::uint32_t> brick_of, std::uint32_t bricks);

  /// corner, voxel, squared: as of BrickNearest::find.
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
