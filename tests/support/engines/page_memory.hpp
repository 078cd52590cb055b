#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/run_pages.hpp"

namespace clearway::test {

/// Memory with the alignment of pages.
class PageMemory {
 public:
  explicit PageMemory(std::uint64_t bytes) : lines_(divide_up(bytes, kPageAlignment)) {}
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(lines_)); }

 private:
  struct alignas(kPageAlignment) Line {
    std::array<std::byte, kPageAlignment> bytes;
  };
  std::vector<Line> lines_;
};

}  // namespace clearway::test
