#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/util/zeroed_array.hpp"

namespace clearway {

/// The colliding points of a PackedCloud by entry: one bit each, and the first pose if asked for.
/// Marking is thread safe; reading is for after the threads have joined.
class HitSet {
 public:
  static constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

  HitSet(std::uint64_t entries, bool first_pose)
      : words_((entries + 63) / 64),
        earliness_(first_pose ? entries : 0),
        has_first_pose_(first_pose) {}

  void mark(std::uint64_t entry) { mark_word(entry / 64, std::uint64_t{1} << (entry % 64)); }

  /// Marks the entries 64 * word + i of all set bits i.
  void mark_word(std::uint64_t word, std::uint64_t bits) {
    std::atomic_ref target(words_[word]);
    if ((target.load(std::memory_order_relaxed) & bits) != bits) {
      target.fetch_or(bits, std::memory_order_relaxed);
    }
  }

  /// Marks the entry and lowers its first pose to `pose`. Only with first poses.
  void mark(std::uint64_t entry, std::uint32_t pose) {
    mark(entry);
    const std::uint32_t earliness = kNever - pose;
    std::atomic_ref target(earliness_[entry]);
    std::uint32_t seen = target.load(std::memory_order_relaxed);
    while (earliness > seen &&
           !target.compare_exchange_weak(seen, earliness, std::memory_order_relaxed)) {
    }
  }

  /// Removes the marks of `count` words of 64 entries each, but not their first poses. Must not be
  /// called while others mark.
  void clear_words(std::uint64_t first, std::uint64_t count) {
    std::fill_n(words_.begin() + static_cast<std::ptrdiff_t>(first), count, 0);
  }

  /// Removes the marks of the entries 64 * word + i of all set bits i, and their first poses. Must
  /// not be called while others mark these.
  void forget(std::uint64_t word, std::uint64_t bits) {
    words_[word] &= ~bits;
    if (!has_first_pose_) return;
    for (unsigned i = 0; i < 64; ++i) {
      if ((bits >> i & 1) != 0) earliness_[64 * word + i] = 0;
    }
  }

  bool contains(std::uint64_t entry) const { return (words_[entry / 64] >> (entry % 64) & 1) != 0; }
  std::uint64_t word(std::uint64_t index) const { return words_[index]; }
  std::uint64_t word_now(std::uint64_t index) {
    return std::atomic_ref(words_[index]).load(std::memory_order_relaxed);
  }

  bool has_first_pose() const { return has_first_pose_; }
  std::uint32_t first_pose(std::uint64_t entry) const { return kNever - earliness_[entry]; }
  std::uint32_t first_pose_now(std::uint64_t entry) {
    return kNever - std::atomic_ref(earliness_[entry]).load(std::memory_order_relaxed);
  }

  std::uint64_t count() const {
    std::uint64_t total = 0;
    for (const std::uint64_t word : words_)
      total += static_cast<std::uint64_t>(__builtin_popcountll(word));
    return total;
  }

  std::uint64_t allocated_bytes() const {
    return words_.capacity() * sizeof(std::uint64_t) + earliness_.allocated_bytes();
  }

 private:
  std::vector<std::uint64_t> words_;
  ZeroedArray<std::uint32_t> earliness_;  ///< kNever - first pose, so that zeros mean never
  bool has_first_pose_;
};

}  // namespace clearway
