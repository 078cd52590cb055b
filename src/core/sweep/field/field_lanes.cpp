#include "core/sweep/field/field_lanes.hpp"

#include <cstring>

#include "core/util/lane_bits.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// Pulls points back, and finds their coarse cells and their places in bricks, had these any.
CLEARWAY_SIMD_CLONES
void FieldLanes::place_all(const ModelFieldRef& field, const InversePose& back,
                           std::uint32_t filled, FieldLanes& lanes) {
  constexpr auto kLast = static_cast<std::int32_t>(ModelFieldRef::kBrick - 1);
  constexpr auto kRow = static_cast<std::int32_t>(ModelFieldRef::kRow);
  const InversePose pose = back;
  const double origin[3] = {field.origin.x, field.origin.y, field.origin.z};
  const double per_metre = field.per_metre;
  double last[3];
  std::int32_t size[3];
  for (int k = 0; k < 3; ++k) {
    last[k] = field.size[k] - 1;
    size[k] = static_cast<std::int32_t>(field.size[k]);
  }
  for (std::uint32_t i = 0; i < filled / kVector * kVector; ++i) {
    const Vec3 x = pose.apply({lanes.x_[0][i], lanes.x_[1][i], lanes.x_[2][i]});
    const double at[3] = {x.x, x.y, x.z};
    std::int32_t cell[3], fine[3], near[3];
    std::int32_t inside = 1;
    for (int k = 0; k < 3; ++k) {
      lanes.x_[k][i] = at[k];
      const double whole = (at[k] - origin[k]) * per_metre;
      inside &= static_cast<std::int32_t>(whole >= 0) & static_cast<std::int32_t>(whole < last[k]);
      const double from_first = whole >= 0 ? whole : 0;
      const double within = from_first < last[k] ? from_first : 0;
      cell[k] = static_cast<std::int32_t>(within);
      const double place = (within - cell[k]) * ModelFieldRef::kBrick;
      const auto voxel = static_cast<std::int32_t>(place);
      fine[k] = voxel < kLast ? voxel : kLast;
      const double rest = place - fine[k];
      lanes.place_[k][i] = rest;
      near[k] = fine[k] + static_cast<std::int32_t>(rest >= 0.5);
    }
    const std::int32_t number = (cell[2] * size[1] + cell[1]) * size[0] + cell[0];
    lanes.cell_[i] = inside != 0 ? number : kOutside;
    lanes.low_[i] = (fine[2] * kRow + fine[1]) * kRow + fine[0];
    lanes.near_[i] = (near[2] * kRow + near[1]) * kRow + near[0];
  }
}

/// Bounds the squared distances from the corners of fine voxels.
CLEARWAY_SIMD_CLONES
void FieldLanes::bound_all(const ModelFieldRef& field, std::uint32_t filled, FieldLanes& lanes) {
  constexpr std::int32_t kRow = ModelFieldRef::kRow, kLayer = kRow * kRow;
  const float* const distances = field.distances;
  const double step = field.voxel, slack = field.fine_slack;
  // Two neighbours along x are loaded as one, which takes less time than the processor's gathers.
  float pairs[4][2 * kMost];
  for (std::uint32_t i = 0; i < filled; ++i) {
    const float* const first = distances + lanes.low_[i];
    for (int k = 0; k < 4; ++k) {
      std::memcpy(pairs[k] + 2 * i, first + (k & 1 ? kRow : 0) + (k & 2 ? kLayer : 0),
                  2 * sizeof(float));
    }
  }
  for (std::uint32_t i = 0; i < filled / kVector * kVector; ++i) {
    double corner[8];
    for (int k = 0; k < 4; ++k) {
      corner[2 * k] = static_cast<double>(pairs[k][2 * i]);
      corner[2 * k + 1] = static_cast<double>(pairs[k][2 * i + 1]);
    }
    const double place[3] = {lanes.place_[0][i], lanes.place_[1][i], lanes.place_[2][i]};
    lanes.squared_lower_[i] =
        field_detail::concave_bound(field_detail::interpolated(place, corner), place, step, slack);
  }
}

/// Compares the bounds as farther() does.
CLEARWAY_SIMD_CLONES
void FieldLanes::compare_all(double least, double squared_reach, FieldLanes& lanes) {
  for (std::uint32_t i = 0; i < kMost; ++i) {
    lanes.is_within_[i] = !(least * least * lanes.squared_lower_[i] >= squared_reach);
  }
}

std::uint64_t FieldLanes::within(double least, double reach) {
  const std::uint64_t all = ~std::uint64_t{0} >> (kMost - count_);
  const double squared_reach = reach * reach * kRoundedUp;
  if (!(squared_reach <= kLargestDouble)) return all;
  compare_all(least, squared_reach, *this);
  return packed_bits(is_within_) & all;
}

void FieldLanes::look_up(const InversePose& back) {
  const std::uint32_t filled = (count_ + kVector - 1) / kVector * kVector;
  for (std::uint32_t i = count_; i < filled; ++i) {
    for (auto& axis : x_) axis[i] = axis[count_ - 1];
  }
  place_all(field_, back, filled, *this);
  std::uint64_t others = 0;  // points outside of all bricks, as bits
  std::int32_t valid = -1;   // a first node of a point in a brick
  for (std::uint32_t i = 0; i < count_; ++i) {
    // kNoBrick is above kMostBricks, too.
    const std::uint32_t brick = cell_[i] == kOutside
                                    ? ModelFieldRef::kNoBrick
                                    : field_.brick_at(static_cast<std::size_t>(cell_[i]));
    if (brick > kMostBricks) {
      others |= std::uint64_t{1} << i;
      near_[i] = -1;
      continue;
    }
    const auto first = static_cast<std::int32_t>(brick * ModelFieldRef::kBrickNodes);
    valid = low_[i] += first;
    near_[i] += first;
  }
  if (valid >= 0) {
    for (std::uint32_t i = count_; i < filled; ++i) low_[i] = valid;
    for_each_bit(others, [&](std::uint32_t i) { low_[i] = valid; });
    bound_all(field_, filled, *this);
  }
  for_each_bit(others,
               [&](std::uint32_t i) { squared_lower_[i] = field_.squared_lower(place(i)); });
}

}  // namespace clearway
