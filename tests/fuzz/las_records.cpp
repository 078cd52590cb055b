// Any bytes as LAS, whose records are copied as export --scans does.
#include <cstdlib>

#include "io/result/export/export_scan_records.hpp"
#include "io/scans/las/las_header.hpp"
#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Checks that the described extra bytes fill what the record has beyond its format.
void check(const LasRecordFormat& format) {
  if (format.extra_bytes.size() % kLasExtraBytes != 0) std::abort();
}

void copy_records(LasRecordReader& reader) {
  const std::uint64_t points = reader.header().points;
  check(reader.format());
  if (points == 0) return;
  for (const std::uint64_t point : {std::uint64_t{0}, points / 2, points - 1, points / 3}) {
    const auto record = reader.record(point);
    if (record.size() != reader.header().record_bytes) std::abort();
    unsigned sum = 0;
    for (const std::byte byte : record) sum += std::to_integer<unsigned>(byte);
    if (sum > 255 * record.size()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  may_refuse([&] {
    LasRecordReader reader(input.path());
    if (!reader.header().compressed) copy_records(reader);
  });
  return 0;
}
