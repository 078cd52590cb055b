#include "core/sweep/profile/profile_page.hpp"
#include "core/sweep/sweep_block.hpp"
#include "gpu/cuda_objects.hpp"
#include "gpu/sweep_kernels.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWarpsPerBlock = 4;
constexpr unsigned kThreads = kWarpsPerBlock * kWarpLanes;
/// Number of thread blocks that run on a processor at a time; registers are limited so that they
/// do, because latency is what there is to hide.
constexpr unsigned kBlocksPerProcessor = 8;

/// Number of thread blocks that run on a processor at a time in a search for clearances, which
/// needs more registers than a search for collisions: with more blocks it would spill them to
/// memory.
constexpr unsigned kClearanceBlocks = 4;

__device__ void tally(unsigned long long* total, std::uint64_t of_lane) {
  const std::uint32_t sum = sum_of_lanes(static_cast<std::uint32_t>(of_lane));
  if (threadIdx.x % kWarpLanes == 0 && sum != 0) {
    atomicAdd(total, static_cast<unsigned long long>(sum));
  }
}

__device__ void tally(unsigned long long* tallies, const SweepStatistics& of_lane) {
  unsigned long long* total = tallies + kSweepCounts * (blockIdx.x % kSweepTallies);
  tally(total, of_lane.node_tests);
  tally(total + 1, of_lane.point_tests);
  tally(total + 2, of_lane.exact_tests);
  tally(total + 3, of_lane.points_tested);
}

/// Searches the blocks of the page's cells, one by each warp.
template <bool kClearance, typename Element>
__global__ void __launch_bounds__(kThreads, kClearance ? kClearanceBlocks : kBlocksPerProcessor)
    search_blocks_kernel(const __grid_constant__ SweepPageOf<Element> job,
                         unsigned long long* tallies) {
  using Block = SweepBlock<CudaWarp, kClearance, Element>;
  __shared__ typename Block::Shared shared[kWarpsPerBlock];
  const std::uint32_t warp = threadIdx.x / kWarpLanes;
  const std::uint32_t block = blockIdx.x * kWarpsPerBlock + warp;
  if (block >= job.block_count()) return;
  CudaWarp::PerLane<SweepStatistics> statistics;
  Block(job, block, shared[warp], statistics).search();
  tally(tallies, statistics[0]);
}

/// Searches the page's entries. Warps take one after another, because some take far longer than
/// others.
template <typename Element>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_entries_kernel(const __grid_constant__ SweepPageOf<Element> job,
                          unsigned long long* tallies) {
  const std::uint32_t count = job.work.entry_count();
  CudaWarp::PerLane<SweepStatistics> statistics;
  for (;;) {
    const std::uint32_t index = CudaWarp::add(&job.work.counts->taken, 1, count);
    if (index >= count) break;
    search_entry<CudaWarp>(job, job.work.entry(index), statistics);
  }
  tally(tallies, statistics[0]);
}

/// Searches the page's walks, one by each lane.
template <typename Element>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_walks_kernel(const __grid_constant__ SweepPageOf<Element> job,
                        unsigned long long* tallies) {
  const std::uint32_t count = job.work.walk_count();
  const std::uint32_t warp = blockIdx.x * kWarpsPerBlock + threadIdx.x / kWarpLanes;
  CudaWarp::PerLane<SweepStatistics> statistics;
  for (std::uint32_t first = warp * kWarpLanes; first < count; first += gridDim.x * kThreads) {
    SweepHits<CudaWarp, Element>(job, statistics).search_walks(first, count);
  }
  tally(tallies, statistics[0]);
}

/// Searches the page's items, one by each thread.
template <typename Element>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_items_kernel(const __grid_constant__ SweepPageOf<Element> job,
                        unsigned long long* tallies) {
  const std::uint32_t count = job.work.item_count();
  SweepStatistics statistics;
  for (std::uint32_t i = blockIdx.x * kThreads + threadIdx.x; i < count;
       i += gridDim.x * kThreads) {
    search_item(job, job.work.items[i], statistics);
  }
  __syncwarp();
  tally(tallies, statistics);
}

