#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "io/store/convert/quantum_bounds.hpp"

namespace clearway {

/// Number of points in a half-open box of lattice coordinates: x, y, z, source.
struct Bin {
  std::array<std::uint64_t, 4> lo;
  std::array<std::uint64_t, 4> hi;
  std::uint64_t count;
};

inline constexpr std::uint64_t kAllSources = ~std::uint64_t{0};

/// Counts points in cubic power-of-two bins that are as fine as possible: when more than
/// `most_bins` are occupied, every 2 x 2 x 2 bins become one. The outcome depends on the points
/// alone.
class BinCounter {
 public:
  /// least_shift: log2 of the finest bin's side. most_bins: above 0.
  BinCounter(unsigned least_shift, std::size_t most_bins);

  void add(const LatticePoint& point, std::uint64_t count = 1);
  void merge(const BinCounter& other);
  /// Forgets all points.
  void clear();

  unsigned shift() const { return shift_; }
  /// The occupied bins, in an order that depends on the points alone.
  std::vector<Bin> bins() const;

 private:
  using Key = std::array<std::uint64_t, 3>;  // a regular lattice has up to 62 bits per axis

  struct Slot {
    Key key;
    std::uint64_t count;  // number of points; 0 for a free slot
  };

  Slot& find(const Key& key);
  void add_key(const Key& key, std::uint64_t count);
  void coarsen();

  unsigned shift_;
  std::size_t most_bins_;
  std::size_t occupied_ = 0;
  std::size_t last_ = 0;     // slot of the point before, which often is that of the next one too
  std::vector<Slot> slots_;  // open addressing; half full with most_bins bins
};

}  // namespace clearway
