#include "gpu/sweep_engine.hpp"

#include <algorithm>

#include "core/sweep/profile/host_profile.hpp"
#include "gpu/cuda_page_search.hpp"
#include "gpu/kept_on_device.hpp"
#include "gpu/sweep_on_device.hpp"
#include "gpu/sweep_work_arrays.hpp"

namespace clearway {
namespace {

/// Room for a profile's facts. Most poses of a page have one fact or none, and some have a few. A
/// search on the host takes far longer than copying lists that are not full.
constexpr std::uint64_t kFactsAhead = 1024, kMostFactsOfPoses = std::uint64_t{1} << 20;

template <typename Element>
ResultParts parts_of(const SweepRefOf<Element>& sweep) {
  return {.first_pose = sweep.first_pose,
          .clearance = sweep.clearance > 0,
          .profile = sweep.profile > 0,
          .facts_ahead =
              kFactsAhead + std::min<std::uint64_t>(sweep.motion.pose_count, kMostFactsOfPoses)};
}

/// Greatest number of blocks of a page.
std::uint64_t most_blocks(const PackedCloud& cloud, const SlotLayout& layout) {
  return std::uint64_t{layout.cells} * cloud.blocks_per_cell();
}

template <typename Element>
CudaSlotSize size_of_slot(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                          const SlotLayout& layout) {
  const std::uint64_t blocks = most_blocks(cloud, layout);
  ArrayRun result, work;
  PageResultArrays(result, blocks, parts_of(sweep));
  SweepWorkArrays(work, sweep, blocks);
  return {.page = PageShape::aligned(layout.page_bytes),
          .plan = 0,
          .result = result.bytes(),
          .work = work.bytes()};
}

/// A model and its field on a device.
template <typename Element>
struct ModelOnDevice {
  explicit ModelOnDevice(const SweepRefOf<Element>& sweep) : ref(sweep) {
    put_model_on_device(ref, arrays);
  }

  DeviceArrays arrays;
  SweepRefOf<Element> ref;  ///< of which only the model and the field are of use
};

/// A sweep whose model and field are those on a device.
template <typename Element>
SweepRefOf<Element> with_model(SweepRefOf<Element> sweep, const ModelOnDevice<Element>& model) {
  sweep.field = model.ref.field;
  sweep.model = model.ref.model;
  return sweep;
}

/// The copy of a sweep's model and field that is kept on a device. field: that of the sweep.
template <typename Element>
std::shared_ptr<const ModelOnDevice<Element>> kept_model(const SweepRefOf<Element>& sweep,
                                                         const std::shared_ptr<const void>& field,
                                                         KeptOnDevice& kept) {
  const auto make = [&]() -> KeptOnDevice::KeptModel {
    auto made = std::make_shared<const ModelOnDevice<Element>>(sweep);
    return {field, made, made->arrays.bytes()};
  };
  return std::static_pointer_cast<const ModelOnDevice<Element>>(kept.model(field, make));
}

/// Bytes of the arrays of a sweep besides its model and field.
template <typename Element>
std::uint64_t bytes_of_poses(const SweepRefOf<Element>& sweep) {
  DeviceArrayCount count;
  put_poses_on_device(sweep, count);
  put_on_device(sweep, ProfileBests{}, count);
  return count.bytes_in_a_run();
}

template <typename Element>
class SweepSearch final : public CudaPageSearch {
 public:
  /// model: the one of the sweep where it is kept on the device, or null. arrays: memory there for
  /// the other arrays, as far as it is enough for them.
  SweepSearch(int device, const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
              const SlotLayout& layout, std::shared_ptr<const ModelOnDevice<Element>> model = {},
              std::span<std::byte> arrays = {})
      : CudaPageSearch(device, parts_of(sweep), arrays),
        resident_(resident_sweep_blocks(device)),
        quantisation_(cloud.quantisation()),
        size_(size_of_slot(sweep, cloud, layout)),
        model_(std::move(model)),
        on_device_(model_ ? put_poses_on_device(with_model(sweep, *model_), arrays_)
                          : put_on_device(sweep, arrays_)),
        work_(work_run_, sweep, most_blocks(cloud, layout)),
        sweep_(sweep),
        cloud_(cloud),
        facts_(layout.slots) {
    if (!(sweep.profile > 0)) return;
    ProfileBestValues values(sweep);
    bests_ = put_on_device(sweep, values.ref(), arrays_);
  }

  std::uint64_t device_bytes() const override {
    return arrays_.bytes() + (model_ ? model_->arrays.bytes() : 0);
  }

  const CudaSlotSize& slot_size() const override { return size_; }

  void enqueue(const CudaPage& page) const override {
    const SweepPageOf<Element> job{.sweep = on_device_.sweep,
                                   .page = page.page,
                                   .quantisation = quantisation_,
                                   .hits = page.hits,
                                   .first_poses = page.first_poses,
                                   .clearances = page.clearances,
                                   .work = work_.in(page.work)};
    search_sweep(job, on_device_.tallies, resident_, page.stream);
    if (page.facts.empty()) return;
    const ProfileList list{page.facts.data(), page.fact_counts,
                           static_cast<std::uint32_t>(page.facts.size())};
    search_profile(job, bests_, list, on_device_.tallies, resident_, page.stream);
  }

  std::span<const ProfileFact> profile(std::uint32_t slot, const PageRef& page,
                                       std::span<const ProfileFact> listed,
                                       std::uint32_t count) override {
    std::vector<ProfileFact>& facts = facts_[slot];
    facts.clear();
    HostProfileOf<Element> host(cloud_, sweep_);
    if (count > listed.size()) {
      ProfileBestValues known = known_bests();
      host.search(page, known.ref(), facts);
    } else {
      const auto found = listed.first(count);
      facts.assign(found.begin(), found.end());
      host.complete(page, facts);
    }
    return facts;
  }

