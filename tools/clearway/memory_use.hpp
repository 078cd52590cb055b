#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace clearway::tool {

/// Resident memory of this process without mapped files, bytes; 0 where the system does not tell.
/// Source: /proc/self/statm.
std::uint64_t anonymous_bytes();

/// Watches anonymous_bytes() from a thread of its own, every few milliseconds, as long as it lives.
class MemoryWatch {
 public:
  MemoryWatch();
  ~MemoryWatch();
  MemoryWatch(const MemoryWatch&) = delete;
  MemoryWatch& operator=(const MemoryWatch&) = delete;

  /// The most that was seen, now included.
  std::uint64_t peak_bytes();

 private:
  void look();

  std::atomic<std::uint64_t> peak_{0};
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace clearway::tool
