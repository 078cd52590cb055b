#include "gpu/cuda_objects.hpp"
#include "gpu/device_arrays.hpp"
#include "predicate_check.hpp"

namespace clearway {
namespace {

__global__ void decide_cases_kernel(const PredicateCase* cases, PredicateAnswer* answers,
                                    std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) answers[i] = decide(cases[i]);
}

}  // namespace

std::vector<PredicateAnswer> decide_on_device(const std::vector<PredicateCase>& cases) {
  constexpr unsigned kThreads = 256;
  std::vector<PredicateAnswer> answers(cases.size());
  if (cases.empty()) return answers;
  DeviceArrays arrays;
  const PredicateCase* in = arrays.copy(cases.data(), cases.size());
  auto* out = arrays.zeros<PredicateAnswer>(cases.size());
  const auto blocks = static_cast<unsigned>((cases.size() + kThreads - 1) / kThreads);
  decide_cases_kernel<<<blocks, kThreads>>>(in, out, cases.size());
  check_cuda(cudaGetLastError());
  check_cuda(cudaMemcpy(answers.data(), out, answers.size() * sizeof(PredicateAnswer),
                        cudaMemcpyDeviceToHost));
  return answers;
}

}  // namespace clearway
