// Any bytes, read as PTX or PTS text, as a scan of 3DTK, or as a file with its pose: the first byte
// chooses.
#include "io/scans/ptx/ptx_reader.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"
#include "io/scans/threedtk/threedtk_reader.hpp"
#include "read_points.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void read_and_tell(PointReader& reader) {
  read_twice(reader);
  tell_lines(reader);
}

void read_as(unsigned what, InputBuffer input) {
  static const ScratchFolder empty;  // a folder in which a scan is alone, so that it needs no pose
  switch (what) {
    case 0:
      return read_and_tell(*read_ptx(std::move(input)));
    case 1:
      return read_and_tell(*read_scan_text(std::move(input), true));
    case 2:
      return read_and_tell(*read_scan_text(std::move(input), false));
    case 3:
      return read_and_tell(*read_threedtk(std::move(input), empty.folder() / "scan000.3d"));
    case 4:
      read_threedtk_pose(input);
      return;
    default:
      read_threedtk_frames(input);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] { read_as(data[0] % 6, InputBuffer(input.open(), InputBuffer::Access::kSeek)); });
  return 0;
}
