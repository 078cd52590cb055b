#include "io/scans/e57/e57_scan_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/paths/pose_input.hpp"
#include "io/scans/e57/e57_file.hpp"

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

namespace {

constexpr std::size_t kWordBytes = 8;

template <typename Float>
void decode_floats(const std::byte* at, std::span<double> out) {
  for (double& value : out) {
    value = static_cast<double>(load<Float>(at));
    at += sizeof(Float);
  }
}

/// Unpacks unsigned integers of `width` bits, least significant bit first. words_beyond: whether an
/// integer may reach into a ninth byte.
template <bool words_beyond, typename Use>
void unpack(const std::byte* bytes, std::uint64_t bit, unsigned width, std::span<double> out,
            Use use) {
  const std::uint64_t mask = ~std::uint64_t{0} >> (64 - width);
  for (double& value : out) {
    const std::byte* at = bytes + bit / 8;
    const unsigned shift = bit % 8;
    std::uint64_t word = load<std::uint64_t>(at) >> shift;
    if constexpr (words_beyond) {
      if (shift > 0) word |= std::uint64_t{load<std::uint8_t>(at + kWordBytes)} << (64 - shift);
    }
    value = use(word & mask);
    bit += width;
  }
}

}  // namespace

E57Cursor::E57Cursor(E57Packets& packets, const E57Field& field, std::size_t stream)
    : packets_(packets),
      field_(field),
      stream_(stream),
      next_packet_(packets.first()),
      buffer_(2 * kWordBytes) {}

std::uint64_t E57Cursor::available() const {
  return field_.bits == 0 ? std::numeric_limits<std::uint64_t>::max() : bits_left() / field_.bits;
}

bool E57Cursor::refill(const std::string& file) {
  if (!packets_.go_to(next_packet_)) return false;
  next_packet_ = packets_.next();
  if (packets_.restarts() && bits_left() > 0) {
    refuse_byte(file, packets_.physical_position(),
                "a data packet restarts its bytestreams within a record; expected whole records "
                "before it");
  }
  const std::size_t consumed = bit_ / 8;
  const std::size_t kept = bytes_ - consumed;  // less than a record, thus at most 8 bytes
  bit_ %= 8;
  const auto stream = packets_.stream(stream_);
  std::memmove(buffer_.data(), buffer_.data() + consumed, kept);
  bytes_ = kept + stream.size();
  buffer_.resize(std::max(buffer_.size(), bytes_ + 2 * kWordBytes));
  std::copy(stream.begin(), stream.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(kept));
  std::fill_n(buffer_.begin() + static_cast<std::ptrdiff_t>(bytes_), 2 * kWordBytes, std::byte{0});
  return true;
}

void E57Cursor::decode(std::span<double> out) {
  const std::byte* at = buffer_.data() + bit_ / 8;
  switch (field_.kind) {
    case E57Field::Kind::kFloat32:
      decode_floats<float>(at, out);
      break;
    case E57Field::Kind::kFloat64:
      decode_floats<double>(at, out);
      break;
    case E57Field::Kind::kInteger:
    case E57Field::Kind::kText:  // fields of text never hold coordinates
      decode_integers(out);
      break;
  }
  bit_ += out.size() * field_.bits;
}

void E57Cursor::decode_integers(std::span<double> out) {
  // The unsigned sum wraps like two's complement, so it is right for every width of the integers.
  const auto minimum = static_cast<std::uint64_t>(field_.minimum);
  const double scale = field_.scale, offset = field_.offset;
  const auto value_of = [=](std::uint64_t stored) {
    return static_cast<double>(static_cast<std::int64_t>(minimum + stored)) * scale + offset;
  };
  if (field_.bits == 0) {
    std::fill(out.begin(), out.end(), value_of(0));
  } else if (field_.bits <= 57) {
    unpack<false>(buffer_.data(), bit_, field_.bits, out, value_of);
  } else {
    unpack<true>(buffer_.data(), bit_, field_.bits, out, value_of);
  }
}

bool E57Cursor::holds_more() const {
  if (field_.bits == 0 || bits_left() < field_.bits) return false;
  for (std::uint64_t bit = bit_; bit < 8 * std::uint64_t{bytes_}; ++bit) {
    if (((load<std::uint8_t>(&buffer_[bit / 8]) >> (bit % 8)) & 1) != 0) return true;
  }
  return false;
}

namespace {

constexpr double kNoPosition = std::numeric_limits<double>::quiet_NaN();

/// Adds the finite ones of the points, some of which may be out of reach.
void add_to(BoundsWarnings::Found& found, std::span<const Vec3> points, const Box& reach) {
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    if (found.points++ == 0) found.box = {p, p};
    found.box.extend(p);
    if (!reach.contains(p)) ++found.beyond;
  }
}

}  // namespace

E57ScanReader::E57ScanReader(E57Pages& pages, const E57Scan& scan, const E57Extent& extent)
    : pages_(pages), scan_(scan), reach_(reach_of(scan.bounds)), packets_(pages, scan, extent) {
  // Without a state field, every Cartesian coordinate is valid, so the spherical ones are not
  // needed.
  const bool only_cartesian = scan.is_cartesian() && !scan.has(kE57CartesianState);
  for (std::size_t place = 0; place < kE57Places; ++place) {
    const std::uint32_t stream = scan.places[place];
    const bool needed =
        place <= kE57CartesianState ? scan.is_cartesian() : scan.is_spherical() && !only_cartesian;
    if (stream == kNoE57Stream || !needed) continue;
    cursors_[place].emplace(packets_, scan.fields[stream], stream);
  }
}

