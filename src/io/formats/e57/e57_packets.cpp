#include "io/formats/e57/e57_packets.hpp"

#include <array>

#include "io/formats/byte_load.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr std::size_t kDataHeaderBytes = 6;

}  // namespace

struct E57Packets::PacketHeader {
  std::uint8_t kind;
  std::uint8_t flags;
  std::size_t bytes;
};

E57Packets::E57Packets(E57Pages& pages, const E57Scan& scan, const E57Extent& extent)
    : pages_(pages),
      scan_(scan),
      extent_(extent),
      totals_(scan.fields.size(), 0),
      counted_(extent.packets) {
  bytes_.reserve(kMostBytes);
}

E57Packets::PacketHeader E57Packets::read_header(std::uint64_t position) {
  std::array<std::byte, 4> bytes;
  const std::uint64_t room = extent_.end - position;
  if (room >= bytes.size()) {
    pages_.read(position, bytes, "a packet's header");
    const PacketHeader header{load<std::uint8_t>(bytes.data()), load<std::uint8_t>(&bytes[1]),
                              std::size_t{load<std::uint16_t>(&bytes[2])} + 1};
    if (header.bytes <= room && header.bytes >= bytes.size() && header.bytes % 4 == 0) {
      return header;
    }
  }
  refuse_byte(pages_.name(), pages_.physical(position),
              "a packet of " + scan_.name() +
                  " has a wrong length; expected a multiple of 4 that ends before its section");
}

bool E57Packets::go_to(std::uint64_t position) {
  enum : std::uint8_t { kIndex, kData, kIgnored };
  if (next_ != 0 && position == start_) return true;
  while (position < extent_.end) {
    const PacketHeader header = read_header(position);
    if (header.kind == kData) {
      if (next_ == 0 || position != start_) read_data(position, header);
      return true;
    }
    if (header.kind != kIndex && header.kind != kIgnored) {
      refuse_byte(pages_.name(), pages_.physical(position),
                  "a packet of " + scan_.name() + " has kind " + std::to_string(header.kind) +
                      "; expected 0, 1 or 2");
    }
    position += header.bytes;
  }
  return false;
}

void E57Packets::read_data(std::uint64_t position, const PacketHeader& header) {
  next_ = 0;
  bytes_.resize(header.bytes);
  pages_.read(position, bytes_, "a data packet");
  start_ = position;
  restarts_ = (header.flags & 1) != 0;
  streams_ = header.bytes < kDataHeaderBytes ? 0 : load<std::uint16_t>(&bytes_[4]);
  check_lengths();
  next_ = position + header.bytes;
  if (position < counted_) return;
  for (std::size_t i = 0; i < streams_; ++i) totals_[i] += stream_bytes(i);
  counted_ = next_;
}

std::size_t E57Packets::stream_bytes(std::size_t index) const {
  return load<std::uint16_t>(bytes_.data() + kDataHeaderBytes + 2 * index);
}

void E57Packets::check_lengths() const {
  if (streams_ == 0) return;  // some writers end a scan without records with such a packet
  std::size_t used = kDataHeaderBytes + 2 * streams_;
  const bool known = streams_ == scan_.fields.size() && used <= bytes_.size();
  if (!known) {
    refuse_byte(pages_.name(), pages_.physical(start_),
                "a data packet of " + scan_.name() + " has " + std::to_string(streams_) +
                    " bytestreams; expected " + std::to_string(scan_.fields.size()) +
                    ", one for each field of a point");
  }
  for (std::size_t i = 0; i < streams_; ++i) used += stream_bytes(i);
  if (used > bytes_.size() || bytes_.size() - used > 3) {
    refuse_byte(pages_.name(), pages_.physical(start_),
                "a data packet of " + scan_.name() + " has " + std::to_string(bytes_.size()) +
                    " bytes; expected " + std::to_string(used) +
                    " as the lengths of its bytestreams say, and up to 3 more");
  }
}

std::span<const std::byte> E57Packets::stream(std::size_t index) const {
  if (streams_ == 0) return {};
  std::size_t start = kDataHeaderBytes + 2 * streams_;
  for (std::size_t i = 0; i < index; ++i) start += stream_bytes(i);
  return std::span(bytes_).subspan(start, stream_bytes(index));
}

void E57Packets::check_totals() {
  while (go_to(counted_)) {
  }
  for (std::size_t i = 0; i < totals_.size(); ++i) {
    const E57Field& field = scan_.fields[i];
    if (field.kind == E57Field::Kind::kText) continue;
    const std::uint64_t expected = field.bytes_of(scan_.records);
    // The reference implementation pads the last record to the words that it packs: up to 64 bits.
    const std::uint64_t padding = field.kind == E57Field::Kind::kInteger ? 7 : 0;
    if (totals_[i] >= expected && totals_[i] - expected <= padding) continue;
    refuse_byte(pages_.name(), scan_.file_offset,
                scan_.name() + " has " + std::to_string(totals_[i]) + " bytes in bytestream " +
                    std::to_string(i + 1) + "; expected " + std::to_string(expected) + " for its " +
                    std::to_string(scan_.records) + " records");
  }
}

}  // namespace clearway
