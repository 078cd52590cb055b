#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_items.hpp"

namespace clearway::test {

/// Builds LAZ files of point formats 0 to 3 and 6 to 8, as LasBytes does LAS, with an encoder of
/// its own. The layers of other attributes hold bytes that are not compressed, because the reader
/// passes over them.
struct LazBytes {
  enum class Table { kAtPoints, kAtEnd, kNone };

  LasBytes las;  ///< everything but the points
  std::vector<LazPoint> points;
  std::vector<std::uint32_t> chunks{5, 5, 5};  ///< number of points of each chunk but the last
  bool variable = false;  ///< whether chunks differ in size; if not, the first gives it
  bool chunked = true;    ///< false, for formats 0 to 3, is compressor 1
  Table table = Table::kAtPoints;

  /// Everything before the points. count: number of points for the header.
  std::string head(std::uint64_t count) const {
    LasBytes start = las;
    start.points.clear();
    start.evlrs.clear();
    start.vlrs.push_back({"laszip encoded", 22204, scheme()});
    std::string bytes = start.build();
    LasBytes::put(bytes, 104, static_cast<std::uint8_t>(las.format | 0x80));
    const bool legacy = las.minor < 4 || las.format < 6;
    LasBytes::put(bytes, 107, static_cast<std::uint32_t>(legacy ? count : 0));
    if (las.minor == 4) LasBytes::put(bytes, 247, count);
    return bytes;
  }

  std::string build() const {
    std::string bytes = head(points.size());
    append_points(bytes);
    if (!las.evlrs.empty()) {
      LasBytes::put<std::uint64_t>(bytes, 235, bytes.size());
      LasBytes::put(bytes, 243, static_cast<std::uint32_t>(las.evlrs.size()));
    }
    for (const auto& record : las.evlrs) LasBytes::append(bytes, record, 60);
    return bytes;
  }
  /// Where the points begin; the place of the chunk table stands there where there are chunks.
  std::uint32_t points_offset() const {
    return las.points_offset() + 54 + static_cast<std::uint32_t>(scheme().size());
  }
  /// Where each chunk begins.
  std::vector<std::uint64_t> chunk_begins() const {
    std::vector<std::uint64_t> begins;
    std::uint64_t at = points_offset() + 8;
    for (std::size_t begin = 0, i = 0; begin < points.size(); ++i) {
      const std::size_t end = chunk_end(begin, i);
      begins.push_back(at);
      at += chunk(begin, end).size();
      begin = end;
    }
    return begins;
  }

 private:
  std::size_t chunk_end(std::size_t begin, std::size_t number) const {
    const std::size_t size =
        variable ? (number < chunks.size() ? chunks[number] : points.size()) : chunks[0];
    return std::min(points.size(), begin + size);
  }
  std::string chunk(std::size_t begin, std::size_t end) const {
    return layered() ? layered_chunk(begin, end) : pointwise_chunk(begin, end);
  }
  bool layered() const { return las.format >= 6; }

