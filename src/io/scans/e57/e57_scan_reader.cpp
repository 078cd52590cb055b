#include "io/scans/e57/e57_scan_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/paths/pose_input.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

constexpr std::size_t kSectionHeaderBytes = 32;

/// Throws InputError about a scan, at the place of its points.
template <typename... Args>
[[noreturn]] void refuse_scan(const E57Pages& pages, const E57Scan& scan,
                              fmt::format_string<const Args&...> what, const Args&... args) {
  refuse_byte(pages.name(), scan.file_offset, scan.name() + fmt::format(what, args...));
}

/// Throws InputError where the packets are too small to hold the bits of every record.
void check_room(const E57Pages& pages, const E57Scan& scan, const E57Extent& extent) {
  const std::uint64_t room = extent.end - extent.packets;
  std::uint64_t needed = 0;
  for (const E57Field& field : scan.fields) {
    needed += field.bytes_of(scan.records);
    if (needed <= room) continue;
    refuse_scan(pages, scan, " has packets of {} bytes; expected more for its {} records", room,
                scan.records);
  }
}

}  // namespace

E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan) {
  if (scan.records == 0 && scan.file_offset == 0) return {};
  const auto start = pages.logical(scan.file_offset);
  if (!start || *start < kE57HeaderBytes) {
    refuse(pages.name(), scan.name() + " has its points at byte " +
                             std::to_string(scan.file_offset) +
                             "; expected a place behind the header, within the file and in no "
                             "checksum");
  }
  std::array<std::byte, kSectionHeaderBytes> header;
  pages.read(*start, header, "the header of a scan's points");
  const auto id = load<std::uint8_t>(header.data());
  if (id != 1) {
    refuse_scan(pages, scan, " has a binary section of kind {}; expected 1, compressed vectors",
                id);
  }
  const auto length = load<std::uint64_t>(header.data() + 8);
  if (length < kSectionHeaderBytes || length > pages.size() - *start || length % 4 != 0) {
    refuse_scan(
        pages, scan,
        " has a binary section of {} bytes; expected a multiple of 4 that ends before the file",
        length);
  }
  const std::uint64_t end = *start + length;
  const auto offset = load<std::uint64_t>(header.data() + 16);
  auto packets = pages.logical(offset);
  if (length == kSectionHeaderBytes) {
    packets = end;  // there are no packets to point to
  } else if (!packets || *packets < *start + kSectionHeaderBytes || *packets >= end) {
    refuse_scan(pages, scan,
                " has its first packet at byte {}; expected a place within its section", offset);
  }
  const E57Extent extent{*start, *packets, end};
  check_room(pages, scan, extent);
  return extent;
}

namespace {

/// The data packets of a scan, read in the order of the file. The index is not used, so no offset
/// in a packet is ever followed. Takes the memory of one packet.
class E57Packets {
 public:
  E57Packets(E57Pages& pages, const E57Scan& scan, const E57Extent& extent)
      : pages_(pages),
        scan_(scan),
        extent_(extent),
        totals_(scan.fields.size(), 0),
        counted_(extent.packets) {
    bytes_.reserve(kMostBytes);
  }

  std::uint64_t first() const { return extent_.packets; }
  std::uint64_t next() const { return next_; }
  /// Whether the bytestreams of the current packet do not continue those of the packet before.
  bool restarts() const { return restarts_; }

  /// Makes the first data packet at or after `position`, where some packet must begin, the current
  /// one. Returns false at the end of the section.
  bool go_to(std::uint64_t position) {
    enum : std::uint8_t { kIndex, kData, kIgnored };
    while (position < extent_.end) {
      if (next_ != 0 && position == start_) return true;
      const Header header = read_header(position);
      if (header.kind == kData) {
        read_data(position, header);
        return true;
      }
      if (header.kind != kIndex && header.kind != kIgnored) {
        refuse_packet(position, "a packet",
                      "has kind " + std::to_string(header.kind) + "; expected 0, 1 or 2");
      }
      position += header.bytes;
    }
    return false;
  }

