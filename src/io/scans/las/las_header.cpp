#include "io/scans/las/las_header.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

constexpr std::size_t kHeaderBytes10 = 227;  // size of the header of LAS 1.0 to 1.2
constexpr std::size_t kHeaderBytes13 = 235;
constexpr std::size_t kHeaderBytes14 = 375;
constexpr std::uint16_t kSmallestRecord[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::uint16_t kInternalWaveforms = 2;  // bit of the global encoding
// Bits of byte 104 that hold the point format; LAZ sets one of the others.
constexpr unsigned kFormatBits = 0x3F;

std::span<const std::byte> take_header(InputBuffer& input, std::size_t bytes) {
  const auto taken = input.take(bytes);
  if (taken.empty()) refuse_cut_las(input, fmt::format("a LAS header of at least {} bytes", bytes));
  return taken;
}

/// Checks those fields of the first 227 bytes that decide how the rest is read.
void check_kind(const InputBuffer& input, const std::byte* header) {
  if (std::memcmp(header, "LASF", 4) != 0) {
    refuse_byte(input.name(), 0, "expected the signature LASF of a LAS file");
  }
  const unsigned major = load<std::uint8_t>(header + 24);
  const unsigned minor = load<std::uint8_t>(header + 25);
  if (major != 1 || minor > 4) {
    refuse_byte(input.name(), 24, "version {}.{}; expected LAS 1.0 to 1.4", major, minor);
  }
  const unsigned format = load<std::uint8_t>(header + 104) & kFormatBits;
  if ((load<std::uint8_t>(header + 104) & ~kFormatBits) == 0xC0u) {
    refuse_byte(input.name(), 104,
                "the points are compressed as before LASzip 1.0; expected LAZ as LASzip writes it "
                "since 2010. Compress them again");
  }
  if (format >= std::size(kSmallestRecord)) {
    refuse_byte(input.name(), 104, "point format " + std::to_string(format) + "; expected 0 to 10");
  }
  const unsigned record = load<std::uint16_t>(header + 105);
  if (record < kSmallestRecord[format]) {
    refuse_byte(input.name(), 105,
                "point records of {} bytes; expected at least {} for point format {}", record,
                kSmallestRecord[format], format);
  }
}

Quantisation read_quantisation(const InputBuffer& input, const std::byte* header) {
  Quantisation result;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned scale_byte = 131 + 8 * axis;
    const unsigned offset_byte = 155 + 8 * axis;
    result.scale[axis] = load<double>(header + scale_byte);
    result.offset[axis] = load<double>(header + offset_byte);
    const std::string name(1, static_cast<char>('x' + axis));
    if (!std::isfinite(result.scale[axis]) || result.scale[axis] <= 0) {
      refuse_byte(input.name(), scale_byte, "{} scale is {}; expected a positive number", name,
                  format_number(result.scale[axis]));
    }
    if (!std::isfinite(result.offset[axis])) {
      refuse_byte(input.name(), offset_byte, "{} offset is {}; expected a finite number", name,
                  format_number(result.offset[axis]));
    }
  }
  return result;
}

/// The day on which a file was made, from the number of the day in its year, from 1 on, and the
/// year; empty where either cannot be one.
std::string date_of(unsigned day, unsigned year) {
  using namespace std::chrono;
  constexpr unsigned kFirstYear = 1990, kLastYear = 2200;
  if (day < 1 || day > 366 || year < kFirstYear || year > kLastYear) return "";
  const sys_days first = std::chrono::year(static_cast<int>(year)) / January / 1;
  const year_month_day date(first + days(day - 1));
  char text[16];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  return text;
}

/// Reads the bounds, which are stored as the greatest and the least of x, of y and of z; nullopt
/// where the writer did not fill them in.
std::optional<Box> read_box(const std::byte* bytes) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    box.hi[k] = load<double>(bytes + 179 + 16 * k);
    box.lo[k] = load<double>(bytes + 187 + 16 * k);
  }
  return is_filled_in(box) ? std::optional(box) : std::nullopt;
}

