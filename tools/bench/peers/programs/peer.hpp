#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/predicate.hpp"

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
  std::string method;  ///< for programs that have several
  std::filesystem::path environment;
};

/// A foreign method that finds the environment points near a moved model. Each program of this
/// folder has one, used as its own documentation advises.
class Peer {
 public:
  /// about: name, version and settings of the library, as a JSON object.
  Peer(const PeerOptions& options, nlohmann::json about)
      : options_(options), about_(std::move(about)) {}
  virtual ~Peer() = default;
  const nlohmann::json& about() const { return about_; }
  /// Marks every point that is nearer than the radius to the model at any of the poses. May be
  /// called again.
  virtual void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) = 0;

 protected:
  PeerOptions options_;
  nlohmann::json about_;
};

/// Calls search(place) for the places of all model points at all poses. make() makes the `search`
/// of one thread. A pose is shared by several threads, so that a few poses keep all of them busy.
template <typename Make>
void search_places(std::span<const Pose> poses, std::span<const Vec3> model, int threads,
                   Make make) {
  constexpr std::size_t kPart = 2048;
  const std::size_t parts = (model.size() + kPart - 1) / kPart;
#pragma omp parallel num_threads(threads)
  {
    auto search = make();
#pragma omp for schedule(dynamic, 1)
    for (std::size_t task = 0; task < poses.size() * parts; ++task) {
      const std::size_t first = task % parts * kPart;
      for (const Vec3& m : model.subspan(first, std::min(kPart, model.size() - first))) {
        search(transform(poses[task / parts], m));
      }
    }
  }
}

/// The middle of the points. Floats and the keys of an octree have room near zero only, so those
/// who use them take coordinates from there.
Vec3 middle_of(std::span<const Vec3> points);

/// Prepares the search of these points, which outlive it. Defined by each program.
std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options);

}  // namespace clearway::bench
