#include "bench/measure/machine.hpp"

#include <hdf5.h>
#include <tbb/info.h>
#include <tbb/version.h>
#include <unistd.h>

#include <Eigen/Core>
#include <fstream>
#include <string>

#include "bench/commit.hpp"
#ifdef CLEARWAY_CUDA
#include <cuda_runtime_api.h>

#include "gpu/devices.hpp"
#endif

namespace clearway::bench {
namespace {

/// The value of the first line "key<separator>value" of a file, quotes left out; empty where there
/// is none.
std::string value_in(const char* file, std::string_view key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    std::string value = line.substr(at + 1);
    std::erase(value, '"');
    return value.substr(std::min(value.find_first_not_of(" \t"), value.size()));
  }
  return {};
}

nlohmann::ordered_json gpus() {
  auto names = nlohmann::ordered_json::array();
#ifdef CLEARWAY_CUDA
  for (int i = 0; i < cuda_device_count(); ++i) names.push_back(cuda_device_name(i));
#endif
  return names;
}

}  // namespace

nlohmann::ordered_json machine_description() {
  return {{"processor", value_in("/proc/cpuinfo", "model name", ':')},
          {"cores", tbb::info::default_concurrency()},  // the cores that this process may use
          {"memory_bytes", static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                               static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE))},
          {"gpus", gpus()},
          {"system", value_in("/etc/os-release", "PRETTY_NAME", '=')}};
}

nlohmann::ordered_json program_description() {
  nlohmann::ordered_json libraries{
      {"hdf5", std::to_string(H5_VERS_MAJOR) + '.' + std::to_string(H5_VERS_MINOR) + '.' +
                   std::to_string(H5_VERS_RELEASE)},
      {"onetbb", TBB_VERSION_STRING},
      {"eigen", std::to_string(EIGEN_WORLD_VERSION) + '.' + std::to_string(EIGEN_MAJOR_VERSION) +
                    '.' + std::to_string(EIGEN_MINOR_VERSION)}};
#ifdef CLEARWAY_CUDA
  libraries["cuda"] =
      std::to_string(CUDART_VERSION / 1000) + '.' + std::to_string(CUDART_VERSION % 1000 / 10);
#endif
  return {{"version", CLEARWAY_VERSION},
          {"commit", kCommit},
          {"build", CLEARWAY_BUILD},
          {"compiler", __VERSION__},
          {"libraries", libraries}};
}

}  // namespace clearway::bench
