// Any bytes, read as XYZ or PTS text, with the columns that they name and with columns that the
// caller chose.
#include "io/scans/text/xyz_reader.hpp"
#include "read_points.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  const PointReadOptions ways[] = {
      {}, {{"2", "3", "4"}, true}, {{"x", "z", "y"}, true}, {{"e", "2", "h"}, false}};
  for (const PointReadOptions& options : ways) {
    may_refuse([&] {
      const auto reader = read_xyz(InputBuffer(input.open(), InputBuffer::Access::kSeek), options);
      read_twice(*reader);
      tell_lines(*reader);
    });
  }
  return 0;
}
