#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace clearway::tool {

/// Watches the resident memory of this process, without mapped files, every few milliseconds from a
/// thread of its own as long as the object lives. Source: /proc/self/statm.
class MemoryWatch {
 public:
  MemoryWatch();
  ~MemoryWatch();
  MemoryWatch(const MemoryWatch&) = delete;
  MemoryWatch& operator=(const MemoryWatch&) = delete;

  /// The largest resident memory that was seen so far, bytes; 0 where the system does not tell.
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
