#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/wide_tree_ref.hpp"

namespace clearway {

/// A bounding volume hierarchy over the parts of a ModelTreeOf with eight children for each node,
/// so that one instruction tests eight boxes or points, or 16 triangles. It is a third as deep as
/// that tree.
template <typename Element>
class WideTreeOf {
 public:
  using Ref = WideTreeRefOf<Element>;

  WideTreeOf() = default;
  explicit WideTreeOf(const ModelTreeOf<Element>& model);

  /// The tree for look-ups. Valid while the tree lives.
  Ref ref() const;

  std::uint64_t allocated_bytes() const {
    return nodes_.capacity() * sizeof(WideBoxes::Node) +
           slabs_.capacity() * sizeof(WideBoxes::Slabs) +
           packets_.capacity() * sizeof(PacketOf<Element>);
  }

 private:
  struct Part;

  void add_level(const std::vector<Part>& children);
  void add_slab(std::size_t child, const Part& part);

  std::vector<WideBoxes::Node> nodes_;
  std::vector<WideBoxes::Slabs> slabs_;  ///< one for each node; only for triangles
  std::vector<PacketOf<Element>> packets_;
  std::vector<std::uint32_t> first_;  ///< first node of each level
  Vec3 origin_{};
};

using WideTree = WideTreeOf<Vec3>;

extern template class WideTreeOf<Vec3>;
extern template class WideTreeOf<Triangle>;

}  // namespace clearway
