#pragma once

#include "core/grid/grid_scene.hpp"

namespace clearway {

/// Data that the kernels of the grid engine need besides a page.
struct GridOnDevice {
  GridSceneView scene;
  GridStatistics* statistics;  ///< counts of all pages, initially zero
};

/// Copies a scene's data into DeviceArrays, or counts it with DeviceArrayCount.
template <typename Arrays>
GridOnDevice put_on_device(const GridScene& scene, Arrays& arrays) {
  GridSceneView view = scene.view();
  scene.for_each_array(
      [&](auto member, auto values) { view.*member = arrays.copy(values.data(), values.size()); });
  return {view, arrays.template zeros<GridStatistics>(1)};
}

}  // namespace clearway
