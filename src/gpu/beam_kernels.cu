#include "core/util/warp.hpp"
#include "gpu/beam_kernels.hpp"
#include "gpu/cuda_objects.hpp"

namespace clearway {
namespace {

constexpr unsigned kThreads = 128;

__device__ void tally(unsigned long long* total, std::uint64_t of_thread) {
  const std::uint32_t sum = sum_of_lanes(static_cast<std::uint32_t>(of_thread));
  if (threadIdx.x % 32 == 0 && sum != 0) atomicAdd(total, static_cast<unsigned long long>(sum));
}

/// Follows the beam to one point with each thread; blockIdx.y is the cell.
__global__ void __launch_bounds__(kThreads)
    follow_beams_kernel(const __grid_constant__ BeamsRef beams,
                        const __grid_constant__ BeamPage page, unsigned long long* counts) {
  BeamCounts found;
  page.follow(beams, blockIdx.y, blockIdx.x * kThreads + threadIdx.x, found);
  __syncwarp();
  tally(counts, found.without_origin);
  tally(counts + 1, found.too_long);
}

}  // namespace

void follow_beams(const BeamsRef& beams, const BeamPage& page, unsigned long long* counts,
                  cudaStream_t stream) {
  const PageShape& shape = page.page.shape;
  if (shape.cells == 0) return;
  const auto points = std::uint64_t{shape.blocks_per_cell} * kBlockPoints;
  const dim3 blocks(static_cast<unsigned>(divide_up(points, kThreads)), shape.cells);
  follow_beams_kernel<<<blocks, kThreads, 0, stream>>>(beams, page, counts);
  check_cuda(cudaGetLastError());
}

}  // namespace clearway
