#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Gives equal positions the same index, in the order of their first use. -0 equals 0.
class VertexWelder {
 public:
  static constexpr std::uint32_t kMostVertices = 4'000'000'000;

  /// vertices: the distinct positions by their index. It must outlive this object and be changed by
  /// it alone.
  explicit VertexWelder(std::vector<Vec3>& vertices) : vertices_(vertices), table_(1024, kFree) {}

  /// The index of a finite position.
  std::uint32_t number_of(const Vec3& position) {
    const Vec3 vertex{position.x + 0.0, position.y + 0.0, position.z + 0.0};
    if (2 * (vertices_.size() + 1) > table_.size()) grow();
    std::uint32_t& slot = slot_of(vertex);
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(vertex);
    }
    return slot;
  }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

  static std::uint64_t hash_of(const Vec3& v) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(v[k])) * 0x9E3779B97F4A7C15;
      hash ^= hash >> 29;
    }
    return hash;
  }

  /// The slot of this vertex, or the free one that it will get.
  std::uint32_t& slot_of(const Vec3& vertex) {
    std::size_t at = hash_of(vertex) & (table_.size() - 1);
    while (table_[at] != kFree && vertices_[table_[at]] != vertex) {
      at = (at + 1) & (table_.size() - 1);
    }
    return table_[at];
  }

  void grow() {
    table_.assign(2 * table_.size(), kFree);
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) slot_of(vertices_[i]) = i;
  }

  std::vector<Vec3>& vertices_;
  // Hash table of indices; its size is a power of two, at most half full.
  std::vector<std::uint32_t> table_;
};

}  // namespace clearway