bool E57ScanReader::read(PointBatch& batch) {
  const std::size_t before = batch.positions.size();
  while (next_ < scan_.records && batch.positions.size() < PointReader::kBatchPoints) {
    const std::size_t first = batch.positions.size();
    const std::size_t count = available(std::min(kChunk, PointReader::kBatchPoints - first));
    decode(count);
    batch.positions.resize(first + count);
    place_points(std::span(batch.positions).subspan(first), first, batch.absent);
    next_ += count;
  }
  if (batch.positions.size() > before) return true;
  finish();
  return false;
}

/// Number of records for which every field has data, at least one and at most `room`.
std::size_t E57ScanReader::available(std::size_t room) {
  std::uint64_t count = std::min<std::uint64_t>(room, scan_.records - next_);
  for (auto& cursor : cursors_) {
    if (!cursor) continue;
    while (cursor->available() == 0) {
      if (cursor->refill(pages_.name())) continue;
      refuse_byte(pages_.name(), scan_.file_offset,
                  scan_.name() + " ends after " + std::to_string(next_) + " records; expected " +
                      std::to_string(scan_.records));
    }
    count = std::min(count, cursor->available());
  }
  return count;
}

void E57ScanReader::decode(std::size_t count) {
  for (std::size_t place = 0; place < kE57Places; ++place) {
    if (cursors_[place]) cursors_[place]->decode(std::span(columns_[place]).first(count));
  }
  check_state(kE57CartesianState, count);
  check_state(kE57SphericalState, count);
}

void E57ScanReader::check_state(E57Place state, std::size_t count) const {
  if (!cursors_[state]) return;
  const auto states = std::span(columns_[state]).first(count);
  const auto wrong = std::find_if(states.begin(), states.end(),
                                  [](double s) { return s != 0 && s != 1 && s != 2; });
  if (wrong == states.end()) return;
  refuse_byte(pages_.name(), scan_.file_offset,
              scan_.name() + ", record " + std::to_string(next_ + (wrong - states.begin())) +
                  " (counted from 0) has the invalid state " + format_number(*wrong) +
                  "; expected 0, 1 or 2");
}

void E57ScanReader::check_angle(const char* name, double value, double most, std::size_t i) const {
  constexpr double kRounding = 1e-3;  // radians; of angles that are stored as scaled integers
  if (!(std::abs(value) > most + kRounding)) return;
  refuse_byte(pages_.name(), scan_.file_offset,
              scan_.name() + ", record " + std::to_string(next_ + i) +
                  " (counted from 0): " + objection_to_angle(name, value, most, "E57"));
}

bool E57ScanReader::is_valid(E57Place state, std::size_t i) const {
  return !cursors_[state] || columns_[state][i] == 0;
}

Vec3 E57ScanReader::cartesian(std::size_t i) const {
  return {columns_[kE57X][i], columns_[kE57Y][i], columns_[kE57Z][i]};
}

/// The position of a record with spherical coordinates: azimuth from x towards y, elevation from
/// the x-y plane towards z, in radians. Throws InputError for an angle beyond its range.
Vec3 E57ScanReader::spherical(std::size_t i) const {
  const double range = columns_[kE57Range][i];
  const double azimuth = columns_[kE57Azimuth][i];
  const double elevation = columns_[kE57Elevation][i];
  check_angle("azimuth", azimuth, 2 * std::numbers::pi, i);
  // Scanners that turn over the zenith count on behind it.
  check_angle("elevation", elevation, std::numbers::pi, i);
  const double in_plane = range * std::cos(elevation);
  return {in_plane * std::cos(azimuth), in_plane * std::sin(azimuth), range * std::sin(elevation)};
}

/// Counts the valid ones of decoded Cartesian coordinates that are at the ends of their integers,
/// where a field has all of 32 bits.
void E57ScanReader::count_cut_off(std::size_t count) {
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

/// Computes the points of decoded records and lists the absent ones. out: points of the batch from
/// index `first` on.
void E57ScanReader::place_points(std::span<Vec3> out, std::size_t first,
                                 std::vector<std::uint32_t>& absent) {
  const bool has_cartesian = cursors_[kE57X].has_value();
  const bool has_spherical = cursors_[kE57Range].has_value();
  if (has_cartesian) count_cut_off(out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (has_cartesian && is_valid(kE57CartesianState, i)) {
      out[i] = cartesian(i);
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

void E57ScanReader::finish() {
  if (finished_) return;
  packets_.check_totals();
  for (auto& cursor : cursors_) {
    if (!cursor) continue;
    while (cursor->refill(pages_.name())) {
    }
    if (!cursor->holds_more()) continue;
    refuse_byte(pages_.name(), scan_.file_offset,
                scan_.name() + " goes on behind its last record; expected " +
                    std::to_string(scan_.records) + " records and zeros up to the next word");
  }
  finished_ = true;
}

}  // namespace clearway