/// Reads the fields of version 1.4. rest: the header from byte 227 on.
void read_version_14(const InputBuffer& input, std::span<const std::byte> rest,
                     LasPublicHeader& header) {
  const std::byte* bytes = rest.data() - kHeaderBytes10;
  const auto points = load<std::uint64_t>(bytes + 247);
  if (header.points != 0 && header.points != points) {
    refuse_byte(input.name(), 247,
                std::to_string(points) + " points declared, but " + std::to_string(header.points) +
                    " at byte 107; expected equal counts, or 0 there");
  }
  header.points = points;
  header.tail_offset = load<std::uint64_t>(bytes + 235);
  header.tail_count = load<std::uint32_t>(bytes + 243);
}

void check_layout(const InputBuffer& input, const LasPublicHeader& header) {
  if (header.points_offset < header.header_bytes) {
    refuse_byte(input.name(), 96,
                "points start at byte {}; expected them behind the header of {} bytes",
                header.points_offset, header.header_bytes);
  }
  if (header.compressed) return;  // the chunk table says where the points are
  const std::uint64_t room = std::numeric_limits<std::int64_t>::max() - header.points_offset;
  if (header.points > room / header.record_bytes) {
    refuse(input.name(), "declares {} points of {} bytes; expected a count that a file can hold",
           header.points, header.record_bytes);
  }
  if (header.tail_count > 0 && header.tail_offset < header.points_end()) {
    refuse(input.name(), "extended variable length records start at byte " +
                             std::to_string(header.tail_offset) +
                             "; expected them behind the points, which end at byte " +
                             std::to_string(header.points_end()));
  }
  if (input.size() && *input.size() < header.points_end()) {
    refuse(input.name(),
           "ends at byte {}; expected {} bytes for {} points of {} bytes from byte {}",
           *input.size(), header.points_end(), header.points, header.record_bytes,
           header.points_offset);
  }
}

}  // namespace

void refuse_cut_las(const InputBuffer& input, const std::string& expected) {
  refuse(input.name(), "ends at byte {}; expected {}", input.end_position(), expected);
}

std::uint64_t LasPublicHeader::points_end() const { return points_offset + points * record_bytes; }

LasPublicHeader read_las_header(InputBuffer& input) {
  LasPublicHeader header{};
  const std::byte* bytes = take_header(input, kHeaderBytes10).data();
  check_kind(input, bytes);
  const unsigned minor = load<std::uint8_t>(bytes + 25);
  header.encoding = load<std::uint16_t>(bytes + 6);
  const bool internal_waveforms = (header.encoding & kInternalWaveforms) != 0;
  header.date = date_of(load<std::uint16_t>(bytes + 90), load<std::uint16_t>(bytes + 92));
  header.header_bytes = load<std::uint16_t>(bytes + 94);
  header.points_offset = load<std::uint32_t>(bytes + 96);
  header.vlr_count = load<std::uint32_t>(bytes + 100);
  header.record_bytes = load<std::uint16_t>(bytes + 105);
  header.points = load<std::uint32_t>(bytes + 107);
  header.point_format = load<std::uint8_t>(bytes + 104) & kFormatBits;
  header.compressed = (load<std::uint8_t>(bytes + 104) & ~kFormatBits) != 0;
  header.has_flags = minor > 0;
  header.quantisation = read_quantisation(input, bytes);
  header.box = read_box(bytes);

  const std::size_t least = minor == 4 ? kHeaderBytes14 : kHeaderBytes10;
  if (header.header_bytes < least) {
    refuse_byte(input.name(), 94, "header of {} bytes; expected at least {} for LAS 1.{}",
                header.header_bytes, least, minor);
  }
  if (minor == 4) {
    read_version_14(input, take_header(input, kHeaderBytes14 - kHeaderBytes10), header);
  } else if (minor == 3 && header.header_bytes >= kHeaderBytes13 && internal_waveforms &&
             !header.compressed) {
    // LAS 1.3 has at most one extended record, the waveforms. In LAZ their position is not read,
    // because it may be that in the LAS file from which the LAZ file was made.
    header.tail_offset = load<std::uint64_t>(take_header(input, 8).data());
    header.tail_count = header.tail_offset == 0 ? 0 : 1;
  }
  check_layout(input, header);
  if (!input.skip(header.header_bytes - input.position())) {
    refuse_cut_las(input, "a header of " + std::to_string(header.header_bytes) + " bytes");
  }
  return header;
}

}  // namespace clearway