  SweepStatistics statistics() const {
    use_device();
    unsigned long long values[SweepOnDevice<Element>::kTallies];
    check_cuda(cudaMemcpy(values, on_device_.tallies, sizeof(values), cudaMemcpyDeviceToHost));
    SweepStatistics total;
    for (std::size_t i = 0; i < SweepOnDevice<Element>::kTallies; i += kSweepCounts) {
      total.add({values[i], values[i + 1], values[i + 2], values[i + 3]});
    }
    return total;
  }

 private:
  /// What the device knows of the poses by now, so that the host need not find it again.
  ProfileBestValues known_bests() const {
    ProfileBestValues values(sweep_);
    const ProfileBests to = values.ref();
    const std::size_t poses = sweep_.motion.pose_count;
    check_cuda(
        cudaMemcpy(to.of_pose, bests_.of_pose, poses * sizeof(double), cudaMemcpyDeviceToHost));
    const std::size_t nodes = poses == 0 ? 0 : 2 * poses - 1;
    check_cuda(
        cudaMemcpy(to.of_node, bests_.of_node, nodes * sizeof(double), cudaMemcpyDeviceToHost));
    return values;
  }

  unsigned resident_;
  Quantisation quantisation_;
  CudaSlotSize size_;
  std::shared_ptr<const ModelOnDevice<Element>> model_;  ///< where it is kept
  SweepOnDevice<Element> on_device_;
  ArrayRun work_run_;
  SweepWorkArrays work_;
  ProfileBests bests_{};             ///< on the device; only with a profile
  const SweepRefOf<Element> sweep_;  ///< on the host
  const PackedCloud& cloud_;
  std::vector<std::vector<ProfileFact>> facts_;  ///< for each slot
};

}  // namespace

template <typename Element>
CudaSweepEngineOf<Element>::CudaSweepEngineOf(int device, const SweepRefOf<Element>& sweep,
                                              const PackedCloud& cloud, const SlotLayout& layout)
    : CudaPageEngine(layout.slots,
                     std::make_unique<SweepSearch<Element>>(device, sweep, cloud, layout)) {}

template <typename Element>
std::unique_ptr<PageEngine> CudaSweepEngineOf<Element>::of_kept(
    const SweepRefOf<Element>& sweep, const std::shared_ptr<const void>& field,
    const PackedCloud& cloud, const SlotLayout& layout, std::shared_ptr<KeptOnDevice> kept) {
  const int device = kept->device();
  check_cuda(cudaSetDevice(device));
  auto model = kept_model(sweep, field, *kept);
  auto slots = kept->slots(layout.slots, size_of_slot(sweep, cloud, layout), bytes_of_poses(sweep));
  const std::span arrays(slots->arrays.data(), slots->arrays.bytes());
  auto search = std::make_unique<SweepSearch<Element>>(device, sweep, cloud, layout,
                                                       std::move(model), arrays);
  return std::unique_ptr<PageEngine>(new CudaSweepEngineOf(
      layout.slots, std::move(search), std::move(slots), cloud, std::move(kept)));
}

template <typename Element>
SweepStatistics CudaSweepEngineOf<Element>::statistics() const {
  return static_cast<const SweepSearch<Element>&>(search()).statistics();
}

template <typename Element>
std::uint64_t cuda_sweep_bytes(const SweepRefOf<Element>& sweep) {
  DeviceArrayCount count;
  put_on_device(sweep, count);
  put_on_device(sweep, ProfileBests{}, count);
  return count.bytes();
}

template <typename Element>
std::uint64_t cuda_model_bytes(const SweepRefOf<Element>& sweep) {
  DeviceArrayCount count;
  SweepRefOf<Element> ref = sweep;
  put_model_on_device(ref, count);
  return count.bytes();
}

template <typename Element>
std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                    const SlotLayout& layout) {
  return size_of_slot(sweep, cloud, layout).device();
}

template <typename Element>
std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<Element>& sweep, const PackedCloud& cloud,
                                      const SlotLayout& layout) {
  return size_of_slot(sweep, cloud, layout).pinned();
}

template class CudaSweepEngineOf<Vec3>;
template class CudaSweepEngineOf<Triangle>;
template class CudaSweepEngineOf<SolidTriangle>;
template std::uint64_t cuda_sweep_bytes(const SweepRefOf<Vec3>&);
template std::uint64_t cuda_model_bytes(const SweepRefOf<Vec3>&);
template std::uint64_t cuda_model_bytes(const SweepRefOf<Triangle>&);
template std::uint64_t cuda_model_bytes(const SweepRefOf<SolidTriangle>&);
template std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<Vec3>&, const PackedCloud&,
                                             const SlotLayout&);
template std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<Vec3>&, const PackedCloud&,
                                               const SlotLayout&);
template std::uint64_t cuda_sweep_bytes(const SweepRefOf<Triangle>&);
template std::uint64_t cuda_sweep_bytes(const SweepRefOf<SolidTriangle>&);
template std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<Triangle>&, const PackedCloud&,
                                             const SlotLayout&);
template std::uint64_t cuda_sweep_slot_bytes(const SweepRefOf<SolidTriangle>&, const PackedCloud&,
                                             const SlotLayout&);
template std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<Triangle>&, const PackedCloud&,
                                               const SlotLayout&);
template std::uint64_t cuda_sweep_pinned_bytes(const SweepRefOf<SolidTriangle>&, const PackedCloud&,
                                               const SlotLayout&);

}  // namespace clearway
