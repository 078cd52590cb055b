#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/formats/e57/e57_packets.hpp"

namespace clearway {

/// Decodes one field of a scan, record by record. It advances through the packets independently, so
/// that the fields of a record may lie in different packets, however far apart. Takes as much
/// memory as one packet holds of the field.
class E57Cursor {
 public:
  /// The arguments must outlive this object. stream: index of the scan's bytestream.
  E57Cursor(E57Packets& packets, const E57Field& field, std::size_t stream);

  /// Number of records that can be decoded now.
  std::uint64_t available() const;
  /// To be called when no record is available: takes the field's bytes from the next packet.
  /// Returns false at the end. file: name for messages.
  bool refill(const std::string& file);
  /// Decodes the next out.size() records, which must be available.
  void decode(std::span<double> out);
  /// Whether the bits that are left are more than padding, that is hold a whole record that is not
  /// 0.
  bool holds_more() const;

 private:
  std::uint64_t bits_left() const { return 8 * std::uint64_t{bytes_} - bit_; }
  void decode_integers(std::span<double> out);

  E57Packets& packets_;
  const E57Field& field_;
  std::size_t stream_;
  std::uint64_t next_packet_;
  std::vector<std::byte> buffer_;  ///< zeros behind bytes_, so that whole words can be loaded
  std::size_t bytes_ = 0;
  std::uint64_t bit_ = 0;  ///< first bit of the next record in buffer_
};

}  // namespace clearway
