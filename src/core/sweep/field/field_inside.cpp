#include "core/sweep/field/field_inside.hpp"

#include <algorithm>

namespace clearway {

/// Two neighbouring cells without a nearby surface are both inside or both outside, so one test
/// serves a whole run of them.
void FieldInside::lay_out(const std::uint32_t (&size)[3], const Vec3& origin, double step,
                          std::span<const std::uint32_t> brick_of, std::uint32_t bricks) {
  const SolidPartsRef solids = solids_.ref();
  cells_.assign(brick_of.size(), 0);
  for (std::uint32_t iz = 0; iz + 1 < size[2]; ++iz) {
    for (std::uint32_t iy = 0; iy + 1 < size[1]; ++iy) {
      bool is_known = false;
      for (std::uint32_t ix = 0; ix + 1 < size[0]; ++ix) {
        const std::size_t at = (std::size_t{iz} * size[1] + iy) * size[0] + ix;
        const bool is_free = brick_of[at] == ModelFieldRef::kNoBrick;
        if (is_free && is_known) {
          cells_[at] = cells_[at - 1];
        } else if (is_free) {
          const Vec3 centre{origin.x + (ix + 0.5) * step, origin.y + (iy + 0.5) * step,
                            origin.z + (iz + 0.5) * step};
          cells_[at] = solids.contains(centre) ? 1 : 0;
        }
        is_known = is_free;
      }
    }
  }
  bricks_ = bricks;
  nodes_ = std::make_unique_for_overwrite<std::uint32_t[]>(std::size_t{bricks} * kBrickWords);
}

/// If a neighbour is farther from the surface than from a node, both are inside or both outside.
void FieldInside::make_brick(std::uint32_t brick, const Vec3& corner, double voxel,
                             const float* squared) {
  constexpr std::uint32_t kRow = ModelFieldRef::kRow;
  const SolidPartsRef solids = solids_.ref();
  const double beside = voxel * voxel * (1 + 1e-6);
  std::uint32_t* const words = nodes_.get() + std::size_t{brick} * kBrickWords;
  std::fill_n(words, kBrickWords, 0);
  for (std::uint32_t at = 0; at < ModelFieldRef::kBrickNodes; ++at) {
    const std::uint32_t x = at % kRow, y = at / kRow % kRow, z = at / kRow / kRow;
    const std::uint32_t back = x > 0 ? 1 : y > 0 ? kRow : z > 0 ? kRow * kRow : 0;
    bool is_inside = false;
    if (back > 0 && static_cast<double>(squared[at - back]) > beside) {
      is_inside = (words[(at - back) / 32] >> ((at - back) % 32) & 1) != 0;
    } else {
      is_inside =
          solids.contains({corner.x + x * voxel, corner.y + y * voxel, corner.z + z * voxel});
    }
    if (is_inside) words[at / 32] |= std::uint32_t{1} << (at % 32);
  }
}

}  // namespace clearway
