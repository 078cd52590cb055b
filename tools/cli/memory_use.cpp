#include "cli/memory_use.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace clearway::tool {

std::uint64_t MemoryWatch::anonymous_bytes() const {
  char text[128] = {};
  if (::pread(statm_, text, sizeof text - 1, 0) <= 0) return 0;
  unsigned long long total = 0, resident = 0, shared = 0;
  if (std::sscanf(text, "%llu %llu %llu", &total, &resident, &shared) != 3) return 0;
  return resident < shared ? 0 : (resident - shared) * page_bytes_;
}

MemoryWatch::MemoryWatch()
    : statm_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)),
      page_bytes_(static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE))),
      thread_([this] {
        while (!stopped_) {
          look();
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      }) {}

MemoryWatch::~MemoryWatch() {
  stopped_ = true;
  thread_.join();
  if (statm_ >= 0) ::close(statm_);
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
