#include "io/formats/e57/e57_section.hpp"

#include <array>

#include "io/formats/byte_load.hpp"
#include "io/formats/e57/e57_header.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::size_t kSectionHeaderBytes = 32;

/// Throws InputError where the packets are too small to hold the bits of every record.
void check_room(const E57Pages& pages, const E57Scan& scan, const E57Extent& extent) {
  const std::uint64_t room = extent.packet_bytes();
  std::uint64_t needed = 0;
  for (const E57Field& field : scan.fields) {
    needed += field.bytes_of(scan.records);
    if (needed > room) break;
  }
  if (needed > room) {
    refuse_byte(pages.name(), pages.physical(extent.start),
                scan.name() + " has packets of " + std::to_string(room) +
                    " bytes; expected more for its " + std::to_string(scan.records) + " records");
  }
}

std::uint64_t start_of_section(const E57Pages& pages, const E57Scan& scan) {
  const auto start = pages.logical(scan.file_offset);
  if (start && *start >= kE57HeaderBytes) return *start;
  refuse(pages.name(), scan.name() + " has its points at byte " + std::to_string(scan.file_offset) +
                           "; expected a place behind the header, within the file and in no "
                           "checksum");
}

}  // namespace

E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan) {
  if (scan.records == 0 && scan.file_offset == 0) return {};
  E57Extent extent;
  extent.start = start_of_section(pages, scan);
  std::array<std::byte, kSectionHeaderBytes> header;
  pages.read(extent.start, header, "the header of a scan's points");
  const auto id = load<std::uint8_t>(header.data());
  if (id != 1) {
    refuse_byte(pages.name(), scan.file_offset,
                scan.name() + " has a binary section of kind " + std::to_string(id) +
                    "; expected 1, compressed vectors");
  }
  const auto length = load<std::uint64_t>(header.data() + 8);
  if (length < kSectionHeaderBytes || length > pages.size() - extent.start || length % 4 != 0) {
    refuse_byte(pages.name(), scan.file_offset,
                scan.name() + " has a binary section of " + std::to_string(length) +
                    " bytes; expected a multiple of 4 that ends before the file");
  }
  extent.end = extent.start + length;
  const auto offset = load<std::uint64_t>(header.data() + 16);
  const auto packets = pages.logical(offset);
  if (length == kSectionHeaderBytes) {
    extent.packets = extent.end;  // there are no packets to point to
  } else if (!packets || *packets < extent.start + kSectionHeaderBytes || *packets >= extent.end) {
    refuse_byte(pages.name(), scan.file_offset,
                scan.name() + " has its first packet at byte " + std::to_string(offset) +
                    "; expected a place within its section");
  } else {
    extent.packets = *packets;
  }
  check_room(pages, scan, extent);
  return extent;
}

}  // namespace clearway
