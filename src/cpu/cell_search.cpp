#include "cpu/cell_search.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/predicate.hpp"
#include "core/page/page.hpp"
#include "core/query/search_result.hpp"
#include "core/util/lane_bits.hpp"

namespace clearway {

template <typename Element>
void CellSearchOf<Element>::run(const PageRef& page, std::uint32_t index, const Output& output) {
  page_ = page;
  index_ = index;
  cell_ = &page.cell(index);
  blocks_ = page.blocks(index);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    chunks_[axis] = packed_chunk(page, cell_->chunks[axis], cloud_.cell_points());
  }
  output_ = output;
  std::fill(output.hits.begin(), output.hits.end(), 0);
  std::fill(output.first_poses.begin(), output.first_poses.end(), kNoPose);
  std::fill(output.clearances.begin(), output.clearances.end(), Clearance{});
  if (!output.clearances.empty()) clearance_search_.emplace(filter_);
  const std::span nodes(page.nodes(*cell_), cell_->node_count);
  poses_ = pose_count(filter_.motion(), nodes);
  search_blocks(0, static_cast<std::uint32_t>(divide_up(cell_->count, kBlockPoints)), nodes, 0);
}

template <typename Element>
SweepStatistics CellSearchOf<Element>::take_statistics() {
  return std::exchange(statistics_, {});
}

template <typename Element>
std::uint64_t CellSearchOf<Element>::most_bytes(const PackedCloud& cloud, const Query& query,
                                                std::uint64_t most_poses) {
  const auto depths = static_cast<std::uint64_t>(std::bit_width(cloud.blocks_per_cell())) + 1;
  // A list for clearances may have grown to twice the size it needs.
  const std::uint64_t of_clearance = query.clearance > 0 ? 8 * most_poses : 0;
  return sizeof(CellSearchOf) +
         depths * (sizeof(std::vector<std::uint32_t>) + most_poses * sizeof(std::uint32_t)) +
         of_clearance + BlockDescentOf<Element>::most_bytes(most_poses);
}

template <typename Element>
QuantumBox CellSearchOf<Element>::box_of(std::uint32_t first, std::uint32_t count) const {
  QuantumBox box = decode_block_box(cell_->box, blocks_[first]);
  for (std::uint32_t i = first + 1; i < first + count; ++i) {
    box = box.united(decode_block_box(cell_->box, blocks_[i]));
  }
  return box;
}

/// Whether any point of `count` blocks from `first` on is to be searched.
template <typename Element>
bool CellSearchOf<Element>::has_points(std::uint32_t first, std::uint32_t count) const {
  if (!page_.shape.masked) return true;
  for (std::uint32_t block = first; block < first + count; ++block) {
    if (page_.searched(index_, block) != 0) return true;
  }
  return false;
}

template <typename Element>
void CellSearchOf<Element>::search_blocks(std::uint32_t first, std::uint32_t count,
                                          std::span<const std::uint32_t> nodes, std::size_t depth) {
  if (!has_points(first, count)) return;
  if (depth == lists_.size()) lists_.emplace_back();
  std::vector<std::uint32_t> open = std::move(lists_[depth]);
  open.clear();
  open.reserve(poses_);  // disjoint nodes are at most as many as their poses
  if (filter_.narrow(position_box(cloud_.quantisation(), box_of(first, count)), nodes, open,
                     statistics_)) {
    for (std::uint32_t block = first; block < first + count; ++block) mark_all(block);
  } else if (!open.empty()) {
    if (count == 1) {
      search_points(first, open);
    } else {
      const auto left = static_cast<std::uint32_t>(left_count(count, 1));
      search_blocks(first, left, open, depth + 1);
      search_blocks(first + left, count - left, open, depth + 1);
    }
  }
  lists_[depth] = std::move(open);
}

template <typename Element>
void CellSearchOf<Element>::mark_all(std::uint32_t block) {
  output_.hits[block] = page_.searched(index_, block);
}

template <typename Element>
void CellSearchOf<Element>::search_points(std::uint32_t block,
                                          std::span<const std::uint32_t> nodes) {
  const std::uint32_t begin = block * kBlockPoints;
  const std::uint32_t count = std::min(kBlockPoints, cell_->count - begin);
  if (clearance_search_) {
    joined_.assign(nodes.begin(), nodes.end());
    const auto joined_count = static_cast<std::uint32_t>(nodes.size());
    joined_.resize(filter_.ref().motion.join_smooth(joined_.data(), joined_count));
  }
  BlockPositions& points = descent_.points();
  points.decode(chunks_, cloud_.quantisation(), begin, count);
  const std::uint64_t searched = page_.searched(index_, block);
  const Query& query = filter_.query();
  const bool hits_follow = clearance_search_ && filter_.ref().hits_follow_from_clearance();
  std::uint64_t hits = 0;
  if (query.first_pose) {
    hits =
        descent_.find_first_poses(searched, nodes, output_.first_poses.subspan(begin), statistics_);
  } else if (!hits_follow) {
    hits = descent_.touches(searched, nodes, statistics_);
  }
  if (clearance_search_) {
    // Every point within a clearance of at most the radius collides.
    const bool all = hits_follow || query.clearance > query.radius;
    for_each_bit(all ? searched : hits, [&](std::uint32_t i) {
      const bool hit = search_clearance(points.point(i), begin + i);
      if (hits_follow) hits |= std::uint64_t{hit} << i;
    });
  }
  output_.hits[block] |= hits;
}

/// Searches the clearance of the point. Returns whether its least d2 makes it collide.
template <typename Element>
bool CellSearchOf<Element>::search_clearance(const Vec3& e, std::uint32_t index) {
  const Clearance clearance = clearance_search_->nearest(e, joined_, statistics_);
  output_.clearances[index] = clearance;
  const double radius = filter_.query().radius;
  return clearance.squared < rounded_product(radius, radius);
}

template class CellSearchOf<Vec3>;
template class CellSearchOf<Triangle>;
template class CellSearchOf<SolidTriangle>;

std::uint64_t pose_count(const MotionTree& motion, std::span<const std::uint32_t> nodes) {
  std::uint64_t poses = 0;
  for (const std::uint32_t node : nodes) poses += motion.nodes()[node].count;
  return poses;
}

}  // namespace clearway
