#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace clearway::test {

/// Builds LAS files byte by byte, straight from the specification and without the reader's code.
struct LasBytes {
  struct Record {
    std::string user;
    std::uint16_t id;
    std::string payload;
  };

  unsigned minor = 2;
  unsigned format = 0;
  unsigned extra_bytes = 0;  ///< bytes behind each point's standard fields
  unsigned padding = 0;      ///< bytes between the last VLR and the first point
  std::uint16_t global_encoding = 0;
  std::array<double, 3> scale{0.001, 0.01, 0.1};
  std::array<double, 3> offset{100, -200, 0};
  std::vector<std::array<std::int32_t, 3>> points{
      {1, 2, 3}, {-4, 5, -6}, {2147483647, -2147483647 - 1, 0}};
  std::vector<double> times{};                 ///< GPS times, one for each point; empty: any
  std::vector<std::uint8_t> bytes_of_class{};  ///< one for each point, flags included; empty: any
  /// Byte 15 of each point in formats 6 to 10, whose lowest bits are flags; empty: any
  std::vector<std::uint8_t> bytes_of_flags{};
  std::vector<Record> vlrs = {};
  std::vector<Record> evlrs = {};  ///< 1.4: any number; 1.3: one

  unsigned record_bytes() const {
    static constexpr unsigned kBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    return kBytes[format] + extra_bytes;
  }
  unsigned header_bytes() const { return minor == 4 ? 375 : minor == 3 ? 235 : 227; }
  std::uint32_t points_offset() const {
    std::uint32_t offset_bytes = header_bytes() + padding;
    for (const Record& record : vlrs) {
      offset_bytes += 54 + static_cast<std::uint32_t>(record.payload.size());
    }
    return offset_bytes;
  }
  std::uint64_t points_end() const { return points_offset() + points.size() * record_bytes(); }

  template <typename Number>
  static void put(std::string& bytes, std::size_t at, Number value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }

  std::string build() const {
    std::string bytes(header_bytes(), '\0');
    bytes.replace(0, 4, "LASF");
    put(bytes, 6, global_encoding);
    put<std::uint8_t>(bytes, 24, 1);
    put(bytes, 25, static_cast<std::uint8_t>(minor));
    put(bytes, 94, static_cast<std::uint16_t>(header_bytes()));
    put(bytes, 96, points_offset());
    put(bytes, 100, static_cast<std::uint32_t>(vlrs.size()));
    put(bytes, 104, static_cast<std::uint8_t>(format));
    put(bytes, 105, static_cast<std::uint16_t>(record_bytes()));
    const bool legacy = minor < 4 || format < 6;
    put(bytes, 107, static_cast<std::uint32_t>(legacy ? points.size() : 0));
    for (unsigned k = 0; k < 3; ++k) {
      put(bytes, 131 + 8 * k, scale[k]);
      put(bytes, 155 + 8 * k, offset[k]);
    }
    if (minor == 3 && !evlrs.empty()) put<std::uint64_t>(bytes, 227, points_end());
    if (minor == 4) {
      put<std::uint64_t>(bytes, 235, evlrs.empty() ? 0 : points_end());
      put(bytes, 243, static_cast<std::uint32_t>(evlrs.size()));
      put<std::uint64_t>(bytes, 247, points.size());
    }
    for (const Record& record : vlrs) append(bytes, record, 54);
    bytes.append(padding, 'p');
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::string one(record_bytes(), 'r');
      for (unsigned k = 0; k < 3; ++k) put(one, 4 * k, points[i][k]);
      if (!times.empty()) put(one, format < 6 ? 20 : 22, times[i]);
      if (!bytes_of_class.empty()) put(one, format < 6 ? 15 : 16, bytes_of_class[i]);
      if (!bytes_of_flags.empty()) put(one, 15, bytes_of_flags[i]);
      bytes += one;
    }
    for (const Record& record : evlrs) append(bytes, record, 60);
    return bytes;
  }

  /// Appends a record. header: bytes of its header, 54 for a variable length record and 60 for an
  /// extended one.
  static void append(std::string& bytes, const Record& record, unsigned header) {
    std::string head(header, '\0');
    head.replace(2, record.user.size(), record.user);
    put(head, 18, record.id);
    if (header == 54) {
      put(head, 20, static_cast<std::uint16_t>(record.payload.size()));
    } else {
      put<std::uint64_t>(head, 20, record.payload.size());
    }
    bytes += head + record.payload;
  }
};

/// A file for each way in which LAS begins and ends its points.
inline std::vector<LasBytes> las_samples() {
  const auto of = [](unsigned minor, unsigned format) {
    LasBytes las{.minor = minor, .format = format};
    las.vlrs = {{"someone", 7, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"a\"]"}};
    return las;
  };
  std::vector<LasBytes> all{of(0, 1), of(2, 3), of(3, 4), of(4, 6), of(4, 7)};
  all[0].padding = 2;
  all[1].extra_bytes = 7;
  all[2].global_encoding = 2;
  all[2].evlrs = {{"LASF_Spec", 65535, "waveforms"}};
  all[4].vlrs.pop_back();
  all[4].evlrs = {{"someone", 1, "payload"}, {"LASF_Projection", 2112, "LOCAL_CS[\"b\"]"}};
  return all;
}

}  // namespace clearway::test
