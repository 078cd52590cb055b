// PCL: KdTreeFLANN, which holds points in floats.

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <nlohmann/json.hpp>

#include "bench/peers/programs/peer.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway::bench {
namespace {

class Pcl : public Peer {
 public:
  Pcl(std::span<const Vec3> points, const PeerOptions& options) : options_(options), tree_(false) {
    Box box{points[0], points[0]};
    for (const Vec3& p : points) box = box.united(Box{p, p});
    // Coordinates are taken from the middle of the scan, because floats have no room for more.
    for (int k = 0; k < 3; ++k) origin_[k] = (box.lo[k] + box.hi[k]) / 2;
    const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->reserve(points.size());
    for (const Vec3& p : points) cloud->push_back(point_at(p));
    tree_.setInputCloud(cloud);
  }

  nlohmann::json about() const override {
    return {{"name", "PCL"},
            {"version", PCL_VERSION_PRETTY},
            {"settings",
             "KdTreeFLANN, floats from the middle of the scan, unsorted, poses in "
             "parallel"}};
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
#pragma omp parallel num_threads(options_.threads)
    {
      pcl::Indices found;
      std::vector<float> squared;
#pragma omp for schedule(dynamic, 1)
      for (std::size_t i = 0; i < poses.size(); ++i) {
        for (const Vec3& m : model) {
          tree_.radiusSearch(point_at(transform(poses[i], m)), options_.radius, found, squared);
          for (const int index : found) marks.mark(static_cast<std::size_t>(index));
        }
      }
    }
  }

 private:
  pcl::PointXYZ point_at(const Vec3& p) const {
    return {static_cast<float>(p.x - origin_[0]), static_cast<float>(p.y - origin_[1]),
            static_cast<float>(p.z - origin_[2])};
  }

  PeerOptions options_;
  double origin_[3];
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Pcl>(points, options);
}

}  // namespace clearway::bench
