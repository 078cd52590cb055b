#include "clearway/memory_use.hpp"

#include <algorithm>
#include <fstream>
#include <string>

namespace clearway::tool {

std::uint64_t peak_anonymous_bytes() {
  static std::uint64_t peak = 0;
  std::ifstream status("/proc/self/status");
  std::string key;
  while (status >> key) {
    if (key == "RssAnon:") {
      std::uint64_t kibibytes = 0;
      status >> kibibytes;
      peak = std::max(peak, kibibytes * 1024);
      break;
    }
  }
  return peak;
}

}  // namespace clearway::tool
