#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/scans/cut_off.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/e57/e57_document.hpp"
#include "io/scans/e57/e57_file.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Logical positions of a scan's binary section.
struct E57Extent {
  std::uint64_t start = 0;
  std::uint64_t packets = 0;  ///< start of the first packet
  std::uint64_t end = 0;

  std::uint64_t packet_bytes() const { return end - packets; }
};

/// Reads the header of a scan's binary section. Compares it with the file and with the scan's
/// number of records, for which the packets must have room. A scan without records may lack a
/// section; its extent is empty. Throws InputError.
E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan);

/// The data packets of a scan, read in the order of the file. The index is not used, so no offset
/// in a packet is ever followed. Takes the memory of one packet.
class E57Packets {
 public:
  static constexpr std::size_t kMostBytes = 65536;  ///< greatest size of a packet

  /// The arguments must outlive this object.
  E57Packets(E57Pages& pages, const E57Scan& scan, const E57Extent& extent);

  std::uint64_t first() const { return extent_.packets; }
  /// Makes the first data packet at or after `position`, where some packet must begin, the current
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
  std::vector<std::byte> buffer_;  ///< zeros after bytes_, so that whole words can be loaded
  std::size_t bytes_ = 0;
  std::uint64_t bit_ = 0;  ///< first bit of the next record in buffer_
};

/// Findings in a scan's records, complete once the scan has been read.
struct E57Findings {
  std::uint64_t absent = 0;  ///< records without a valid point
  /// The finite points against the declared bounds, without the pose and with it. Empty where there
  /// are no bounds, and `posed` where there is no pose.
  BoundsWarnings::Found own, posed;
  CutOff cut_off;  ///< points at the ends of fields of 32-bit integers
};

/// Reads the points of one scan and applies its pose.
class E57ScanReader {
 public:
  /// The arguments must outlive this object. The scan must have coordinates.
  E57ScanReader(E57Pages& pages, const E57Scan& scan, const E57Extent& extent);
  E57ScanReader(const E57ScanReader&) = delete;
  E57ScanReader& operator=(const E57ScanReader&) = delete;

  /// Appends points until the batch has PointReader::kBatchPoints. Returns false, with nothing
  /// appended, once all are read and the section has been compared with the scan's number of
  /// records.
  bool read(PointBatch& batch);
  const E57Findings& findings() const { return findings_; }

 private:
  static constexpr std::size_t kChunk = 1024;
  using Column = std::array<double, kChunk>;

  std::size_t available(std::size_t room);
  void decode(std::size_t count);
  bool is_valid(E57Place state, std::size_t i) const;
  void check_state(E57Place state, std::size_t count) const;
  void check_angle(const char* name, double value, double most, std::size_t i) const;
  void place_points(std::span<Vec3> out, std::size_t first, std::vector<std::uint32_t>& absent);
  Vec3 cartesian(std::size_t i) const;
  void count_cut_off(std::size_t count);
  Vec3 spherical(std::size_t i) const;
  void finish();

  E57Pages& pages_;
  const E57Scan& scan_;
  std::optional<Box> reach_;  ///< of the declared bounds
  E57Packets packets_;
  std::array<std::optional<E57Cursor>, kE57Places> cursors_;
  std::array<Column, kE57Places> columns_;
  E57Findings findings_;
  std::uint64_t next_ = 0;  ///< record to read next
  bool finished_ = false;
};

}  // namespace clearway
