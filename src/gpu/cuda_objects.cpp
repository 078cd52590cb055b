#include "gpu/cuda_objects.hpp"

namespace clearway {
namespace {

/// Whether CUDA says of an error that the process cannot use the device after it. No reset helps.
bool ends_use_of_device(cudaError_t status) {
  switch (status) {
    case cudaErrorECCUncorrectable:
    case cudaErrorIllegalAddress:
    case cudaErrorLaunchTimeout:
    case cudaErrorAssert:
    case cudaErrorHardwareStackError:
    case cudaErrorIllegalInstruction:
    case cudaErrorMisalignedAddress:
    case cudaErrorInvalidAddressSpace:
    case cudaErrorInvalidPc:
    case cudaErrorLaunchFailure:
      return true;
    default:
      return false;
  }
}

Remedy remedy_for(cudaError_t status) {
  if (status == cudaErrorMemoryAllocation) return Remedy::kLessDeviceMemory;
  return ends_use_of_device(status) ? Remedy::kNewProcess : Remedy::kCpuDevice;
}

}  // namespace

void throw_cuda_error(cudaError_t status, std::source_location where) {
  std::string what = std::string("CUDA failed at ") + where.file_name() + ":" +
                     std::to_string(where.line()) + ": " + cudaGetErrorString(status);
  if (ends_use_of_device(status)) {
    what += ", after which this process can use the GPU no more, although others can";
  }
  throw ResourceError(what, remedy_for(status));
}

}  // namespace clearway