/// Searches the page's profile. Warps take one task after another.
template <typename Element>
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    search_profile_kernel(const __grid_constant__ SweepPageOf<Element> job,
                          const ProfileBests bests, const ProfileList list,
                          unsigned long long* tallies) {
  using Task = ProfileTask<CudaWarp, Element>;
  __shared__ typename Task::Shared shared[kWarpsPerBlock];
  const auto count = static_cast<std::uint32_t>(Task::count(job.page.shape));
  CudaWarp::PerLane<SweepStatistics> statistics;
  Task task(job, bests, list, shared[threadIdx.x / kWarpLanes], statistics);
  for (;;) {
    const std::uint32_t index = CudaWarp::add(&list.counts->tasks, 1, count);
    if (index >= count) break;
    task.search(index);
  }
  tally(tallies, statistics[0]);
}

}  // namespace

unsigned resident_sweep_blocks(int device) {
  int processors = 0;
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device));
  return kBlocksPerProcessor * static_cast<unsigned>(processors);
}

template <typename Element>
void search_sweep(const SweepPageOf<Element>& page, unsigned long long* tallies,
                  unsigned resident_blocks, cudaStream_t stream) {
  const auto blocks = static_cast<unsigned>(divide_up(page.block_count(), kWarpsPerBlock));
  check_cuda(cudaMemsetAsync(page.work.counts, 0, sizeof(SweepWork::Counts), stream));
  if (page.clearances != nullptr) {
    search_blocks_kernel<true, Element><<<blocks, kThreads, 0, stream>>>(page, tallies);
    check_cuda(cudaGetLastError());
    return;
  }
  search_blocks_kernel<false, Element><<<blocks, kThreads, 0, stream>>>(page, tallies);
  check_cuda(cudaGetLastError());
  search_entries_kernel<Element><<<resident_blocks, kThreads, 0, stream>>>(page, tallies);
  check_cuda(cudaGetLastError());
  search_walks_kernel<Element><<<resident_blocks, kThreads, 0, stream>>>(page, tallies);
  check_cuda(cudaGetLastError());
  search_items_kernel<Element><<<resident_blocks, kThreads, 0, stream>>>(page, tallies);
  check_cuda(cudaGetLastError());
}

template <typename Element>
void search_profile(const SweepPageOf<Element>& page, const ProfileBests& bests,
                    const ProfileList& list, unsigned long long* tallies, unsigned resident_blocks,
                    cudaStream_t stream) {
  check_cuda(cudaMemsetAsync(list.counts, 0, sizeof(ProfileCounts), stream));
  search_profile_kernel<Element>
      <<<resident_blocks, kThreads, 0, stream>>>(page, bests, list, tallies);
  check_cuda(cudaGetLastError());
}

template void search_sweep(const SweepPageOf<Vec3>&, unsigned long long*, unsigned, cudaStream_t);
template void search_sweep(const SweepPageOf<Triangle>&, unsigned long long*, unsigned,
                           cudaStream_t);
template void search_sweep(const SweepPageOf<SolidTriangle>&, unsigned long long*, unsigned,
                           cudaStream_t);
template void search_profile(const SweepPageOf<Vec3>&, const ProfileBests&, const ProfileList&,
                             unsigned long long*, unsigned, cudaStream_t);
template void search_profile(const SweepPageOf<Triangle>&, const ProfileBests&, const ProfileList&,
                             unsigned long long*, unsigned, cudaStream_t);
template void search_profile(const SweepPageOf<SolidTriangle>&, const ProfileBests&,
                             const ProfileList&, unsigned long long*, unsigned, cudaStream_t);

void load_sweep_kernels() noexcept {
  cudaFuncAttributes unused;
  cudaFuncGetAttributes(&unused, search_blocks_kernel<false, Vec3>);
  cudaFuncGetAttributes(&unused, search_blocks_kernel<true, Vec3>);
  cudaFuncGetAttributes(&unused, search_entries_kernel<Vec3>);
  cudaFuncGetAttributes(&unused, search_walks_kernel<Vec3>);
  cudaFuncGetAttributes(&unused, search_items_kernel<Vec3>);
  cudaFuncGetAttributes(&unused, search_profile_kernel<Vec3>);
}

}  // namespace clearway
