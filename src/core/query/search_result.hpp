#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/query.hpp"
#include "core/query/body_numbers.hpp"

namespace clearway {

/// An array of zeros. The system provides its memory when it is first touched, so that an array of
/// which little is used costs little, and the threads that use it share the work.
template <typename Number>
class ZeroedArray {
  static_assert(std::is_arithmetic_v<Number>);

 public:
  ZeroedArray() = default;
  explicit ZeroedArray(std::uint64_t size) : numbers_(map(size), {size}), size_(size) {}

  Number& operator[](std::size_t i) { return numbers_.get()[i]; }
  const Number& operator[](std::size_t i) const { return numbers_.get()[i]; }
  std::uint64_t size() const { return size_; }
  std::uint64_t allocated_bytes() const { return size_ * sizeof(Number); }

 private:
  struct Unmap {
    std::uint64_t size = 0;
    void operator()(Number* numbers) const { ::munmap(numbers, size * sizeof(Number)); }
  };

  /// Pages straight from the system. std::calloc would clear memory that was used before.
  static Number* map(std::uint64_t size) {
    if (size == 0) return nullptr;
    void* const pages = ::mmap(nullptr, size * sizeof(Number), PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<Number*>(pages);
  }

  std::unique_ptr<Number, Unmap> numbers_;
  std::uint64_t size_ = 0;
};

/// The distance that belongs to a squared distance; both are below 0 inside solids
/// (docs/design/solids.md).
inline double signed_root(double squared) {
  return squared < 0 ? -std::sqrt(-squared) : std::sqrt(squared);
}

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
    std::fill_n(&words_[first], count, 0);
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
    for (std::uint64_t i = 0; i < words_.size(); ++i) {
      total += static_cast<std::uint64_t>(std::popcount(words_[i]));
    }
    return total;
  }

  std::uint64_t allocated_bytes() const {
    return words_.allocated_bytes() + earliness_.allocated_bytes();
  }

 private:
  ZeroedArray<std::uint64_t> words_;
  ZeroedArray<std::uint32_t> earliness_;  ///< kNever - first pose, so that zeros mean never
  bool has_first_pose_;
};

/// The least computed d2 between an environment point and the model over all poses, square metres,
/// and the lowest pose that has it. The distance is its root. For a point inside solids it is below
/// 0: minus the square of the greatest depth.
struct Clearance {
  double squared = std::numeric_limits<double>::infinity();
  std::uint32_t pose = std::numeric_limits<std::uint32_t>::max();
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const Clearance&, const Clearance&) = default;
};

/// A fact that a search found for a pose: a point of the environment, and the least computed d2
/// between it and the model at that pose, square metres.
struct ProfileFact {
  double squared;
  std::uint32_t pose;
  std::uint32_t point;  ///< slot in the page, numbered as first poses are
  /// 1 if other points of the cell have the same d2, and source indices were not compared
  std::uint32_t tied;
};

/// Counters of a page that a device searches.
struct ProfileCounts {
  std::uint32_t facts;  ///< facts found, which may be more than the list holds
  std::uint32_t tasks;  ///< tasks taken
};

/// The point nearest to the model at a pose; of several, the one with the smallest source index.
struct ProfilePoint {
  double squared = std::numeric_limits<double>::infinity();
  std::uint64_t source = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t entry = 0;  ///< entry of the point in a PackedCloud
  bool found() const { return squared < std::numeric_limits<double>::infinity(); }
  friend bool operator==(const ProfilePoint&, const ProfilePoint&) = default;
};

/// The nearest point of every pose, 24 bytes each; none if no point is below the distance asked
/// for. Offers are thread safe and may come in any order.
class ProfileSet {
 public:
  ProfileSet() = default;
  explicit ProfileSet(std::uint64_t poses)
      : points_(poses), mutex_(std::make_unique<std::mutex>()) {}

  std::uint64_t poses() const { return points_.size(); }

  void offer(std::uint32_t pose, const ProfilePoint& point) {
    const std::lock_guard lock(*mutex_);
    ProfilePoint& known = points_[pose];
    if (point.squared < known.squared ||
        (point.squared == known.squared && point.source < known.source)) {
      known = point;
    }
  }

  /// Whether this entry is the best one so far.
  bool holds(std::uint32_t pose, std::uint64_t entry) const {
    const std::lock_guard lock(*mutex_);
    return points_[pose].found() && points_[pose].entry == entry;
  }

  /// The nearest point of a pose. Must not be called while others offer.
  const ProfilePoint& at(std::uint64_t pose) const { return points_[pose]; }

  std::uint64_t count() const {
    std::uint64_t total = 0;
    for (const ProfilePoint& point : points_) total += point.found();
    return total;
  }

  std::uint64_t allocated_bytes() const { return points_.capacity() * sizeof(ProfilePoint); }

 private:
  std::vector<ProfilePoint> points_;
  std::unique_ptr<std::mutex> mutex_;
};

/// The query with its poses in reverse order, whose first poses give the last poses of `query`. It
/// asks for nothing else.
Query backwards(const Query& query);

/// The greatest index of a pose that touches a colliding point. Between poses it is the start of
/// the last way that touches it (docs/design/findings.md, "Last poses").
class LastPoses {
 public:
  explicit LastPoses(const Query& query)
      : numbers_(query),
        last_(static_cast<std::uint32_t>(std::max<std::size_t>(query.poses.size(), 1) - 1)),
        ways_(query.between_poses && last_ > 0 ? 1 : 0) {}

  /// The last pose of a point. first: its first pose; backward: its number in the answer of
  /// backwards(query).
  std::uint32_t of(std::uint32_t first, std::uint32_t backward) const {
    const std::uint32_t before = numbers_.pose_of(backward) + ways_;
    return before > last_ ? first : std::max(first, last_ - before);
  }

 private:
  BodyNumbers numbers_;
  std::uint32_t last_;
  std::uint32_t ways_;  ///< 1 if a pose stands for the way from it to the next, otherwise 0
};

/// The free point that is nearest to a colliding one (docs/design/depth.md).
struct Depth {
  static constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};
  double distance = std::numeric_limits<double>::quiet_NaN();  ///< metres; NaN if none is free
  std::uint64_t source = kNoPoint;  ///< of several the smallest; kNoPoint if none is free
};

}  // namespace clearway
