// PCL: KdTreeFLANN, which holds points in floats.

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "bench/peers/programs/peer.hpp"

namespace clearway::bench {
namespace {

class Pcl : public Peer {
 public:
  Pcl(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "PCL"},
                       {"version", PCL_VERSION_PRETTY},
                       {"settings",
                        "KdTreeFLANN, floats from the middle of the scan, unsorted, places in "
                        "parallel; the tree is built by one thread"}}),
        origin_(middle_of(points)),
        tree_(false) {
    const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->reserve(points.size());
    for (const Vec3& p : points) cloud->push_back(point_at(p));
    tree_.setInputCloud(cloud);
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    search_places(poses, model, options_.threads, [&] {
      return [this, &marks, found = pcl::Indices(),
              squared = std::vector<float>()](const Vec3& at) mutable {
        tree_.radiusSearch(point_at(at), options_.radius, found, squared);
        for (const int index : found) marks.mark(static_cast<std::size_t>(index));
      };
    });
  }

 private:
  pcl::PointXYZ point_at(const Vec3& p) const {
    return {static_cast<float>(p.x - origin_.x), static_cast<float>(p.y - origin_.y),
            static_cast<float>(p.z - origin_.z)};
  }

  Vec3 origin_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Pcl>(points, options);
}

}  // namespace clearway::bench
