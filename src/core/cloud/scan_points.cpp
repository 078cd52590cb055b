#include "core/cloud/scan_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// The box in the model's frame around a box of the scan.
Box seen_from(const PullBack& frame, const Box& box) {
  const Vec3 centre = frame.apply(box.centre()), size = box.size();
  Box out{centre, centre};
  for (int k = 0; k < 3; ++k) {
    const Vec3& row = frame.rows[k];
    const double half =
        (std::abs(row.x) * size.x + std::abs(row.y) * size.y + std::abs(row.z) * size.z) /
        std::abs(2 * frame.determinant);
    out.lo[k] -= half;
    out.hi[k] += half;
  }
  return out;
}

class Visit {
 public:
  Visit(const PackedCloud& cloud, const Box& region, const Pose& pose, const ScanPoints::Look& look,
        std::unordered_map<std::uint32_t, ScanPoints::Chunks>& chunks, std::uint32_t most_blocks)
      : cloud_(cloud),
        chunks_(chunks),
        most_blocks_(most_blocks),
        region_(region),
        place_(moved(region, pose)),
        frame_(pose),
        look_(look) {}

  bool run() {
    const std::span<const TreeNode> tree = cloud_.tree();
    std::vector<std::uint32_t> open{0};
    while (!open.empty() && !stopped_) {
      const std::uint32_t node = open.back();
      open.pop_back();
      if (!may_matter(position_box(cloud_.quantisation(), tree[node].box))) continue;
      if (tree[node].right != 0) {
        open.push_back(tree[node].right);
        open.push_back(node + 1);
      } else {
        look_into(tree[node].first_cell);
      }
    }
    return blocks_ <= most_blocks_;
  }

 private:
  bool may_matter(const Box& box) const {
    return box.distance(place_) == 0 && seen_from(frame_, box).distance(region_) == 0;
  }

  /// The packed chunks of a cell, kept because reading them checks all bytes of the cell.
  const ScanPoints::Chunks& chunks_of(std::uint32_t cell) {
    const auto known = chunks_.find(cell);
    return known != chunks_.end() ? known->second
                                  : chunks_.emplace(cell, cloud_.peek(cell)).first->second;
  }

  void look_into(std::uint32_t cell) {
    const Cell& here = cloud_.cells()[cell];
    const StepRange range(position_box(cloud_.quantisation(), here.box), place_, 0);
    const BlockBoxes blocks = cloud_.blocks(cell);
    const ScanPoints::Chunks* chunks = nullptr;
    for (std::uint32_t first = 0; first < here.count && !stopped_; first += kBlockPoints) {
      const std::uint32_t block = first / kBlockPoints;
      if (!range.meets(blocks[block])) continue;
      if (!may_matter(cloud_.block_box(cell, block))) continue;
      if (blocks_++ == most_blocks_) {
        stopped_ = true;
        return;
      }
      if (chunks == nullptr) chunks = &chunks_of(cell);
      look_at(cell, *chunks, first, std::min<std::uint32_t>(kBlockPoints, here.count - first));
    }
  }

  void look_at(std::uint32_t cell, const ScanPoints::Chunks& chunks, std::uint32_t first,
               std::uint32_t count) {
    std::array<std::array<std::int32_t, kBlockPoints>, 3> quanta{};
    for (std::size_t k = 0; k < 3; ++k) {
      chunks[k].decode(first, std::span(quanta[k]).first(count));
    }
    for (std::uint32_t i = 0; i < count && !stopped_; ++i) {
      const Vec3 p =
          frame_.apply(position(cloud_.quantisation(), quanta[0][i], quanta[1][i], quanta[2][i]));
      if (region_.contains(p)) stopped_ = !look_(p, cell, first + i);
    }
  }

  const PackedCloud& cloud_;
  std::unordered_map<std::uint32_t, ScanPoints::Chunks>& chunks_;
  std::uint32_t most_blocks_;
  const Box& region_;
  Box place_;
  const PullBack frame_;
  const ScanPoints::Look& look_;
  std::uint64_t blocks_ = 0;
  bool stopped_ = false;
};

}  // namespace

bool ScanPoints::visit(const Box& region, const Pose& pose, const Look& look) const {
  return Visit(cloud_, region, pose, look, chunks_, most_blocks_).run();
}

bool ScanPoints::has(const Box& region, const Pose& pose, std::uint64_t least) const {
  std::uint64_t found = 0;
  const bool all = visit(region, pose, [&](auto...) { return ++found < least; });
  return !all || found >= least;
}

double ScanPoints::bottom_of_scan(const Box& body, const Pose& pose) const {
  const Box environment = position_box(cloud_.quantisation(), cloud_.tree()[0].box);
  constexpr double kTilted = 1.5;
  return body.lo.z - kTilted * std::max(0.0, moved(body, pose).lo.z - environment.lo.z);
}

}  // namespace clearway
