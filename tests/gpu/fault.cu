#include "fault.hpp"

namespace clearway {
namespace {

__global__ void write_nowhere_kernel() { *reinterpret_cast<volatile int*>(8) = 1; }

}  // namespace

void fault_on_device() {
  cudaSetDevice(0);
  write_nowhere_kernel<<<1, 1>>>();
}

}  // namespace clearway