  /// The bytes of a bytestream in the current packet.
  std::span<const std::byte> stream(std::size_t index) const {
    if (streams_ == 0) return {};
    std::size_t start = kHeaderBytes + 2 * streams_;
    for (std::size_t i = 0; i < index; ++i) start += stream_bytes(i);
    return std::span(bytes_).subspan(start, stream_bytes(index));
  }

  /// Throws InputError about the packet at `position`.
  [[noreturn]] void refuse_packet(std::uint64_t position, const std::string& packet,
                                  const std::string& what) const {
    refuse_byte(pages_.name(), pages_.physical(position),
                packet + " of " + scan_.name() + " " + what);
  }
  [[noreturn]] void refuse_current(const std::string& what) const {
    refuse_packet(start_, "a data packet", what);
  }

  /// Reads the rest of the section and compares the bytes of every bytestream with the scan's
  /// number of records. Throws InputError where there are fewer or more.
  void check_totals() {
    while (go_to(counted_)) {
    }
    for (std::size_t i = 0; i < totals_.size(); ++i) {
      const E57Field& field = scan_.fields[i];
      if (field.kind == E57Field::Kind::kText) continue;
      const std::uint64_t expected = field.bytes_of(scan_.records);
      // The reference implementation pads the last record to the words that it packs: up to 64
      // bits.
      const std::uint64_t padding = field.kind == E57Field::Kind::kInteger ? 7 : 0;
      if (totals_[i] >= expected && totals_[i] - expected <= padding) continue;
      refuse_scan(pages_, scan_, " has {} bytes in bytestream {}; expected {} for its {} records",
                  totals_[i], i + 1, expected, scan_.records);
    }
  }

 private:
  static constexpr std::size_t kMostBytes = 65536;  ///< greatest size of a packet
  static constexpr std::size_t kHeaderBytes = 6;

  struct Header {
    std::uint8_t kind, flags;
    std::size_t bytes;
  };

  Header read_header(std::uint64_t position) {
    std::array<std::byte, 4> bytes;
    const std::uint64_t room = extent_.end - position;
    if (room >= bytes.size()) {
      pages_.read(position, bytes, "a packet's header");
      const Header header{load<std::uint8_t>(bytes.data()), load<std::uint8_t>(&bytes[1]),
                          std::size_t{load<std::uint16_t>(&bytes[2])} + 1};
      if (header.bytes <= room && header.bytes >= bytes.size() && header.bytes % 4 == 0) {
        return header;
      }
    }
    refuse_packet(position, "a packet",
                  "has a wrong length; expected a multiple of 4 that ends before its section");
  }

  void read_data(std::uint64_t position, const Header& header) {
    next_ = 0;
    bytes_.resize(header.bytes);
    pages_.read(position, bytes_, "a data packet");
    start_ = position;
    restarts_ = (header.flags & 1) != 0;
    streams_ = header.bytes < kHeaderBytes ? 0 : load<std::uint16_t>(&bytes_[4]);
    check_lengths();
    next_ = position + header.bytes;
    if (position < counted_) return;
    for (std::size_t i = 0; i < streams_; ++i) totals_[i] += stream_bytes(i);
    counted_ = next_;
  }

  std::size_t stream_bytes(std::size_t index) const {
    return load<std::uint16_t>(bytes_.data() + kHeaderBytes + 2 * index);
  }

  void check_lengths() const {
    if (streams_ == 0) return;  // some writers end a scan without records with such a packet
    std::size_t used = kHeaderBytes + 2 * streams_;
    if (streams_ != scan_.fields.size() || used > bytes_.size()) {
      refuse_current("has " + std::to_string(streams_) + " bytestreams; expected " +
                     std::to_string(scan_.fields.size()) + ", one for each field of a point");
    }
    for (std::size_t i = 0; i < streams_; ++i) used += stream_bytes(i);
    if (used > bytes_.size() || bytes_.size() - used > 3) {
      refuse_current("has " + std::to_string(bytes_.size()) + " bytes; expected " +
                     std::to_string(used) +
                     " as the lengths of its bytestreams say, and up to 3 more");
    }
  }

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
  E57Cursor(E57Packets& packets, const E57Field& field, std::size_t stream)
      : packets_(packets),
        field_(field),
        stream_(stream),
        next_packet_(packets.first()),
        buffer_(kBeyond) {}

