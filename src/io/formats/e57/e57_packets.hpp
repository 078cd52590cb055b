#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/formats/e57/e57_section.hpp"

namespace clearway {

/// The data packets of a scan, read in the order of the file. The index is not used, so no offset
/// in a packet is ever followed. Takes the memory of one packet.
class E57Packets {
 public:
  static constexpr std::size_t kMostBytes = 65536;  ///< greatest size of a packet

  /// The arguments must outlive this object.
  E57Packets(E57Pages& pages, const E57Scan& scan, const E57Extent& extent);

  std::uint64_t first() const { return extent_.packets; }
  /// Makes the first data packet at or behind `position`, where some packet must begin, the current
  /// one. Returns false at the end of the section.
  bool go_to(std::uint64_t position);
  /// The bytes of a bytestream in the current packet.
  std::span<const std::byte> stream(std::size_t index) const;
  /// Position of the current packet in the file.
  std::uint64_t physical_position() const { return pages_.physical(start_); }
  std::uint64_t next() const { return next_; }
  /// Whether the bytestreams of the current packet do not continue those of the packet before.
  bool restarts() const { return restarts_; }

  /// Reads the rest of the section and compares the bytes of every bytestream with the scan's
  /// number of records. Throws InputError where there are fewer or more.
  void check_totals();

 private:
  struct PacketHeader;

  PacketHeader read_header(std::uint64_t position);
  void read_data(std::uint64_t position, const PacketHeader& header);
  void check_lengths() const;
  std::size_t stream_bytes(std::size_t index) const;

  E57Pages& pages_;
  const E57Scan& scan_;
  const E57Extent& extent_;
  std::vector<std::byte> bytes_;       ///< bytes of the current packet
  std::vector<std::uint64_t> totals_;  ///< bytes of each bytestream up to counted_
  std::uint64_t counted_;
  std::uint64_t start_ = 0;
  std::uint64_t next_ = 0;  ///< position of the next packet; 0 where no packet is current
  std::size_t streams_ = 0;
  bool restarts_ = false;
};

}  // namespace clearway
