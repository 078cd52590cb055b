#include "io/files/stored_chunk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "io/files/fletcher32.hpp"

namespace clearway::hdf5 {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMostBytes = 1 << 18;
constexpr std::uint64_t kMostRows = 1 << 16;

}  // namespace

std::uint64_t rows_of_chunk(std::uint64_t rows, std::uint64_t row_bytes) {
  const std::uint64_t most = std::bit_floor(std::max<std::uint64_t>(1, kMostBytes / row_bytes));
  return std::min({rows, most, kMostRows});
}

void seal_chunk(std::span<std::byte> chunk) {
  const std::size_t at = chunk.size() - kChecksumBytes;
  const std::uint32_t sum = fletcher32(chunk.first(at));
  std::memcpy(chunk.data() + at, &sum, kChecksumBytes);
}

bool is_sealed(std::span<const std::byte> chunk) {
  if (chunk.size() < kChecksumBytes) return false;
  const std::size_t at = chunk.size() - kChecksumBytes;
  const std::uint32_t sum = fletcher32(chunk.first(at));
  return std::memcmp(chunk.data() + at, &sum, kChecksumBytes) == 0;
}

}  // namespace clearway::hdf5
