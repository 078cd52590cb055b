#include "gpu/cuda_objects.hpp"
#include "gpu/section_kernels.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kWarpsPerBlock = 4;
constexpr unsigned kThreads = kWarpsPerBlock * kWarpLanes;
/// Number of thread blocks that run on a processor at a time; registers are limited so that they
/// do, because warps wait for the maps most of the time.
constexpr unsigned kBlocksPerProcessor = 8;

/// Searches the blocks of the page's cells, one by each warp.
__global__ void __launch_bounds__(kThreads, kBlocksPerProcessor)
    block_cells_kernel(const __grid_constant__ SectionPage page) {
  const std::uint32_t block = blockIdx.x * kWarpsPerBlock + threadIdx.x / kWarpLanes;
  if (block < page.block_count()) SectionBlock<CudaWarp>(page, block).search();
}

}  // namespace

void block_cells(const SectionPage& page, cudaStream_t stream) {
  const auto blocks = static_cast<unsigned>(divide_up(page.block_count(), kWarpsPerBlock));
  if (blocks == 0) return;
  block_cells_kernel<<<blocks, kThreads, 0, stream>>>(page);
  check_cuda(cudaGetLastError());
}

void load_section_kernel() noexcept {
  cudaFuncAttributes unused;
  cudaFuncGetAttributes(&unused, block_cells_kernel);
}

}  // namespace clearway
