#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/cloud/small_cloud.hpp"

namespace clearway {

using MemoryCloudOptions = SmallCloud::Packing;

/// A cloud in memory for tests and benchmarks: it may have classes, and cells that are damaged.
class MemoryCloud : public SmallCloud {
 public:
  MemoryCloud(std::span<const Quantum> points, const Quantisation& quantisation,
              const MemoryCloudOptions& options = {})
      : SmallCloud(points, quantisation, options) {}
  /// A cloud of points with classes. classes: one for each point.
  MemoryCloud(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
              const Quantisation& quantisation, const MemoryCloudOptions& options = {});

  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override;

  /// Every second cell, so that engines get cells both in place and copied.
  std::optional<std::array<PackedChunk<std::int32_t>, 3>> in_place(
      std::uint32_t cell) const override {
    if (cell % 2 == 1) return std::nullopt;
    return coordinates(cell);
  }

  bool has_classes() const override { return !classes_.empty(); }
  PackedChunk<std::uint8_t> classes(std::uint32_t cell) const override {
    return {classes_[cell], cell_points()};
  }

  bool is_used(std::uint64_t slot) const {
    return slot % cell_entries() < cells()[slot / cell_entries()].count;
  }

  /// Makes coordinates(cell) throw InputError from now on, as for a damaged store.
  void damage(std::uint32_t cell) { damaged_cell_ = cell; }

 private:
  std::vector<std::vector<std::byte>> classes_;  ///< one chunk for each cell
  std::uint32_t damaged_cell_ = 0xffffffff;
};

/// The positions of quanta, as the store defines them.
std::vector<Vec3> positions_of(std::span<const Quantum> points, const Quantisation& quantisation);

/// The quanta that are nearest to the points.
std::vector<Quantum> quantise(std::span<const Vec3> points, const Quantisation& quantisation);

}  // namespace clearway
