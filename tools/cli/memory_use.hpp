#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace clearway::tool {

/// Watches the resident memory of this process without mapped files from a thread of its own, every
/// few milliseconds, as long as it lives. Source: /proc/self/statm.
class MemoryWatch {
 public:
  MemoryWatch();
  ~MemoryWatch();
  MemoryWatch(const MemoryWatch&) = delete;
  MemoryWatch& operator=(const MemoryWatch&) = delete;

  /// The most that was seen, now included, bytes; 0 where the system does not tell.
  std::uint64_t peak_bytes();

 private:
  std::uint64_t anonymous_bytes() const;
  void look();

  int statm_;
  std::uint64_t page_bytes_;
  std::atomic<std::uint64_t> peak_{0};
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace clearway::tool
