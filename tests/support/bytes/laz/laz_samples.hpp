#pragma once

#include <random>
#include <utility>

#include "io/scans/point_reader.hpp"
#include "support/bytes/laz/laz_bytes.hpp"

namespace clearway::test {

/// Points that take the coder through all its widths, contexts and changes. None is withheld.
inline std::vector<LazPoint> laz_points(std::size_t count, bool formats_6_to_8, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  std::vector<LazPoint> points(count);
  LazPoint point;
  std::uint64_t other_time = 0;
  for (LazPoint& next : points) {
    for (std::int32_t& value : point.position) {
      const unsigned bits = below(8) == 0 ? 32 : below(12);
      const auto step = static_cast<std::uint32_t>(random() & ((std::uint64_t{1} << bits) - 1));
      value = static_cast<std::int32_t>(static_cast<std::uint32_t>(value) +
                                        (below(2) ? step : 0 - step));
    }
    point.returns = 1 + below(formats_6_to_8 ? 2 : 3);
    point.number = 1 + below(point.returns);
    if (formats_6_to_8 && below(5) == 0) point.channel = below(4);
    if (below(2)) point.intensity = static_cast<std::uint16_t>(random());
    if (below(6) == 0) {
      point.classification = static_cast<std::uint8_t>(random() & (formats_6_to_8 ? 255 : 127));
    }
    if (formats_6_to_8 && below(6) == 0) point.flags = static_cast<std::uint8_t>(random() & 11);
    if (below(6) == 0) point.user_data = static_cast<std::uint8_t>(random());
    if (below(6) == 0) point.source = static_cast<std::uint16_t>(random());
    if (below(6) == 0) point.angle = static_cast<std::int8_t>(random());
    if (below(3)) point.gps_time += below(9) == 0 ? std::uint64_t{random()} << 32 : below(1000);
    if (below(12) == 0) std::swap(point.gps_time, other_time);
    for (auto& value : point.colour) value = static_cast<std::uint16_t>(value + below(300));
    next = point;
  }
  return points;
}

/// A file of a point format, with extra bytes where the format is odd.
inline LazBytes laz_bytes(unsigned format, std::size_t count) {
  LazBytes laz;
  laz.las.format = format;
  laz.las.minor = format < 6 ? 2 : 4;
  laz.las.extra_bytes = format % 2 * 3;
  laz.points = laz_points(count, format >= 6);
  return laz;
}

/// What read(point) gives for each point.
template <typename Read>
auto each_of(const std::vector<LazPoint>& points, Read read) {
  std::vector<std::decay_t<decltype(read(points[0]))>> values;
  for (const LazPoint& point : points) values.push_back(read(point));
  return values;
}

inline std::vector<std::array<std::int32_t, 3>> positions_of(const std::vector<LazPoint>& points) {
  return each_of(points, [](const LazPoint& point) { return point.position; });
}

inline std::vector<std::uint8_t> classes_of(const LazBytes& laz) {
  return each_of(laz.points, [&](const LazPoint& point) -> std::uint8_t {
    return laz.las.format < 6 ? point.classification & 31 : point.classification;
  });
}

/// The flags of the points, as bits of PointFlags.
inline std::vector<std::uint8_t> flags_of(const LazBytes& laz) {
  return each_of(laz.points, [&](const LazPoint& point) -> std::uint8_t {
    if (laz.las.format >= 6) return point.flags;
    const int overlap = (point.classification & 31) == 12 ? 8 : 0;
    return static_cast<std::uint8_t>(point.classification >> 5 | overlap);
  });
}

constexpr unsigned kLazFormats[] = {0, 1, 2, 3, 6, 7, 8};

}  // namespace clearway::test
