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
    std::vector<std::uint64_t> begins{points_offset() + 8};
    for (const auto& [count, bytes] : divided()) begins.push_back(begins.back() + bytes.size());
    begins.pop_back();
    return begins;
  }

 private:
  using Chunks = std::vector<std::pair<std::uint32_t, std::string>>;

  /// The number of points and the bytes of each chunk.
  Chunks divided() const {
    Chunks all;
    for (std::size_t begin = 0, end; begin < points.size(); begin = end) {
      const std::size_t size = !variable                    ? chunks[0]
                               : all.size() < chunks.size() ? chunks[all.size()]
                                                            : points.size();
      end = std::min(points.size(), begin + size);
      all.emplace_back(end - begin,
                       layered() ? layered_chunk(begin, end) : pointwise_chunk(begin, end));
    }
    return all;
  }
  bool layered() const { return las.format >= 6; }

  template <typename Number>
  static void add(std::string& bytes, Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  std::string scheme() const {
    std::vector<std::array<unsigned, 3>> items;  // type, bytes and version
    if (layered()) {
      items = {{10, 30, 3}};
      if (las.format > 6) items.push_back({las.format + 4, las.format == 7 ? 6u : 8u, 3});
      if (las.extra_bytes > 0) items.push_back({14, las.extra_bytes, 3});
    } else {
      items = {{6, 20, 2}};
      if (las.format % 2 == 1) items.push_back({7, 8, 2});
      if (las.format >= 2) items.push_back({8, 6, 2});
      if (las.extra_bytes > 0) items.push_back({0, las.extra_bytes, 2});
    }
    std::string bytes(34, '\0');
    LasBytes::put<std::uint16_t>(bytes, 0, layered() ? 3 : chunked ? 2 : 1);
    LasBytes::put(bytes, 12, variable ? 0xFFFFFFFFu : chunks.front());
    LasBytes::put(bytes, 32, static_cast<std::uint16_t>(items.size()));
    for (const auto& item : items) {
      for (const unsigned field : item) add(bytes, static_cast<std::uint16_t>(field));
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
    std::vector<std::string> layers{coder.plane.finish(), coder.height.finish(),
                                    coder.classes_change ? coder.classes.finish() : ""};
    layers.resize(9 + (las.format == 7 ? 1 : las.format == 8 ? 2 : 0) + las.extra_bytes);
    for (std::size_t i = 3; i < layers.size(); ++i) layers[i].assign(i % 4, 'l');
    layers[3] = coder.flags_change ? coder.flags.finish() : "";
    layers[8] = coder.times_change ? coder.times.finish() : "";
    std::string sizes, bytes;
    add(sizes, static_cast<std::uint32_t>(end - begin));
    for (const std::string& layer : layers) {
      add(sizes, static_cast<std::uint32_t>(layer.size()));
      bytes += layer;
    }
    return raw(points[begin]) + sizes + bytes;
  }

  void append_points(std::string& bytes) const {
    const std::size_t pointer = bytes.size();
    if (!layered() && !chunked) {
      bytes += pointwise_chunk(0, points.size());
      return;
    }
    add(bytes, table == Table::kAtEnd ? ~std::uint64_t{0} : std::uint64_t{pointer});
    const Chunks all = divided();
    for (const auto& [count, chunk] : all) bytes += chunk;
    if (table == Table::kNone) return;
    const std::uint64_t place = bytes.size();
    if (table == Table::kAtPoints) LasBytes::put(bytes, pointer, place);
    add(bytes, std::uint32_t{0});
    add(bytes, static_cast<std::uint32_t>(all.size()));
    ArithmeticEncoder out;
    IntegerCoder coder(32, 2);
    std::int32_t last_count = 0, last_size = 0;
    for (const auto& [count, chunk] : all) {
      if (variable) coder.encode(out, last_count, static_cast<std::int32_t>(count), 0);
      coder.encode(out, last_size, static_cast<std::int32_t>(chunk.size()), 1);
      last_count = static_cast<std::int32_t>(count);
      last_size = static_cast<std::int32_t>(chunk.size());
    }
    if (!all.empty()) bytes += out.finish();
    if (table == Table::kAtEnd) add(bytes, place);
  }
};

}  // namespace clearway::test
