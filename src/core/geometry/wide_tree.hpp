#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/wide_tree_ref.hpp"

namespace clearway {

/// A bounding volume hierarchy of eight children a node over the parts of a ModelTree, so that
/// eight boxes or points are tested by one instruction each. It is a third as deep.
class WideTree {
 public:
  WideTree() = default;
  explicit WideTree(const ModelTree& model);

  /// Valid while the tree lives.
  WideTreeRef ref() const;

  std::uint64_t allocated_bytes() const {
    return nodes_.capacity() * sizeof(WideTreeRef::Node) +
           packets_.capacity() * sizeof(PointPacket);
  }

 private:
  void add_level(const std::vector<Box>& children);

  std::vector<WideTreeRef::Node> nodes_;
  std::vector<PointPacket> packets_;
  std::vector<std::uint32_t> first_;  ///< node of each level
  Vec3 origin_{};
};

}  // namespace clearway
