#include <unistd.h>

#include <utility>

#include "clearway/error.hpp"
#include "io/formats/byte_load.hpp"
#include "io/formats/las/las_reader.hpp"

namespace clearway {
namespace {

/// Whether the stream begins as a LAZ file does.
bool is_compressed(InputBuffer& stream) {
  constexpr std::size_t kFormatByte = 104;
  const auto head = stream.peek(kFormatByte + 1);
  return head.size() > kFormatByte && std::memcmp(head.data(), "LASF", 4) == 0 &&
         load<std::uint8_t>(head.data() + kFormatByte) >= 0x40;
}

/// Copies all bytes of the stream into a file without a name.
InputBuffer spool_bytes(InputBuffer stream, const std::filesystem::path& folder) {
  const File spooled = File::create_temporary(folder);
  for (auto bytes = stream.take_some(); !bytes.empty(); bytes = stream.take_some()) {
    spooled.write(bytes);
  }
  const int descriptor = ::dup(spooled.descriptor());
  if (descriptor < 0) throw ResourceError(stream.name() + ": cannot be spooled: no descriptor");
  return {File::adopt(descriptor, stream.name()), InputBuffer::Access::kSeek};
}

}  // namespace

std::unique_ptr<PointReader> open_las_stream(File stream,
                                             const std::filesystem::path& temporary_folder) {
  InputBuffer input(std::move(stream), InputBuffer::Access::kStream);
  if (is_compressed(input)) return read_las(spool_bytes(std::move(input), temporary_folder));
  return read_las(std::move(input));
}

}  // namespace clearway