  /// Number of records that can be decoded now.
  std::uint64_t available() const {
    return field_.bits == 0 ? std::numeric_limits<std::uint64_t>::max() : bits_left() / field_.bits;
  }

  /// To be called when no record is available: takes the field's bytes from the next packet.
  /// Returns false at the end.
  bool refill() {
    if (!packets_.go_to(next_packet_)) return false;
    next_packet_ = packets_.next();
    if (packets_.restarts() && bits_left() > 0) {
      packets_.refuse_current(
          "restarts its bytestreams within a record; expected whole records before it");
    }
    const auto stream = packets_.stream(stream_);
    const auto consumed = static_cast<std::ptrdiff_t>(bit_ / 8);
    buffer_.erase(buffer_.begin(), buffer_.begin() + consumed);
    buffer_.resize(buffer_.size() - kBeyond);  // less than a record is left
    buffer_.insert(buffer_.end(), stream.begin(), stream.end());
    buffer_.resize(buffer_.size() + kBeyond);
    bit_ %= 8;
    return true;
  }

  /// Decodes the next out.size() records, which must be available.
  void decode(std::span<double> out) {
    switch (field_.kind) {
      case E57Field::Kind::kFloat32:
        decode_floats<float>(out);
        break;
      case E57Field::Kind::kFloat64:
        decode_floats<double>(out);
        break;
      case E57Field::Kind::kInteger:
      case E57Field::Kind::kText:  // fields of text never hold coordinates
        decode_integers(out);
        break;
    }
    bit_ += out.size() * field_.bits;
  }

  /// Whether the bits that are left are more than padding, that is hold a whole record that is not
  /// 0.
  bool holds_more() const {
    if (field_.bits == 0 || bits_left() < field_.bits) return false;
    if (std::to_integer<unsigned>(buffer_[bit_ / 8]) >> bit_ % 8 != 0) return true;
    return std::any_of(buffer_.begin() + static_cast<std::ptrdiff_t>(bit_ / 8 + 1), buffer_.end(),
                       [](std::byte byte) { return byte != std::byte{0}; });
  }

 private:
  /// Zeros after the field's bytes, so that two words can be loaded at any of them.
  static constexpr std::size_t kBeyond = 2 * sizeof(std::uint64_t);

  std::uint64_t bits_left() const { return 8 * std::uint64_t{buffer_.size() - kBeyond} - bit_; }

  template <typename Float>
  void decode_floats(std::span<double> out) const {
    const std::byte* at = buffer_.data() + bit_ / 8;
    for (double& value : out) {
      value = static_cast<double>(load<Float>(at));
      at += sizeof(Float);
    }
  }

  /// Unpacks integers, whose bits stand least significant first.
  void decode_integers(std::span<double> out) const {
    const std::uint64_t mask = field_.bits == 0 ? 0 : ~std::uint64_t{0} >> (64 - field_.bits);
    const auto minimum = static_cast<std::uint64_t>(field_.minimum);
    const double scale = field_.scale, offset = field_.offset;
    std::uint64_t bit = bit_;
    for (double& value : out) {
      const std::byte* at = buffer_.data() + bit / 8;
      const unsigned shift = bit % 8;
      const auto low = load<std::uint64_t>(at), high = load<std::uint64_t>(at + sizeof low);
      const std::uint64_t stored = (low >> shift | high << 1 << (63 - shift)) & mask;
      // The unsigned sum wraps like two's complement, so it is right for every width.
      value = static_cast<double>(static_cast<std::int64_t>(minimum + stored)) * scale + offset;
      bit += field_.bits;
    }
  }

