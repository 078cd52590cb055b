#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "core/util/zeroed_array.hpp"

namespace clearway {

/// The least computed d2 between an environment point and the model over all poses, square metres,
/// and the lowest pose that has it. The distance is its root. For a point inside solids it is below
/// 0: minus the square of the greatest depth.
struct Clearance {
  double squared = std::numeric_limits<double>::infinity();
  std::uint32_t pose = std::numeric_limits<std::uint32_t>::max();
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const Clearance&, const Clearance&) = default;
};

/// Clearances of a PackedCloud by entry, 12 bytes each; none if it is not below the distance asked
/// for. Different entries may be set at the same time.
class ClearanceSet {
 public:
  ClearanceSet() = default;
  explicit ClearanceSet(std::uint64_t entries) : squared_(entries), poses_(entries) {}

  void set(std::uint64_t entry, const Clearance& clearance) {
    squared_[entry] = std::bit_cast<std::uint64_t>(clearance.squared) ^ kNone;
    poses_[entry] = ~clearance.pose;
  }

  Clearance at(std::uint64_t entry) const {
    return {std::bit_cast<double>(squared_[entry] ^ kNone), ~poses_[entry]};
  }

  /// The entries 64 * index + i that have a clearance, as bits i.
  std::uint64_t word(std::uint64_t index) const {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 64; ++i) {
      bits |= std::uint64_t{squared_[64 * index + i] != 0} << i;
    }
    return bits;
  }

  std::uint64_t allocated_bytes() const {
    return squared_.allocated_bytes() + poses_.allocated_bytes();
  }

 private:
  /// Values are stored as differences from the one that means none, so that zeros mean none.
  static constexpr std::uint64_t kNone = std::bit_cast<std::uint64_t>(Clearance{}.squared);

  ZeroedArray<std::uint64_t> squared_;
  ZeroedArray<std::uint32_t> poses_;
};

}  // namespace clearway
