#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "core/cloud/packed_cloud.hpp"

namespace clearway::test {

/// Random values, `count` >= 2 of them, whose greatest exceeds the least by exactly `span`.
template <typename Value>
std::vector<Value> values_of_span(std::size_t count, std::make_unsigned_t<Value> span,
                                  std::uint64_t seed) {
  using Unsigned = std::make_unsigned_t<Value>;
  std::mt19937_64 random(seed);
  const auto above = [&random](Unsigned most) {
    return static_cast<Unsigned>(
        std::uniform_int_distribution<std::uint64_t>(0, std::uint64_t{most})(random));
  };
  const auto room = static_cast<Unsigned>(std::numeric_limits<Unsigned>::max() - span);
  const auto least =
      static_cast<Unsigned>(static_cast<Unsigned>(std::numeric_limits<Value>::min()) + above(room));
  std::vector<Value> values(count);
  for (Value& value : values) value = static_cast<Value>(least + above(span));
  const std::size_t at = random() % count;
  values[at] = static_cast<Value>(least);
  values[(at + 1 + random() % (count - 1)) % count] = static_cast<Value>(least + span);
  return values;
}

/// A random span that needs exactly `bits` bits; where these are all bits of a value, HDF5 stores
/// it raw.
template <typename Value>
std::make_unsigned_t<Value> span_of_bits(unsigned bits, std::uint64_t seed) {
  using Unsigned = std::make_unsigned_t<Value>;
  if (bits == 0) return 0;
  const auto top = static_cast<Unsigned>(Unsigned{1} << (bits - 1));
  return static_cast<Unsigned>(top | (std::mt19937_64(seed)() & (top - 1)));
}

template <typename Value>
std::vector<std::byte> packed(const std::vector<Value>& values) {
  std::vector<std::byte> bytes;
  append_packed_chunk<Value>(values, bytes);
  return bytes;
}

}  // namespace clearway::test
