#include "cpu/nearest_free.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/lane_bits.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kLanes = 8;

/// Sets d2[i] to the predicate's squared distance of place i to p, and returns the least of them.
/// count: a multiple of kLanes, above 0.
CLEARWAY_SIMD_CLONES
double squared_distances(const double* x, const double* y, const double* z, std::uint32_t count,
                         double px, double py, double pz, double* d2) {
  double least[kLanes];
  for (double& lane : least) lane = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < count; i += kLanes) {
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const double dx = x[i + k] - px, dy = y[i + k] - py, dz = z[i + k] - pz;
      const double d = (dx * dx + dy * dy) + dz * dz;
      d2[i + k] = d;
      least[k] = d < least[k] ? d : least[k];
    }
  }
  return *std::min_element(least, least + kLanes);
}

/// The points of a block that exist: bit i is set for point i.
std::uint64_t all_points(const EnvironmentTree& tree, std::uint32_t cell, std::uint32_t block) {
  return ~std::uint64_t{0} >> (kBlockPoints - tree.points_in_block(cell, block));
}

/// Coordinates of a block.
struct BlockPlaces {
  std::int32_t q[3][kBlockPoints];

  BlockPlaces(const EnvironmentTree& tree, std::uint32_t cell, std::uint32_t block) {
    const std::uint32_t count = tree.points_in_block(cell, block);
    const auto chunks = tree.cloud().coordinates_of_block(cell);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      chunks[axis].decode(block * kBlockPoints, {q[axis], count});
    }
  }
  Vec3 at(const Quantisation& quantisation, std::uint32_t i) const {
    return position(quantisation, q[0][i], q[1][i], q[2][i]);
  }
};

}  // namespace

FreePoints::FreePoints(const EnvironmentTree& tree, std::span<const std::uint32_t> cells)
    : tree_(tree),
      places_(tree.cloud().cells().size(), kAll),
      words_(cells.size() * tree.cloud().blocks_per_cell()),
      inner_(words_.size()),
      top_(tree.cloud().tree().size()) {
  for (std::uint32_t i = 0; i < cells.size(); ++i) places_[cells[i]] = i;
}

void FreePoints::add_cell(std::uint32_t cell, std::span<const std::uint64_t> taken,
                          const IgnoredPoints& ignored) {
  const PackedCloud& cloud = tree_.cloud();
  const std::span words = std::span(words_).subspan(first_word(cell), cloud.blocks_per_cell());
  const EnvironmentNode node = tree_.cell(cell);
  if (ignored.any() && ignored.touches(cell)) {
    ignored.mask(cell, words, [&] { return cloud.peek(cell); });
  } else {
    for (std::uint32_t i = 0; i < node.block_count; ++i) words[i] = all_points(tree_, cell, i);
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(taken.size(), node.block_count); ++i) {
    words[i] &= ~taken[i];
  }
  mark(node);
}

/// Notes of the inner nodes of a cell whether they have a free point, and returns it of this one.
bool FreePoints::mark(const EnvironmentNode& node) {
  if (node.is_block()) return word(node.cell, node.first_block) != 0;
  const auto [left, right] = tree_.children(node);
  const bool in_left = mark(left), in_right = mark(right);
  inner_[inner_place(node)] = in_left || in_right ? 1 : 0;
  return in_left || in_right;
}

void FreePoints::finish() {
  const std::span<const TreeNode> nodes = tree_.cloud().tree();
  const auto any_below = [&](std::size_t i) {
    return nodes[i].right == 0 ? any(tree_.cell(nodes[i].first_cell)) : top_[i] != 0;
  };
  // From the last to the first, because children come after their parents
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (nodes[i].right == 0) continue;
    top_[i] = any_below(i + 1) || any_below(nodes[i].right) ? 1 : 0;
  }
}

NearestFree::NearestFree(const EnvironmentTree& tree, const FreePoints& free)
    : tree_(tree),
      cloud_(tree.cloud()),
      free_(free),
      kept_(std::make_unique<std::array<FreeBlock, kKept>>()),
      boxes_(kKeptCells * cloud_.blocks_per_cell()) {
  box_cells_.fill(EnvironmentNode::kInCell);
}

/// The box of a node, from the boxes of its cell, which are made where they are not kept.
Box NearestFree::box_of(const EnvironmentNode& node) {
  if (node.top != EnvironmentNode::kInCell || node.is_block()) return tree_.box(node, {});
  const std::size_t place = node.cell % kKeptCells;
  const std::span inner =
      std::span(boxes_).subspan(place * cloud_.blocks_per_cell(), cloud_.blocks_per_cell());
  if (box_cells_[place] != node.cell) {
    tree_.fill_inner_boxes(node.cell, inner);
    box_cells_[place] = node.cell;
  }
  return tree_.box(node, inner);
}

