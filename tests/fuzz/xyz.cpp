// Any bytes, read as XYZ or PTS text.
#include "io/formats/text/xyz_reader.hpp"
#include "read_points.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  may_refuse([&] { read_twice(*read_xyz(InputBuffer(input.open(), InputBuffer::Access::kSeek))); });

  return 0;
}
