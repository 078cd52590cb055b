// Open3D: fixed radius search of tensors, whose grid of cells is made for one radius.

#include <open3d/Open3DConfig.h>
#include <open3d/core/Tensor.h>
#include <open3d/core/nns/NearestNeighborSearch.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "bench/peers/programs/peer.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway::bench {
namespace {

namespace o3c = open3d::core;

class Open3d : public Peer {
 public:
  Open3d(std::span<const Vec3> points, const PeerOptions& options)
      : options_(options),
        limit_(tbb::global_control::max_allowed_parallelism,
               static_cast<std::size_t>(options.threads)),
        search_(o3c::Tensor(&points[0].x, {static_cast<std::int64_t>(points.size()), 3},
                            o3c::Float64)) {
    if (!search_.FixedRadiusIndex(options.radius)) throw std::runtime_error("open3d: no index");
  }

  nlohmann::json about() const override {
    return {{"name", "Open3D"},
            {"version", OPEN3D_VERSION},
            {"settings",
             "NearestNeighborSearch::FixedRadiusSearch, doubles, unsorted, the model "
             "points of a pose together, its own threads"}};
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    std::vector<Vec3> places(model.size());
    for (const Pose& pose : poses) {
      for (std::size_t k = 0; k < model.size(); ++k) places[k] = transform(pose, model[k]);
      const o3c::Tensor queries(&places[0].x, {static_cast<std::int64_t>(places.size()), 3},
                                o3c::Float64);
      const auto [found, distances, splits] =
          search_.FixedRadiusSearch(queries, options_.radius, false);
      const auto* index = found.GetDataPtr<std::int32_t>();
      for (std::int64_t i = 0; i < found.NumElements(); ++i) {
        marks.mark(static_cast<std::size_t>(index[i]));
      }
    }
  }

 private:
  PeerOptions options_;
  tbb::global_control limit_;
  o3c::nns::NearestNeighborSearch search_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Open3d>(points, options);
}

}  // namespace clearway::bench
