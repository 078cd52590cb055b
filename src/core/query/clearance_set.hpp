#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace clearway {

/// The least computed d2 between an environment point and the model over all poses, square metres,
/// and the lowest pose that has it. The distance is the root of it.
struct Clearance {
  double squared = std::numeric_limits<double>::infinity();
  std::uint32_t pose = std::numeric_limits<std::uint32_t>::max();
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const Clearance&, const Clearance&) = default;
};

/// Clearances of a PackedCloud by entry, 12 bytes each; none where none is below the distance asked
/// for. Different entries may be set at the same time.
class ClearanceSet {
 public:
  ClearanceSet() = default;
  explicit ClearanceSet(std::uint64_t entries)
      : squared_(entries, Clearance{}.squared), poses_(entries, Clearance{}.pose) {}

  void set(std::uint64_t entry, const Clearance& clearance) {
    squared_[entry] = clearance.squared;
    poses_[entry] = clearance.pose;
  }

  Clearance at(std::uint64_t entry) const { return {squared_[entry], poses_[entry]}; }

  /// Which of the entries 64 * index + i have one, as bits i.
  std::uint64_t word(std::uint64_t index) const {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 64; ++i) {
      bits |= std::uint64_t{at(64 * index + i).found()} << i;
    }
    return bits;
  }

  std::uint64_t count() const {
    std::uint64_t total = 0;
    for (const double squared : squared_) total += Clearance{squared}.found();
    return total;
  }

  std::uint64_t allocated_bytes() const {
    return squared_.capacity() * sizeof(double) + poses_.capacity() * sizeof(std::uint32_t);
  }

 private:
  std::vector<double> squared_;
  std::vector<std::uint32_t> poses_;
};

}  // namespace clearway
