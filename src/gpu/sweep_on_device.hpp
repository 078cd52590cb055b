#pragma once

#include "core/sweep/profile/sweep_profile.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "gpu/sweep_kernels.hpp"

namespace clearway {

/// Data that the kernels of a sweep need besides a page.
template <typename Element>
struct SweepOnDevice {
  SweepRefOf<Element> sweep;
  unsigned long long* tallies;  ///< sums of the counts, initially zero

  static constexpr std::size_t kTallies = std::size_t{kSweepCounts} * kSweepTallies;
};

/// Copies the model and its field into DeviceArrays, or counts them with DeviceArrayCount, and
/// makes `ref` refer to them there.
template <typename Element, typename Arrays>
void put_model_on_device(SweepRefOf<Element>& ref, Arrays& arrays) {
  const auto move = [&](auto*& values, std::size_t count) { values = arrays.copy(values, count); };
  const std::size_t coarse = ref.field.coarse_nodes();
  const std::size_t fine = std::size_t{ref.field.bricks} * ModelFieldRef::kBrickNodes;
  move(ref.field.coarse_squared, coarse);
  move(ref.field.coarse_nearest, ref.field.coarse_nearest == nullptr ? 0 : coarse);
  move(ref.field.brick_of, coarse);
  move(ref.field.distances, fine);
  move(ref.field.nearest, fine);
  if constexpr (kIsSolid<Element>) {
    FieldInsideRef& inside = ref.field.inside;
    move(inside.cells, coarse);
    move(inside.nodes,
         std::size_t{ref.field.bricks} * FieldInsideRef::words_for(ModelFieldRef::kBrickNodes));
    move(inside.solids.parts, inside.solids.count);
    move(inside.solids.triangles, inside.solids.triangle_count);
    move(inside.solids.boxes, inside.solids.box_count);
  }
  move(ref.model.elements, ref.model.size);
  move(ref.model.boxes, ref.model.box_count);
}

/// Copies what a sweep has besides the model and its field, as put_model_on_device() does.
template <typename Element, typename Arrays>
SweepOnDevice<Element> put_poses_on_device(SweepRefOf<Element> ref, Arrays& arrays) {
  const auto move = [&](auto*& values, std::size_t count) { values = arrays.copy(values, count); };
  const std::size_t poses = ref.motion.pose_count;
  move(ref.wide.nodes, ref.wide.node_count);
  ref.wide.slabs = nullptr;
  move(ref.wide.packets, ref.wide.packet_count);
  move(ref.motion.nodes, poses == 0 ? 0 : 2 * poses - 1);
  move(ref.motion.inverse_poses, poses);
  move(ref.motion.poses, poses);
  move(ref.motion.curves, ref.motion.curves == nullptr ? 0 : 2 * poses - 1);
  // Null says that there is no floor.
  if (ref.motion.floors != nullptr) move(ref.motion.floors, 2 * poses - 1);
  return {ref, arrays.template zeros<unsigned long long>(SweepOnDevice<Element>::kTallies)};
}

/// Copies a sweep's data into DeviceArrays, or counts it with DeviceArrayCount.
template <typename Element, typename Arrays>
SweepOnDevice<Element> put_on_device(const SweepRefOf<Element>& sweep, Arrays& arrays) {
  SweepRefOf<Element> ref = sweep;
  put_model_on_device(ref, arrays);
  return put_poses_on_device(ref, arrays);
}

/// Copies what is known of the poses into DeviceArrays, or counts it with DeviceArrayCount. Empty
/// without a profile.
template <typename Element, typename Arrays>
ProfileBests put_on_device(const SweepRefOf<Element>& sweep, const ProfileBests& bests,
                           Arrays& arrays) {
  if (!(sweep.profile > 0)) return {};
  const auto move = [&](double* values, std::size_t count) {
    return const_cast<double*>(arrays.copy(static_cast<const double*>(values), count));
  };
  const std::size_t poses = sweep.motion.pose_count;
  return {bests.limit, move(bests.of_pose, poses),
          move(bests.of_node, poses == 0 ? 0 : 2 * poses - 1)};
}

}  // namespace clearway
