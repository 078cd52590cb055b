// Any bytes as a packed chunk: either it is refused, or every way to decode it gives the same
// values. The first two bytes are the number of values.
#include <cstdlib>
#include <memory>

#include "core/cloud/packed_cloud.hpp"
#include "one_cell_cloud.hpp"
#include "staged_values.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

template <typename Value>
std::vector<Value> check_decoding(std::span<const std::byte> bytes, std::uint32_t count) {
  const PackedChunk<Value> chunk(bytes, count);
  const auto again =
      PackedChunk<Value>::of_payload(chunk.payload(), count, chunk.minbits(), chunk.minimum());
  std::vector<Value> values(count), from_third(count);
  chunk.decode(0, values);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (chunk[i] != values[i] || again[i] != values[i]) std::abort();
  }
  if (count > 3) {
    chunk.decode(3, std::span(from_third).subspan(3));
    for (std::uint32_t i = 3; i < count; ++i) {
      if (from_third[i] != values[i]) std::abort();
    }
  }
  return values;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::uint32_t count = 1 + data[0] + 256u * (data[1] % 8);
  // The bytes lie in a block of exactly their size, so that a read past its end is seen.
  const std::size_t chunk_bytes = size - 2;
  const auto copy = std::make_unique<std::byte[]>(chunk_bytes);
  std::copy_n(reinterpret_cast<const std::byte*>(data) + 2, chunk_bytes, copy.get());
  const std::span<const std::byte> bytes(copy.get(), chunk_bytes);
  may_refuse([&] { check_decoding<std::uint64_t>(bytes, count); });
  may_refuse([&] {
    const auto values = check_decoding<std::int32_t>(bytes, count);
    const OneCellCloud cloud(bytes, count);
    check_staged_cell(cloud, 0, {values, values, values});
  });
  return 0;
}