  template <typename Number>
  static void add(std::string& bytes, Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  std::string scheme() const {
    std::vector<std::array<std::uint16_t, 3>> items{layered()
                                                        ? std::array<std::uint16_t, 3>{10, 30, 3}
                                                        : std::array<std::uint16_t, 3>{6, 20, 2}};
    if (las.format == 1 || las.format == 3) items.push_back({7, 8, 2});
    if (las.format == 2 || las.format == 3) items.push_back({8, 6, 2});
    if (las.format == 7) items.push_back({11, 6, 3});
    if (las.format == 8) items.push_back({12, 8, 3});
    if (las.extra_bytes > 0) {
      items.push_back({static_cast<std::uint16_t>(layered() ? 14 : 0),
                       static_cast<std::uint16_t>(las.extra_bytes),
                       static_cast<std::uint16_t>(layered() ? 3 : 2)});
    }
    std::string bytes(34, '\0');
    LasBytes::put<std::uint16_t>(bytes, 0, layered() ? 3 : chunked ? 2 : 1);
    LasBytes::put(bytes, 12, variable ? 0xFFFFFFFFu : chunks.front());
    LasBytes::put(bytes, 32, static_cast<std::uint16_t>(items.size()));
    for (const auto& item : items) {
      for (const std::uint16_t field : item) add(bytes, field);
    }
    return bytes;
  }

  std::string raw(const LazPoint& point) const {
    std::string bytes(las.record_bytes(), 'x');
    for (unsigned k = 0; k < 3; ++k) LasBytes::put(bytes, 4 * k, point.position[k]);
    LasBytes::put(bytes, 12, point.intensity);
    const unsigned shift = layered() ? 4 : 3;
    LasBytes::put(bytes, 14, static_cast<std::uint8_t>(point.number | point.returns << shift));
    const std::size_t next = layered() ? 16 : 15;
    LasBytes::put(bytes, next, point.classification);
    if (layered()) {
      LasBytes::put(bytes, 15, static_cast<std::uint8_t>(point.channel << 4 | point.flags));
    } else {
      LasBytes::put(bytes, 16, point.angle);
    }
    LasBytes::put(bytes, 17, point.user_data);
    if (layered() || las.format % 2 == 1) LasBytes::put(bytes, layered() ? 22 : 20, point.gps_time);
    return bytes;
  }

  std::string pointwise_chunk(std::size_t begin, std::size_t end) const {
    ArithmeticEncoder out;
    Point10Coder coder;
    GpsTimeCoder gps_time(points[begin].gps_time, false);
    ColourCoder colour;
    std::vector<SymbolCoder> extra(las.extra_bytes, SymbolCoder(256));
    for (std::size_t i = begin + 1; i < end; ++i) {
      coder.encode(out, points[i - 1], points[i]);
      if (las.format % 2 == 1) gps_time.encode(out, points[i].gps_time);
      if (las.format >= 2) colour.encode(out, points[i - 1], points[i]);
      for (auto& byte : extra) out.symbol(byte, static_cast<std::uint8_t>(i * i));
    }
    return raw(points[begin]) + out.finish();
  }

  std::string layered_chunk(std::size_t begin, std::size_t end) const {
    Point14Coder coder(points[begin]);
    for (std::size_t i = begin + 1; i < end; ++i) coder.encode(points[i]);
    const unsigned layers = 9 + (las.format == 7 ? 1 : las.format == 8 ? 2 : 0) + las.extra_bytes;
    std::string sizes;
    std::string bytes = coder.plane.finish();
    add(sizes, static_cast<std::uint32_t>(bytes.size()));
    const std::string height = coder.height.finish();
    add(sizes, static_cast<std::uint32_t>(height.size()));
    bytes += height;
    const std::string classes = coder.classes_change ? coder.classes.finish() : "";
    add(sizes, static_cast<std::uint32_t>(classes.size()));
    bytes += classes;
    for (unsigned i = 3; i < layers; ++i) {
      std::string layer(i % 4, 'l');
      if (i == 3) layer = coder.flags_change ? coder.flags.finish() : "";
      if (i == 8) layer = coder.times_change ? coder.times.finish() : "";
      add(sizes, static_cast<std::uint32_t>(layer.size()));
      bytes += layer;
    }
    std::string count;
    add(count, static_cast<std::uint32_t>(end - begin));
    return raw(points[begin]) + count + sizes + bytes;
  }

  void append_points(std::string& bytes) const {
    const std::size_t pointer = bytes.size();
    if (!layered() && !chunked) {
      bytes += pointwise_chunk(0, points.size());
      return;
    }
    add(bytes, table == Table::kAtEnd ? ~std::uint64_t{0} : std::uint64_t{pointer});
    std::vector<std::array<std::uint32_t, 2>> entries;
    for (std::size_t begin = 0, i = 0; begin < points.size(); ++i) {
      const std::size_t end = chunk_end(begin, i);
      const std::string one = chunk(begin, end);
      bytes += one;
      entries.push_back(
          {static_cast<std::uint32_t>(end - begin), static_cast<std::uint32_t>(one.size())});
      begin = end;
    }
    if (table == Table::kNone) return;
    const std::uint64_t place = bytes.size();
    if (table == Table::kAtPoints) LasBytes::put(bytes, pointer, place);
    add(bytes, std::uint32_t{0});
    add(bytes, static_cast<std::uint32_t>(entries.size()));
    ArithmeticEncoder out;
    IntegerCoder coder(32, 2);
    std::array<std::uint32_t, 2> last{};
    for (const auto& entry : entries) {
      for (unsigned k = variable ? 0 : 1; k < 2; ++k) {
        coder.encode(out, static_cast<std::int32_t>(last[k]), static_cast<std::int32_t>(entry[k]),
                     k);
      }
      last = entry;
    }
    if (!entries.empty()) bytes += out.finish();
    if (table == Table::kAtEnd) add(bytes, place);
  }
};

}  // namespace clearway::test
