#include <bit>
#include <cub/device/device_radix_sort.cuh>

#include "core/grid/grid_search.hpp"
#include "gpu/cuda_objects.hpp"
#include "gpu/grid_kernels.hpp"

namespace clearway {
namespace {

constexpr unsigned kThreads = 256;
constexpr unsigned kLanes = 32;

/// Threads of a thread block of the search: one for each part of its task.
constexpr unsigned kSearchThreads = kTaskParts;

/// Number of pairs of group and pose that are tested before the open ones are searched.
constexpr std::uint32_t kWorkList = 2048;

static_assert(kGroupPoints == kLanes);

__global__ void make_keys_kernel(const __grid_constant__ GridSceneView scene,
                                 const __grid_constant__ GridPageView page, std::uint32_t* keys,
                                 std::uint32_t* order, std::uint32_t count) {
  const std::uint32_t slot = blockIdx.x * kThreads + threadIdx.x;
  if (slot >= count) return;
  keys[slot] = sort_key(scene, page, slot);
  order[slot] = slot;
}

__global__ void place_points_kernel(const __grid_constant__ GridSceneView scene,
                                    const __grid_constant__ GridPageView page,
                                    const std::uint32_t* keys, const std::uint32_t* order,
                                    std::uint32_t count) {
  const std::uint32_t at = blockIdx.x * kThreads + threadIdx.x;
  if (at < count) place_point(scene, page, keys, order, at, count);
}

/// Adds the counts of a warp's lanes to a total.
__device__ void add_up(std::uint64_t& total, std::uint64_t of_lane) {
  unsigned long long sum = of_lane;
  for (unsigned step = kLanes / 2; step > 0; step /= 2) {
    sum += __shfl_down_sync(0xffffffff, sum, step);
  }
  if (threadIdx.x % kLanes == 0 && sum != 0) {
    atomicAdd(reinterpret_cast<unsigned long long*>(&total), sum);
  }
}

__device__ void add_up(GridStatistics& total, const GridStatistics& of_lane) {
  add_up(total.sphere_tests, of_lane.sphere_tests);
  add_up(total.points_moved, of_lane.points_moved);
  add_up(total.searches, of_lane.searches);
  add_up(total.bucket_tests, of_lane.bucket_tests);
  add_up(total.point_tests, of_lane.point_tests);
  add_up(total.exact_tests, of_lane.exact_tests);
}

struct SharedLists {
  unsigned long long task;
  std::uint32_t open_count, work_count;
  std::uint32_t open[kTaskParts];  ///< open parts
  std::uint32_t work[kWorkList];   ///< open pairs of group and pose
};

/// Lists the parts of the task that may touch its cell. To be called by all threads of the block.
__device__ void open_parts(const GridSceneView& scene, const GridPageView& page,
                           const GridTask& task, SharedLists& lists, GridStatistics& statistics) {
  const std::uint32_t part = task.first_part + threadIdx.x;
  if (part < scene.part_count) {
    ++statistics.sphere_tests;
    if (part_is_open(scene, page, task, part)) lists.open[atomicAdd(&lists.open_count, 1)] = part;
  }
  __syncthreads();
}

/// Tests the pairs of the open parts, as many at a time as the work list holds, and searches those
/// that stay open, each by one warp. To be called by all threads of the block.
__device__ void search_parts(const GridSceneView& scene, const GridPageView& page,
                             const GridTask& task, SharedLists& lists, GridStatistics& statistics) {
  const std::uint32_t per_part = kPartGroups * scene.nodes[task.node].count;
  const std::uint32_t pairs = lists.open_count * per_part;
  for (std::uint32_t begin = 0; begin < pairs; begin += kWorkList) {
    const std::uint32_t end = min(pairs, begin + kWorkList);
    for (std::uint32_t i = begin + threadIdx.x; i < end; i += kSearchThreads) {
      std::uint32_t pair = 0;
      if (open_pair(scene, page, task, lists.open[i / per_part], i % per_part, pair, statistics)) {
        lists.work[atomicAdd(&lists.work_count, 1)] = pair;
      }
    }
    __syncthreads();
    const std::uint32_t work = lists.work_count;
    for (std::uint32_t i = threadIdx.x / kLanes; i < work; i += kSearchThreads / kLanes) {
      search_lane(scene, page, task, lists.work[i], threadIdx.x % kLanes, statistics);
    }
    __syncthreads();
    if (threadIdx.x == 0) lists.work_count = 0;
    __syncthreads();
  }
}

/// Searches all tasks: each thread block takes one after another until none is left.
__global__ void __launch_bounds__(kSearchThreads)
    search_kernel(const __grid_constant__ GridSceneView scene,
                  const __grid_constant__ GridPageView page, std::uint64_t tasks,
                  std::uint64_t* next_task, GridStatistics* total) {
  __shared__ SharedLists lists;
  GridStatistics statistics;
  for (;;) {
    if (threadIdx.x == 0) {
      lists.task = atomicAdd(reinterpret_cast<unsigned long long*>(next_task), 1ULL);
      lists.open_count = lists.work_count = 0;
    }
    __syncthreads();
    if (lists.task >= tasks) break;
    const GridTask task = task_of(scene, page, lists.task);
    open_parts(scene, page, task, lists, statistics);
    search_parts(scene, page, task, lists, statistics);
    __syncthreads();
  }
  __syncwarp();
  add_up(*total, statistics);
}

/// Number of thread blocks of the search that a device runs at once.
unsigned resident_blocks() {
  int device = 0, processors = 0, blocks = 0;
  check_cuda(cudaGetDevice(&device));
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device));
  check_cuda(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, search_kernel, kSearchThreads, 0));
  return static_cast<unsigned>(processors * blocks);
}

