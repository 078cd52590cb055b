#pragma once

#include <algorithm>

#include "core/cloud/packed_cloud.hpp"

namespace clearway::test {

/// A cloud of one cell whose x, y and z are the same packed bytes.
class OneCellCloud final : public PackedCloud {
 public:
  OneCellCloud(std::span<const std::byte> chunk, std::uint32_t count)
      : chunk_(chunk),
        cell_{count, {}},
        node_{0, 1, 0, {}},
        blocks_(divide_up(count, kBlockPoints)) {}

  std::uint64_t point_count() const override { return cell_.count; }
  std::uint32_t cell_points() const override { return cell_.count; }
  const Quantisation& quantisation() const override { return quantisation_; }
  std::span<const Cell> cells() const override { return {&cell_, 1}; }
  std::span<const TreeNode> tree() const override { return {&node_, 1}; }
  std::span<const BlockBox> blocks() const override { return blocks_; }
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t) const override {
    const PackedChunk<std::int32_t> chunk(chunk_, cell_.count);
    return {chunk, chunk, chunk};
  }
  std::uint64_t packed_bytes(std::uint32_t) const override { return 3 * chunk_.size(); }
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t,
                                                       std::span<std::byte> to) const override {
    std::array<PackedChunk<std::int32_t>, 3> chunks;
    for (auto& chunk : chunks) {
      std::copy(chunk_.begin(), chunk_.end(), to.begin());
      chunk = PackedChunk<std::int32_t>(to.first(chunk_.size()), cell_.count);
      to = to.subspan(chunk_.size());
    }
    return chunks;
  }
  std::uint64_t source_of(std::uint32_t, std::uint32_t index) const override { return index; }

 private:
  std::span<const std::byte> chunk_;
  Cell cell_;
  TreeNode node_;
  Quantisation quantisation_{{1, 1, 1}, {0, 0, 0}};
  std::vector<BlockBox> blocks_;
};

}  // namespace clearway::test
