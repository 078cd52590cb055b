// Any bytes, read as E57. The checksums of pages would refuse nearly all of them, so the first byte
// says what is done before: 0 is nothing; for 1 the checksums are corrected; otherwise the bytes
// are the content, which is put into pages with right checksums and file size.
#include "io/scans/e57/e57_reader.hpp"
#include "read_points.hpp"
#include "support/bytes/e57_bytes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Small pages, so that a few hundred bytes reach across several.
constexpr std::size_t kPage = 128;

std::string file_of(std::uint8_t kind, std::string bytes) {
  if (kind == 0) return bytes;
  if (kind == 1) {
    E57Bytes::repair(bytes);
    return bytes;
  }
  if (bytes.size() >= E57Bytes::kHeaderBytes) E57Bytes::put<std::uint64_t>(bytes, 40, kPage);
  return E57Bytes::paged(bytes, kPage);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string file =
      file_of(data[0] % 4, std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  const MemoryFile input({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()});
  may_refuse([&] { read_twice(*read_e57(input.open())); });
  return 0;
}