void NearestFree::search(std::uint32_t cell, std::uint32_t block, std::uint64_t points,
                         std::span<Depth, kBlockPoints> found) {
  ask(cell, block, points);
  Box around{asked_.front().place, asked_.front().place};
  for (const Asked& asked : asked_) around.extend(asked.place);
  const auto is_farther = [](const Open& a, const Open& b) { return a.squared > b.squared; };
  open_.clear();
  if (free_.any(tree_.root())) open_.push_back({0, tree_.root()});
  while (!open_.empty()) {
    std::ranges::pop_heap(open_, is_farther);
    const Open nearest = open_.back();
    open_.pop_back();
    double farthest = 0;  // of the nearest points so far
    for (const Asked& asked : asked_) farthest = std::max(farthest, asked.squared);
    // At equal distances the smallest source decides, so that such nodes have to be searched.
    if (nearest.squared > farthest) break;
    if (nearest.node.is_block()) {
      visit(nearest.node, box_of(nearest.node));
      continue;
    }
    for (const EnvironmentNode& child : tree_.children(nearest.node)) {
      if (!free_.any(child)) continue;
      const double squared = least_squared_distance(box_of(child), around);
      if (squared > farthest) continue;
      open_.push_back({squared, child});
      std::ranges::push_heap(open_, is_farther);
    }
  }
  for (const Asked& asked : asked_) {
    Depth& depth = found[asked.point];
    depth = {};
    if (asked.entry == kNone) continue;
    depth.distance = std::sqrt(asked.squared);
    depth.source = asked.source != kNone ? asked.source : source_of(asked.entry);
  }
}

void NearestFree::ask(std::uint32_t cell, std::uint32_t block, std::uint64_t points) {
  const BlockPlaces places(tree_, cell, block);
  asked_.clear();
  for_each_bit(points, [&](std::uint32_t i) {
    asked_.push_back({.place = places.at(cloud_.quantisation(), i), .point = i});
  });
}

/// Compares the free points of a block with all points that are asked for.
void NearestFree::visit(const EnvironmentNode& block, const Box& box) {
  const FreeBlock& free = free_block(block.cell, block.first_block);
  const std::uint64_t first = free.index * kBlockPoints;
  const auto padded = static_cast<std::uint32_t>(divide_up(free.count, kLanes) * kLanes);
  double squared[kBlockPoints];
  for (Asked& asked : asked_) {
    const Vec3& p = asked.place;
    if (least_squared_distance(box, p) > asked.squared) continue;
    const double least = squared_distances(free.x, free.y, free.z, padded, p.x, p.y, p.z, squared);
    if (least > asked.squared) continue;
    if (least < asked.squared) {
      asked.squared = least;
      asked.entry = asked.source = kNone;
    }
    for (std::uint32_t i = 0; i < free.count; ++i) {
      if (squared[i] == least) offer(asked, first + free.point[i]);
    }
  }
}

/// Takes a free point that is as near as the nearest one so far.
void NearestFree::offer(Asked& asked, std::uint64_t entry) const {
  if (asked.entry == kNone) {
    asked.entry = entry;
    return;
  }
  if (asked.source == kNone) asked.source = source_of(asked.entry);
  const std::uint64_t source = source_of(entry);
  if (source >= asked.source) return;
  asked.entry = entry;
  asked.source = source;
}

const NearestFree::FreeBlock& NearestFree::free_block(std::uint32_t cell, std::uint32_t block) {
  const std::uint64_t index = tree_.block_index(cell, block);
  FreeBlock& kept = (*kept_)[index % kKept];
  if (kept.index == index) return kept;
  kept.index = kNone;  // in case that the cell is damaged
  const BlockPlaces places(tree_, cell, block);
  std::uint32_t count = 0;
  for_each_bit(free_.word(cell, block), [&](std::uint32_t i) {
    const Vec3 place = places.at(cloud_.quantisation(), i);
    kept.x[count] = place.x;
    kept.y[count] = place.y;
    kept.z[count] = place.z;
    kept.point[count++] = static_cast<std::uint8_t>(i);
  });
  kept.count = count;
  for (; count % kLanes != 0; ++count) {
    kept.x[count] = kept.y[count] = kept.z[count] = std::numeric_limits<double>::infinity();
  }
  kept.index = index;
  return kept;
}

std::uint64_t NearestFree::source_of(std::uint64_t entry) const {
  return cloud_.source_of(static_cast<std::uint32_t>(entry / cloud_.cell_entries()),
                          static_cast<std::uint32_t>(entry % cloud_.cell_entries()));
}

}  // namespace clearway
