// FCL with OctoMap: an octree of occupied voxels against a sphere around each model point. All
// points of a voxel that a sphere touches count as found, since the octree keeps no points.

#include <fcl/fcl.h>
#include <fcl/geometry/octree/octree.h>
#include <octomap/octomap.h>

#include <stdexcept>
#include <unordered_map>

#include "bench/peers/programs/peer.hpp"

namespace clearway::bench {
namespace {

using Object = fcl::CollisionObject<double>;

class Octomap : public Peer {
 public:
  Octomap(std::span<const Vec3> points, const PeerOptions& options)
      : Peer(options, {{"name", "FCL with OctoMap"},
                       {"version", std::string("FCL ") + FCL_VERSION},
                       {"cell", options.cell},
                       {"settings",
                        "voxels, spheres around the model points in a "
                        "DynamicAABBTreeCollisionManager, voxels that were found are not tested "
                        "again, poses in parallel"}}),
        origin_(middle_of(points)),
        map_(std::make_shared<octomap::OcTree>(options.cell)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p{points[i].x - origin_.x, points[i].y - origin_.y, points[i].z - origin_.z};
      octomap::OcTreeKey key;
      // Without the check, keys beyond 16 bits wrap around without a word.
      if (!map_->coordToKeyChecked(p.x, p.y, p.z, key)) {
        throw std::runtime_error("octomap: the scan is larger than 65,536 voxels");
      }
      const auto [at, is_new] = voxel_of_.try_emplace(key, points_of_.size());
      if (is_new) {
        points_of_.emplace_back();
        map_->updateNode(key, true, true);
      }
      points_of_[at->second].push_back(static_cast<std::uint32_t>(i));
    }
    map_->updateInnerOccupancy();
    tree_ = std::make_shared<fcl::OcTree<double>>(map_);
  }

  void search(std::span<const Pose> poses, std::span<const Vec3> model, Marks& marks) override {
    if (spheres_.empty()) set_model(model);
    Marks voxels(points_of_.size());
#pragma omp parallel for schedule(dynamic, 1) num_threads(options_.threads)
    for (std::size_t i = 0; i < poses.size(); ++i) {
      // The model stays, and the map is moved into its frame.
      Found found{this, transform_of(poses[i]), &voxels, &marks};
      Object map(tree_, found.pose.inverse(Eigen::Isometry));
      manager_.collide(&map, &found, &touch);
    }
  }

 private:
  struct Found {
    const Octomap* peer;
    fcl::Transform3d pose;
    Marks* voxels;
    Marks* points;
  };

  void set_model(std::span<const Vec3> model) {
    std::vector<Object*> all;
    const auto sphere = std::make_shared<fcl::Sphere<double>>(options_.radius);
    for (const Vec3& m : model) {
      spheres_.push_back(std::make_unique<Object>(sphere, fcl::Matrix3d::Identity(),
                                                  fcl::Vector3d(m.x, m.y, m.z)));
      all.push_back(spheres_.back().get());
    }
    manager_.octree_as_geometry_collide = false;  // voxels are passed on one by one
    manager_.registerObjects(all);
    manager_.setup();
  }

  fcl::Transform3d transform_of(const Pose& pose) const {
    fcl::Transform3d out = fcl::Transform3d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        out.linear()(row, column) = pose.rotation[3 * row + column];
      }
      out.translation()[row] = pose.translation[row] - origin_[row];
    }
    return out;
  }

  /// Called for a sphere and the box of a voxel, whose bounds overlap.
  static bool touch(Object* a, Object* b, void* data) {
    const Found& found = *static_cast<Found*>(data);
    const Object& box = a->getNodeType() == fcl::GEOM_BOX ? *a : *b;
    const fcl::Vector3d middle = found.pose * box.getTranslation();
    const Octomap& peer = *found.peer;
    const auto at = peer.voxel_of_.find(peer.map_->coordToKey(middle.x(), middle.y(), middle.z()));
    if (at == peer.voxel_of_.end() || found.voxels->contains(at->second)) return false;
    fcl::CollisionRequest<double> request;
    fcl::CollisionResult<double> result;
    if (fcl::collide(a, b, request, result) == 0) return false;
    found.voxels->mark(at->second);
    for (const std::uint32_t point : peer.points_of_[at->second]) found.points->mark(point);
    return false;
  }

  Vec3 origin_;
  std::shared_ptr<octomap::OcTree> map_;
  std::shared_ptr<fcl::OcTree<double>> tree_;
  std::unordered_map<octomap::OcTreeKey, std::size_t, octomap::OcTreeKey::KeyHash> voxel_of_;
  std::vector<std::vector<std::uint32_t>> points_of_;     ///< of each voxel
  std::vector<std::unique_ptr<Object>> spheres_;          ///< the model, made by the first search
  fcl::DynamicAABBTreeCollisionManager<double> manager_;  ///< of the spheres
};

}  // namespace

std::unique_ptr<Peer> make_peer(std::span<const Vec3> points, const PeerOptions& options) {
  return std::make_unique<Octomap>(points, options);
}

}  // namespace clearway::bench
