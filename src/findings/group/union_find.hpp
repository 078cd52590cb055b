#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

namespace clearway {

/// Disjoint sets of numbers that several threads may unite at the same time. The root of a set is
/// its smallest number, in whatever order sets are united. Source: Anderson and Woll, Wait-free
/// parallel algorithms for the union-find problem, 1991.
class UnionFind {
 public:
  explicit UnionFind(std::uint32_t count) : parent_(count) {
    for (std::uint32_t i = 0; i < count; ++i) parent_[i].store(i, kRelaxed);
  }

  std::uint32_t find(std::uint32_t i) {
    for (;;) {
      std::uint32_t above = parent_[i].load(kRelaxed);
      if (above == i) return i;
      const std::uint32_t higher = parent_[above].load(kRelaxed);
      if (higher != above) parent_[i].compare_exchange_weak(above, higher, kRelaxed);
      i = higher;
    }
  }

  /// Whether two numbers are in one set. True is always right; false may be wrong while other
  /// threads unite sets.
  bool together(std::uint32_t a, std::uint32_t b) { return find(a) == find(b); }

  void unite(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      if (a > b) std::swap(a, b);
      std::uint32_t root = b;
      if (parent_[b].compare_exchange_strong(root, a, kRelaxed)) return;
    }
  }

 private:
  // Parents only ever change to smaller numbers of the same set, and no other memory depends on
  // them.
  static constexpr auto kRelaxed = std::memory_order_relaxed;
  std::vector<std::atomic<std::uint32_t>> parent_;
};

}  // namespace clearway
