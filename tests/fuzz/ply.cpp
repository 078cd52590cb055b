// Any bytes, read as PLY.
#include "io/scans/ply/ply_reader.hpp"
#include "read_points.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  may_refuse([&] {
    const auto reader = read_ply(InputBuffer(input.open(), InputBuffer::Access::kSeek));
    read_twice(*reader);
    tell_lines(*reader);
  });
  return 0;
}
