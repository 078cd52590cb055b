#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway::bench {

/// A set of points that many threads mark at the same time.
class Marks {
 public:
  explicit Marks(std::size_t points) : words_((points + 63) / 64) {}

  void mark(std::size_t point) {
    std::atomic_ref word(words_[point / 64]);
    const std::uint64_t bit = std::uint64_t{1} << (point % 64);
    // Most points that collide do so again and again, and a look is cheaper than a change.
    if ((word.load(std::memory_order_relaxed) & bit) == 0) {
      word.fetch_or(bit, std::memory_order_relaxed);
    }
  }
  bool contains(std::size_t point) const {
    const std::uint64_t word = std::atomic_ref(const_cast<std::uint64_t&>(words_[point / 64]))
                                   .load(std::memory_order_relaxed);
    return (word >> (point % 64) & 1) != 0;
  }

 private:
  std::vector<std::uint64_t> words_;
};

struct PeerOptions {
  double radius = 0.1;
  int threads = 1;
  double cell = 0.05;  ///< metres: the edge of a voxel, for methods that have some
};

/// A foreign method that finds the environment points near a moved model. Each program of this
/// folder has one, used as its own documentation advises.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Name, version and settings of the library, as a JSON object.
  virtual nlohmann::json about() const = 0;
  /// Marks every point that is nearer than the radius to the model at any of the poses. May be
  /// called again.
  virtual void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) = 0;
};

/// Prepares the search of these points, which outlive it. Defined by each program.
std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options);

}  // namespace clearway::bench