  E57Packets& packets_;
  const E57Field& field_;
  std::size_t stream_;
  std::uint64_t next_packet_;
  std::vector<std::byte> buffer_;
  std::uint64_t bit_ = 0;  ///< first bit of the next record in buffer_
};

/// Adds the finite ones of the points, some of which may be out of reach.
void add_to(BoundsWarnings::Found& found, std::span<const Vec3> points, const Box& reach) {
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    if (found.points++ == 0) found.box = {p, p};
    found.box.extend(p);
    if (!reach.contains(p)) ++found.beyond;
  }
}

class FieldsReader final : public E57ScanReader {
 public:
  FieldsReader(E57Pages& pages, const E57Scan& scan, const E57Extent& extent)
      : pages_(pages), scan_(scan), reach_(reach_of(scan.bounds)), packets_(pages, scan, extent) {
    // Without a state field, every Cartesian coordinate is valid, so the spherical ones are not
    // needed.
    const bool only_cartesian = scan.is_cartesian() && !scan.has(kE57CartesianState);
    for (std::size_t place = 0; place < kE57Places; ++place) {
      const std::uint32_t stream = scan.places[place];
      const bool needed = place <= kE57CartesianState ? scan.is_cartesian()
                                                      : scan.is_spherical() && !only_cartesian;
      if (stream == kNoE57Stream || !needed) continue;
      cursors_[place].emplace(packets_, scan.fields[stream], stream);
    }
  }
  FieldsReader(const FieldsReader&) = delete;
  FieldsReader& operator=(const FieldsReader&) = delete;

  bool read(PointBatch& batch) override {
    const std::size_t before = batch.positions.size();
    while (next_ < scan_.records && batch.positions.size() < PointReader::kBatchPoints) {
      const std::size_t first = batch.positions.size();
      const std::size_t count = available(std::min(kChunk, PointReader::kBatchPoints - first));
      for (std::size_t place = 0; place < kE57Places; ++place) {
        if (cursors_[place]) cursors_[place]->decode(std::span(columns_[place]).first(count));
      }
      check_state(kE57CartesianState, count);
      check_state(kE57SphericalState, count);
      batch.positions.resize(first + count);
      place_points(std::span(batch.positions).subspan(first), first, batch.absent);
      next_ += count;
    }
    if (batch.positions.size() > before) return true;
    finish();
    return false;
  }

 private:
  static constexpr std::size_t kChunk = 1024;
  static constexpr double kNoPosition = std::numeric_limits<double>::quiet_NaN();

  /// Throws InputError about a record. i: its number among those that were decoded last.
  [[noreturn]] void refuse_record(std::size_t i, const std::string& what) const {
    refuse_scan(pages_, scan_, ", record {} (counted from 0){}", next_ + i, what);
  }

  /// Number of records for which every field has data, at least one and at most `room`.
  std::size_t available(std::size_t room) {
    std::uint64_t count = std::min<std::uint64_t>(room, scan_.records - next_);
    for (auto& cursor : cursors_) {
      if (!cursor) continue;
      while (cursor->available() == 0) {
        if (cursor->refill()) continue;
        refuse_scan(pages_, scan_, " ends after {} records; expected {}", next_, scan_.records);
      }
      count = std::min(count, cursor->available());
    }
    return count;
  }

