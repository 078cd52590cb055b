#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <random>
#include <vector>

#include "support/bytes/las_bytes.hpp"
#include "support/clouds.hpp"

/// Scans whose points have classes.
namespace clearway::test {

inline std::vector<std::uint8_t> random_classes(std::size_t count, unsigned most) {
  std::mt19937 random(count + most);
  std::vector<std::uint8_t> classes(count);
  for (std::uint8_t& value : classes) value = static_cast<std::uint8_t>(random() % (most + 1));
  return classes;
}

/// Writes a LAS file whose points have classes. offset: of the coordinates, metres.
inline void write_classed(const std::filesystem::path& path, const std::vector<Quantum>& points,
                          const std::vector<std::uint8_t>& classes, unsigned format = 6,
                          std::array<double, 3> offset = LasBytes().offset) {
  LasBytes las;
  las.minor = 4;
  las.format = format;
  las.scale = {0.001, 0.001, 0.001};
  las.offset = offset;
  las.points = points;
  las.bytes_of_class = classes;
  put_bytes(path, las.build());
}

}  // namespace clearway::test
