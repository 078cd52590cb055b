#pragma once

#include <cstdint>
#include <span>

#include "core/grid/grid_scene.hpp"
#include "gpu/device_array.hpp"

namespace clearway {

/// A GridScene's arrays on the current device.
class GridOnDevice {
 public:
  explicit GridOnDevice(const GridScene& scene)
      : points_(copied(scene.model().points())),
        groups_(copied(scene.model().groups())),
        parts_(copied(scene.model().parts())),
        poses_(copied(scene.poses())),
        bounds_(copied(scene.bounds())),
        nodes_(copied(scene.nodes())),
        runs_(copied(scene.runs())),
        view_(scene.view_over(points_.data(), groups_.data(), parts_.data(), poses_.data(),
                              bounds_.data(), nodes_.data(), runs_.data())) {}

  const GridSceneView& view() const { return view_; }

  std::uint64_t allocated_bytes() const {
    return points_.bytes() + groups_.bytes() + parts_.bytes() + poses_.bytes() + bounds_.bytes() +
           nodes_.bytes() + runs_.bytes();
  }

 private:
  template <typename Value>
  static DeviceBuffer<Value> copied(std::span<const Value> values) {
    return copied_to_device(values.data(), values.size());
  }

  DeviceBuffer<Vec3> points_;
  DeviceBuffer<GridSphere> groups_, parts_;
  DeviceBuffer<Pose> poses_;
  DeviceBuffer<PoseBound> bounds_;
  DeviceBuffer<GridNode> nodes_;
  DeviceBuffer<std::uint32_t> runs_;
  GridSceneView view_;
};

}  // namespace clearway
