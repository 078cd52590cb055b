// Any bytes, read as LAS: from a file and from a pipe.
#include "io/scans/las/las_reader.hpp"
#include "read_points.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kFormatByte = 104;
  if (size > kFormatByte && data[kFormatByte] >= 0x40) return 0;  // LAZ, which laz.cpp reads
  const MemoryFile input({data, size});
  may_refuse([&] { read_twice(*read_las(InputBuffer(input.open(), InputBuffer::Access::kSeek))); });
  may_refuse([&] {
    const auto reader =
        open_las_stream(input.open(), std::filesystem::temp_directory_path(), {.with_times = true});
    for (PointBatch batch; reader->read(batch);) {
      const bool times = reader->info().gps_times != GpsTimes::kNone;
      if (batch.times.size() != (times ? batch.size() : 0)) std::abort();
    }
  });
  return 0;
}
