#include "clearway/memory_use.hpp"

#include <unistd.h>

#include <chrono>
#include <fstream>

namespace clearway::tool {

std::uint64_t anonymous_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total = 0, resident = 0, shared = 0;
  if (!(statm >> total >> resident >> shared) || resident < shared) return 0;
  return (resident - shared) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

MemoryWatch::MemoryWatch()
    : thread_([this] {
        while (!stopped_) {
          look();
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      }) {}

MemoryWatch::~MemoryWatch() {
  stopped_ = true;
  thread_.join();
}

std::uint64_t MemoryWatch::peak_bytes() {
  look();
  return peak_;
}

void MemoryWatch::look() {
  const std::uint64_t now = anonymous_bytes();
  std::uint64_t peak = peak_;
  while (now > peak && !peak_.compare_exchange_weak(peak, now)) {
  }
}

}  // namespace clearway::tool
