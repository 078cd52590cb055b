#include "gpu/devices.hpp"

#include "gpu/cuda_objects.hpp"
#include "gpu/grid_kernels.hpp"
#include "gpu/section_kernels.hpp"
#include "gpu/sweep_kernels.hpp"

namespace clearway {

namespace {

#ifdef CLEARWAY_QUICK_KERNELS
constexpr bool kKernelsMayRun = false;
#else
constexpr bool kKernelsMayRun = true;
#endif

}  // namespace

int cuda_device_count() {
  int count = 0;
  return kKernelsMayRun && cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

std::string why_no_cuda_device() {
  if (!kKernelsMayRun) {
    return "this program was built with CLEARWAY_QUICK_KERNELS=ON, whose kernels are not to be run";
  }
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) return cudaGetErrorString(status);
  return count > 0 ? "" : cudaGetErrorString(cudaErrorNoDevice);
}

std::string cuda_device_name(int index) {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, index));
  return properties.name;
}

CudaDevice open_cuda_device(int index) {
  try {
    check_cuda(cudaSetDevice(index));
    std::size_t free_bytes = 0, total_bytes = 0;
    check_cuda(cudaMemGetInfo(&free_bytes, &total_bytes));
    return {index, cuda_device_name(index), total_bytes, free_bytes};
  } catch (const ResourceError&) {
    // Clears the error, which a check after a launch on another device would find
    cudaGetLastError();
    throw;
  }
}

bool cuda_device_works(int index) noexcept {
  if (cudaSetDevice(index) != cudaSuccess) return false;
  const cudaError_t status = cudaStreamQuery(cudaStreamLegacy);
  cudaGetLastError();
  return status == cudaSuccess || status == cudaErrorNotReady;
}

void end_cuda_device(int index) noexcept {
  if (cudaSetDevice(index) == cudaSuccess) cudaDeviceReset();
}

void start_cuda_device(int index, CudaKernels kernels) noexcept {
  if (cudaSetDevice(index) == cudaSuccess && cudaFree(nullptr) == cudaSuccess) {
    switch (kernels) {
      case CudaKernels::kSweep:
        load_sweep_kernels();
        break;
      case CudaKernels::kGrid:
        load_grid_kernels();
        break;
      case CudaKernels::kSection:
        load_section_kernel();
        break;
    }
  }
  cudaGetLastError();
}

}  // namespace clearway
