#include "core/section/section_ref.hpp"

namespace clearway {

SectionRef section_ref(const SectionPoses& poses, const SectionLattice& lattice, double slack,
                       SectionMaps& maps) {
  return {.node_count = static_cast<std::uint32_t>(poses.nodes().size()),
          .pose_count = static_cast<std::uint32_t>(poses.pull_backs().size()),
          .bin_count = static_cast<std::uint32_t>(maps.entries().size() / maps.shape().entries),
          .nodes = poses.nodes().data(),
          .pull_backs = poses.pull_backs().data(),
          .path_pose = poses.path_pose().data(),
          .lattice = lattice,
          .slack = slack,
          .shape = maps.shape(),
          .entries = maps.entries().data()};
}

std::vector<std::uint32_t> bins_in_reach(const SectionRef& section, const Box& points) {
  std::vector<std::uint32_t> bins, open{0};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    const SectionPoseNode& node = section.nodes[at];
    if (!section.may_block(node, points)) continue;
    if (node.bin != SectionPoseNode::kManyBins) {
      bins.push_back(at);
      continue;
    }
    open.push_back(node.right);
    open.push_back(at + 1);
  }
  return bins;
}

}  // namespace clearway