  void check_state(E57Place state, std::size_t count) const {
    if (!cursors_[state]) return;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = columns_[state][i];
      if (value == 0 || value == 1 || value == 2) continue;
      refuse_record(i, " has the invalid state " + format_number(value) + "; expected 0, 1 or 2");
    }
  }

  void check_angle(const char* name, double value, double most, std::size_t i) const {
    constexpr double kRounding = 1e-3;  // radians; of angles that are stored as scaled integers
    if (!(std::abs(value) > most + kRounding)) return;
    refuse_record(i, ": " + objection_to_angle(name, value, most, "E57"));
  }

  bool is_valid(E57Place state, std::size_t i) const {
    return !cursors_[state] || columns_[state][i] == 0;
  }

  /// The position of a record with spherical coordinates: azimuth from x towards y, elevation from
  /// the x-y plane towards z, in radians. Throws InputError for an angle beyond its range.
  Vec3 spherical(std::size_t i) const {
    const double range = columns_[kE57Range][i];
    const double azimuth = columns_[kE57Azimuth][i];
    const double elevation = columns_[kE57Elevation][i];
    check_angle("azimuth", azimuth, 2 * std::numbers::pi, i);
    // Scanners that turn over the zenith count on behind it.
    check_angle("elevation", elevation, std::numbers::pi, i);
    const double in_plane = range * std::cos(elevation);
    return {in_plane * std::cos(azimuth), in_plane * std::sin(azimuth),
            range * std::sin(elevation)};
  }

  /// Counts the valid ones of decoded Cartesian coordinates that are at the ends of their integers,
  /// where a field has all of 32 bits.
  void count_cut_off(std::size_t count) {
    for (std::size_t k = 0; k < 3; ++k) {
      const E57Field& field = scan_.fields[scan_.places[kE57X + k]];
      if (field.kind != E57Field::Kind::kInteger || field.bits > 32 ||
          field.minimum < CutOff::kLowest || field.minimum > CutOff::kGreatest) {
        continue;
      }
      const auto add = [&](std::int64_t end, std::uint64_t& points) {
        const double value = static_cast<double>(end) * field.scale + field.offset;
        for (std::size_t i = 0; i < count; ++i) {
          if (columns_[kE57X + k][i] == value && is_valid(kE57CartesianState, i)) ++points;
        }
      };
      const std::int64_t last = field.minimum + (std::int64_t{1} << field.bits) - 1;
      if (field.minimum == CutOff::kLowest) add(CutOff::kLowest, findings_.cut_off.lowest[k]);
      if (last == CutOff::kGreatest) add(CutOff::kGreatest, findings_.cut_off.greatest[k]);
    }
  }

  /// Computes the points of decoded records and lists the absent ones. out: points of the batch
  /// from index `first` on.
  void place_points(std::span<Vec3> out, std::size_t first, std::vector<std::uint32_t>& absent) {
    const bool has_cartesian = cursors_[kE57X].has_value();
    const bool has_spherical = cursors_[kE57Range].has_value();
    if (has_cartesian) count_cut_off(out.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (has_cartesian && is_valid(kE57CartesianState, i)) {
        out[i] = {columns_[kE57X][i], columns_[kE57Y][i], columns_[kE57Z][i]};
      } else if (has_spherical && is_valid(kE57SphericalState, i)) {
        out[i] = spherical(i);
      } else {
        out[i] = {kNoPosition, kNoPosition, kNoPosition};
        absent.push_back(static_cast<std::uint32_t>(first + i));
        ++findings_.absent;
      }
    }
    if (reach_) add_to(findings_.own, out, *reach_);
    if (!scan_.pose) return;
    for (Vec3& point : out) point = transform(*scan_.pose, point);
    if (reach_) add_to(findings_.posed, out, *reach_);
  }

  void finish() {
    if (finished_) return;
    packets_.check_totals();
    for (auto& cursor : cursors_) {
      if (!cursor) continue;
      while (cursor->refill()) {
      }
      if (!cursor->holds_more()) continue;
      refuse_scan(
          pages_, scan_,
          " goes on behind its last record; expected {} records and zeros up to the next word",
          scan_.records);
    }
    finished_ = true;
  }

  E57Pages& pages_;
  const E57Scan& scan_;
  std::optional<Box> reach_;  ///< of the declared bounds
  E57Packets packets_;
  std::array<std::optional<E57Cursor>, kE57Places> cursors_;
  std::array<std::array<double, kChunk>, kE57Places> columns_;
  std::uint64_t next_ = 0;  ///< record to read next
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<E57ScanReader> make_e57_scan_reader(E57Pages& pages, const E57Scan& scan,
                                                    const E57Extent& extent) {
  return std::make_unique<FieldsReader>(pages, scan, extent);
}

}  // namespace clearway