std::uint32_t entry_count(const GridSceneView& scene, const GridPageView& page) {
  return page.page.shape.cells * scene.slots;
}

}  // namespace

std::size_t grid_sort_bytes(std::uint32_t count) {
  std::size_t bytes = 0;
  const std::uint32_t* in = nullptr;
  std::uint32_t* out = nullptr;
  check_cuda(cub::DeviceRadixSort::SortPairs(nullptr, bytes, in, out, in, out, count));
  return bytes;
}

void build_grids(const GridSceneView& scene, const GridPageView& page, const GridSortRef& sort,
                 cudaStream_t stream) {
  const std::uint32_t count = entry_count(scene, page);
  const std::size_t cells = page.page.shape.cells;
  if (count == 0) return;
  const auto clear = [&](void* data, std::size_t bytes) {
    check_cuda(cudaMemsetAsync(data, 0, bytes, stream));
  };
  clear(page.buckets, cells * scene.bucket_count * sizeof(BucketRange));
  clear(page.occupancy, cells * scene.word_count * sizeof(std::uint64_t));
  clear(page.group_occupancy, cells * scene.word_count * sizeof(std::uint64_t));
  const auto blocks = static_cast<unsigned>(divide_up(count, kThreads));
  make_keys_kernel<<<blocks, kThreads, 0, stream>>>(scene, page, sort.keys, sort.order, count);
  check_cuda(cudaGetLastError());
  // Keys go up to cells * bucket_count, which is the key of slots without a point.
  const int bits = std::bit_width(page.page.shape.cells * scene.bucket_count);
  std::size_t scratch_bytes = sort.scratch_bytes;
  check_cuda(cub::DeviceRadixSort::SortPairs(sort.scratch, scratch_bytes, sort.keys,
                                             sort.sorted_keys, sort.order, sort.sorted_order, count,
                                             0, bits, stream));
  place_points_kernel<<<blocks, kThreads, 0, stream>>>(scene, page, sort.sorted_keys,
                                                       sort.sorted_order, count);
  check_cuda(cudaGetLastError());
}

void search_grids(const GridSceneView& scene, const GridPageView& page, std::uint64_t tasks,
                  std::uint64_t* next_task, GridStatistics* statistics, cudaStream_t stream) {
  const std::size_t count = entry_count(scene, page);
  check_cuda(cudaMemsetAsync(page.hits, 0, count / 8, stream));
  check_cuda(cudaMemsetAsync(page.done, 0, count / 8, stream));
  if (tasks == 0) return;
  check_cuda(cudaMemsetAsync(next_task, 0, sizeof(*next_task), stream));
  const auto blocks = static_cast<unsigned>(std::min<std::uint64_t>(tasks, resident_blocks()));
  search_kernel<<<blocks, kSearchThreads, 0, stream>>>(scene, page, tasks, next_task, statistics);
  check_cuda(cudaGetLastError());
}

void load_grid_kernels() noexcept {
  cudaFuncAttributes unused;
  cudaFuncGetAttributes(&unused, make_keys_kernel);
  cudaFuncGetAttributes(&unused, place_points_kernel);
  cudaFuncGetAttributes(&unused, search_kernel);
}

}  // namespace clearway
