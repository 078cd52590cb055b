#pragma once

#include <cstdint>

#include "core/sweep/sweep_ref.hpp"
#include "gpu/device_array.hpp"

namespace clearway {

/// Everything that a SweepRef refers to, on a device.
class SweepOnDevice {
 public:
  explicit SweepOnDevice(const SweepRef& sweep)
      : ref_(sweep),
        coarse_squared_(copied_to_device(sweep.field.coarse_squared, sweep.field.coarse_nodes())),
        coarse_nearest_(copied_to_device(
            sweep.field.coarse_nearest,
            sweep.field.coarse_nearest == nullptr ? 0 : sweep.field.coarse_nodes())),
        brick_of_(copied_to_device(sweep.field.brick_of, sweep.field.coarse_nodes())),
        distances_(copied_to_device(sweep.field.distances, brick_nodes(sweep))),
        nearest_(copied_to_device(sweep.field.nearest, brick_nodes(sweep))),
        points_(copied_to_device(sweep.model.points, sweep.model.size)),
        boxes_(copied_to_device(sweep.model.boxes, sweep.model.box_count)),
        nodes_(copied_to_device(sweep.motion.nodes, motion_nodes(sweep))),
        inverse_poses_(copied_to_device(sweep.motion.inverse_poses, sweep.motion.pose_count)),
        poses_(copied_to_device(sweep.motion.poses, sweep.motion.pose_count)) {
    ref_.field.coarse_squared = coarse_squared_.data();
    ref_.field.coarse_nearest = coarse_nearest_.data();
    ref_.field.brick_of = brick_of_.data();
    ref_.field.distances = distances_.data();
    ref_.field.nearest = nearest_.data();
    ref_.model.points = points_.data();
    ref_.model.boxes = boxes_.data();
    ref_.motion.nodes = nodes_.data();
    ref_.motion.inverse_poses = inverse_poses_.data();
    ref_.motion.poses = poses_.data();
  }

  const SweepRef& ref() const { return ref_; }

  std::uint64_t allocated_bytes() const {
    return coarse_squared_.bytes() + coarse_nearest_.bytes() + brick_of_.bytes() +
           distances_.bytes() + nearest_.bytes() + points_.bytes() + boxes_.bytes() +
           nodes_.bytes() + inverse_poses_.bytes() + poses_.bytes();
  }

  /// That, before it is made.
  static std::uint64_t bytes(const SweepRef& sweep) {
    const std::uint64_t coarse =
        sweep.field.coarse_nodes() * (sweep.field.coarse_nearest == nullptr ? 8 : 12);
    return coarse + brick_nodes(sweep) * 8 + sweep.model.size * sizeof(Vec3) +
           sweep.model.box_count * sizeof(Box) + motion_nodes(sweep) * sizeof(MotionNode) +
           sweep.motion.pose_count * (sizeof(InversePose) + sizeof(Pose));
  }

 private:
  static std::size_t brick_nodes(const SweepRef& sweep) {
    return std::size_t{sweep.field.bricks} * ModelFieldRef::kBrickNodes;
  }
  static std::size_t motion_nodes(const SweepRef& sweep) {
    const std::size_t poses = sweep.motion.pose_count;
    return poses == 0 ? 0 : 2 * poses - 1;
  }

  SweepRef ref_;
  DeviceBuffer<float> coarse_squared_;
  DeviceBuffer<std::uint32_t> coarse_nearest_, brick_of_;
  DeviceBuffer<float> distances_;
  DeviceBuffer<std::uint32_t> nearest_;
  DeviceBuffer<Vec3> points_;
  DeviceBuffer<Box> boxes_;
  DeviceBuffer<MotionNode> nodes_;
  DeviceBuffer<InversePose> inverse_poses_;
  DeviceBuffer<Pose> poses_;
};

}  // namespace clearway
