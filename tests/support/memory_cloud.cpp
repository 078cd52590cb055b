#include "support/memory_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "clearway/error.hpp"

namespace clearway {

MemoryCloud::MemoryCloud(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
                         const Quantisation& quantisation, const MemoryCloudOptions& options)
    : MemoryCloud(points, quantisation, options) {
  for (std::size_t cell = 0; cell < cells().size(); ++cell) {
    std::vector<std::uint8_t> values(cell_points());
    for (std::uint32_t i = 0; i < cell_points(); ++i) {
      const std::uint32_t point = std::min(i, cells()[cell].count - 1);
      values[i] = classes[source(cell * cell_entries() + point)];
    }
    append_packed_chunk<std::uint8_t>(values, classes_.emplace_back());
  }
}

std::array<PackedChunk<std::int32_t>, 3> MemoryCloud::coordinates(std::uint32_t cell) const {
  if (cell == damaged_cell_) {
    throw InputError("memory: cell " + std::to_string(cell) + " is damaged");
  }
  return SmallCloud::coordinates(cell);
}

std::array<PackedChunk<std::int32_t>, 3> MemoryCloud::read_packed(std::uint32_t cell,
                                                                  std::span<std::byte> to) const {
  coordinates(cell);  // throws where the cell is damaged
  return SmallCloud::read_packed(cell, to);
}

std::vector<Vec3> positions_of(std::span<const Quantum> points, const Quantisation& quantisation) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Quantum& q : points) out.push_back(position(quantisation, q[0], q[1], q[2]));
  return out;
}

std::vector<Quantum> quantise(std::span<const Vec3> points, const Quantisation& quantisation) {
  std::vector<Quantum> out;
  out.reserve(points.size());
  for (const Vec3& p : points) {
    Quantum& q = out.emplace_back();
    for (int k = 0; k < 3; ++k) {
      q[k] = static_cast<std::int32_t>(
          std::lround((p[k] - quantisation.offset[k]) / quantisation.scale[k]));
    }
  }
  return out;
}

}  // namespace clearway
