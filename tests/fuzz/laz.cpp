// LAZ: any bytes as a file; or, behind a sound header, as its chunk table and chunks.
#include <string_view>

#include "io/scans/las/las_reader.hpp"
#include "read_points.hpp"
#include "support/bytes/laz/laz_bytes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Reads some points twice. Not all are read, because a byte may hold a thousand of them.
void read_some(const MemoryFile& input, bool with_times) {
  constexpr int kMostBatches = 4;
  const auto reader = read_las(InputBuffer(input.open(), InputBuffer::Access::kSeek), with_times);
  std::uint64_t counts[2] = {0, 0};
  for (std::uint64_t& count : counts) {
    PointBatch batch;
    for (int i = 0; i < kMostBatches && reader->read(batch); ++i) {
      if (batch.size() == 0 || batch.size() > PointReader::kBatchPoints) std::abort();
      const bool times = with_times && reader->info().gps_times != GpsTimes::kNone;
      if (batch.times.size() != (times ? batch.size() : 0)) std::abort();
      count += batch.size();
    }
    reader->rewind();
  }
  if (counts[0] != counts[1] || counts[0] > *reader->info().declared_points) std::abort();
}

/// The bytes before the points of a sound file. settings: format, flags, points (2 bytes), points
/// of a chunk.
std::string sound_head(std::string_view settings) {
  LazBytes laz;
  const auto number = [&](std::size_t at) { return static_cast<unsigned char>(settings[at]); };
  const unsigned format = number(0) % 7;
  laz.las.format = format < 4 ? format : format + 2;
  laz.las.minor = format < 4 ? 2 : 4;
  laz.las.extra_bytes = number(1) % 4;
  laz.variable = (number(1) & 4u) != 0;
  laz.chunked = (number(1) & 8u) == 0;
  laz.chunks = {number(4) * 50u + 1};
  std::string head = laz.head(number(2) + 256u * number(3));
  // Sets older versions of the items.
  if ((number(1) & 16u) != 0 && format < 4) {
    for (std::size_t at = head.size() - 2; at > laz.las.points_offset() + 54 + 34; at -= 6) {
      head[at] = 1;
    }
  }
  return head;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kSettings = 5;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  std::string file(bytes);
  if (!bytes.starts_with("LASF")) {
    if (size < kSettings) return 0;
    file = sound_head(bytes.substr(0, kSettings));
    file += bytes.substr(kSettings);
  }
  const MemoryFile input({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()});
  may_refuse([&] { read_some(input, false); });
  may_refuse([&] { read_some(input, true); });
  return 0;
}
