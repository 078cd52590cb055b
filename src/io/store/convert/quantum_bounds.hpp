#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "io/store/convert/select_split.hpp"

namespace clearway {

/// Position of a point in the counting grid and the top tree: x, y, z as non-negative lattice
/// coordinates, then the source index, so that coinciding points can be distinguished.
using LatticePoint = std::array<std::uint64_t, 4>;

/// Maps the store's integers to lattice coordinates, monotonically on every axis. In a regular
/// layout each cube starts at a multiple of a power of two, so that power-of-two bins never
/// straddle a cube's face.
class Lattice {
 public:
  /// Side of the finest bin of the counting grid.
  static constexpr std::uint64_t kLeastCubeQuanta = 16;
  /// Lattice coordinate of q = 0 in the adaptive layout.
  static constexpr std::uint64_t kZero = std::uint64_t{1} << 31;

  /// The lattice of the adaptive layout, without cubes.
  Lattice() = default;
  /// The lattice of a regular layout, with cubes of `cube_quanta` >= kLeastCubeQuanta integers
  /// along each axis.
  explicit Lattice(const std::array<std::uint64_t, 3>& cube_quanta) : cube_(cube_quanta) {
    for (const std::uint64_t quanta : cube_) {
      const auto bits = static_cast<unsigned>(std::bit_width(quanta - 1));
      if (bits > cube_bits_) cube_bits_ = bits;
    }
  }

  bool regular() const { return cube_[0] != 0; }
  /// log2 of a cube's side in lattice coordinates; bins may not be coarser.
  unsigned cube_bits() const { return cube_bits_; }

  LatticePoint operator()(const std::array<std::int32_t, 3>& q, std::uint64_t source) const {
    LatticePoint out{0, 0, 0, source};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto lifted =
          static_cast<std::uint64_t>(std::int64_t{q[k]} + static_cast<std::int64_t>(kZero));
      if (!regular()) {
        out[k] = lifted;
        continue;
      }
      // The cubes' faces are at multiples of the side counted from q = 0.
      const std::uint64_t from_face = lifted + (cube_[k] - kZero % cube_[k]) % cube_[k];
      out[k] = (from_face / cube_[k] << cube_bits_) + from_face % cube_[k];
    }
    return out;
  }

 private:
  std::array<std::uint64_t, 3> cube_{};
  unsigned cube_bits_ = 0;
};

/// The box of points, in the form of SIMD vectors: the fourth lane is that of the index and not
/// used.
struct QuantumBounds {
  static constexpr std::size_t kLanes = 4;

  std::int32_t lo[kLanes];
  std::int32_t hi[kLanes];

  /// The box of no points.
  QuantumBounds() {
    std::fill_n(lo, kLanes, std::numeric_limits<std::int32_t>::max());
    std::fill_n(hi, kLanes, std::numeric_limits<std::int32_t>::min());
  }

  void extend(std::span<const BucketPoint> points);
};

}  // namespace clearway
