#include "io/files/fletcher32.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace clearway {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kModulus = 65535;

constexpr std::size_t kLanes = 16;

/// Number of rows of kLanes words that are summed together; 361 is the most for which the lanes' 32
/// bits suffice.
constexpr std::size_t kRowsOfBlock = 256;

/// The two sums of a Fletcher checksum, modulo 65535.
struct Sums {
  std::uint64_t first = 0, second = 0;
};

/// Adds rows of kLanes words to the sums. In each lane, `plain` sums its words, and `weighted`
/// counts each word as often as rows follow it.
void add_rows(Sums& sums, const std::byte* bytes, std::size_t rows) {
  std::array<std::uint32_t, kLanes> plain{}, weighted{};
  for (std::size_t row = 0; row < rows; ++row) {
    std::array<std::uint16_t, kLanes> words;
    std::memcpy(words.data(), bytes + row * sizeof(words), sizeof(words));
    for (std::size_t l = 0; l < kLanes; ++l) {
      weighted[l] += plain[l];
      plain[l] += words[l];
    }
  }
  sums.second += kLanes * rows * sums.first;
  for (std::size_t l = 0; l < kLanes; ++l) {
    sums.second += kLanes * std::uint64_t{weighted[l]} + (kLanes - l) * std::uint64_t{plain[l]};
    sums.first += plain[l];
  }
  sums.first %= kModulus;
  sums.second %= kModulus;
}

/// A sum in the form of the filter, which never folds a sum above 0 to 0.
std::uint32_t folded(std::uint64_t sum, bool all_zero) {
  // Swapping the bytes of a word multiplies it by 256 modulo 65535; the filter's words are
  // big-endian.
  const auto rest = static_cast<std::uint32_t>(256 * sum % kModulus);
  return rest == 0 && !all_zero ? static_cast<std::uint32_t>(kModulus) : rest;
}

bool is_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace

std::uint32_t fletcher32(std::span<const std::byte> bytes) {
  constexpr std::size_t kRowBytes = 2 * kLanes;
  Sums sums;
  const std::size_t rows = bytes.size() / kRowBytes;
  for (std::size_t row = 0; row < rows; row += kRowsOfBlock) {
    add_rows(sums, bytes.data() + row * kRowBytes, std::min(kRowsOfBlock, rows - row));
  }
  for (std::size_t at = rows * kRowBytes; at + 2 <= bytes.size(); at += 2) {
    std::uint16_t word;
    std::memcpy(&word, bytes.data() + at, 2);
    sums.first += word;
    sums.second += sums.first;
  }
  if (bytes.size() % 2 == 1) {  // the filter takes a last single byte as if a zero followed it
    sums.first += std::to_integer<std::uint64_t>(bytes.back());
    sums.second += sums.first;
  }
  sums.first %= kModulus;
  sums.second %= kModulus;
  const bool may_be_zero = sums.first == 0 && sums.second == 0;
  const bool all_zero = may_be_zero && is_zero(bytes);
  return folded(sums.second, all_zero) << 16 | folded(sums.first, all_zero);
}

void seal_fletcher32(std::span<std::byte> chunk) {
  const auto values = chunk.first(chunk.size() - sizeof(std::uint32_t));
  const std::uint32_t checksum = fletcher32(values);
  std::memcpy(values.data() + values.size(), &checksum, sizeof checksum);
}

}  // namespace clearway
