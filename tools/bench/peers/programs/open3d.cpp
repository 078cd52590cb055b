// Open3D: fixed radius search of tensors, which takes a k-d tree on the CPU. Its grid of cells for
// one radius, FixedRadiusIndex, took six times as long on a small hall.

#include <open3d/Open3DConfig.h>
#include <open3d/core/Tensor.h>
#include <open3d/core/nns/NearestNeighborSearch.h>
#include <tbb/global_control.h>

#include "bench/peers/programs/peer.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway::bench {
namespace {

namespace o3c = open3d::core;

class Open3d : public Peer {
 public:
  Open3d(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "Open3D"},
                       {"version", OPEN3D_VERSION},
                       {"settings",
                        "NearestNeighborSearch::FixedRadiusSearch, doubles, unsorted, 262,144 "
                        "places together, its own threads"}}),
        limit_(tbb::global_control::max_allowed_parallelism,
               static_cast<std::size_t>(options.threads)),
        search_(o3c::Tensor(&points[0].x, {static_cast<std::int64_t>(points.size()), 3},
                            o3c::Float64)) {
    if (!search_.FixedRadiusIndex(options.radius)) throw std::runtime_error("open3d: no index");
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    // So many places together that all threads have work.
    const std::size_t together = std::max<std::size_t>(1, kPlaces / model.size());
    for (std::size_t first = 0; first < poses.size(); first += together) {
      search_together(poses.subspan(first, std::min(together, poses.size() - first)), model, marks);
    }
  }

 private:
  static constexpr std::size_t kPlaces = 1 << 18;

  void search_together(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) {
    std::vector<Vec3> places(poses.size() * model.size());
#pragma omp parallel for num_threads(options_.threads)
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = transform(poses[i / model.size()], model[i % model.size()]);
    }
    const o3c::Tensor queries(&places[0].x, {static_cast<std::int64_t>(places.size()), 3},
                              o3c::Float64);
    const auto [found, distances, splits] =
        search_.FixedRadiusSearch(queries, options_.radius, false);
    const std::int32_t* index = found.GetDataPtr<std::int32_t>();
    const std::int64_t count = found.NumElements();
#pragma omp parallel for num_threads(options_.threads)
    for (std::int64_t i = 0; i < count; ++i) marks.mark(static_cast<std::size_t>(index[i]));
  }

  tbb::global_control limit_;
  o3c::nns::NearestNeighborSearch search_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Open3d>(points, options);
}

}  // namespace clearway::bench
