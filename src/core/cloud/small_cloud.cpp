#include "core/cloud/small_cloud.hpp"

#include <algorithm>
#include <cstring>

namespace clearway {
namespace {

template <typename Points>
QuantumBox quantum_box_of(const Points& points) {
  QuantumBox box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = box.hi[k] = points[0].q[k];
    for (const auto& p : points) {
      box.lo[k] = std::min(box.lo[k], p.q[k]);
      box.hi[k] = std::max(box.hi[k], p.q[k]);
    }
  }
  return box;
}

int longest_axis_of(const QuantumBox& box) {
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    const auto side = [&](int axis) { return std::int64_t{box.hi[axis]} - box.lo[axis]; };
    if (side(k) > side(longest)) longest = k;
  }
  return longest;
}

/// Orders `points`, more than `unit` of them, so that each split of the store divides them.
template <typename Points>
void order_by_splits(Points points, std::uint64_t unit) {
  if (points.size() <= unit) return;
  const int axis = longest_axis_of(quantum_box_of(points));
  const std::uint64_t left = left_count(points.size(), unit);
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(left), points.end(),
                   [axis](const auto& a, const auto& b) {
                     return a.q[axis] != b.q[axis] ? a.q[axis] < b.q[axis] : a.source < b.source;
                   });
  order_by_splits(points.first(left), unit);
  order_by_splits(points.subspan(left), unit);
}

}  // namespace

SmallCloud::SmallCloud(std::span<const Quantum> points, const Quantisation& quantisation,
                       const Packing& packing)
    : quantisation_(quantisation), point_count_(points.size()), cell_points_(packing.cell_points) {
  std::vector<Point> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) order.push_back({points[i], i});
  if (!order.empty()) {
    add_top(order, packing.bucket_points == 0 ? order.size() : packing.bucket_points);
  }
  tree_ = build_cell_tree(top_, cells_);
}

/// Adds the nodes of the top tree. It splits by planes in the middle of the longest side, so that
/// the cells of many buckets are short.
void SmallCloud::add_top(std::span<Point> points, std::uint64_t bucket_points) {
  const std::size_t self = top_.size();
  top_.push_back({static_cast<std::uint32_t>(cells_.size()), 0, 0});
  const QuantumBox box = quantum_box_of(points);
  const int axis = longest_axis_of(box);
  if (points.size() <= bucket_points || box.lo[axis] == box.hi[axis]) {
    add_cells(points);
  } else {
    const std::int64_t middle =
        box.lo[axis] + (std::int64_t{box.hi[axis]} - box.lo[axis] + 1) / 2;  // above lo
    const auto plane = std::stable_partition(points.begin(), points.end(),
                                             [&](const Point& p) { return p.q[axis] < middle; });
    const auto left = static_cast<std::size_t>(plane - points.begin());
    add_top(points.first(left), bucket_points);
    top_[self].right = static_cast<std::uint32_t>(top_.size());
    add_top(points.subspan(left), bucket_points);
  }
  top_[self].cell_count = static_cast<std::uint32_t>(cells_.size()) - top_[self].first_cell;
}

void SmallCloud::add_cells(std::span<Point> points) {
  order_by_splits(points, cell_points_);
  for (std::size_t first = 0; first < points.size(); first += cell_points_) {
    const auto count = std::min<std::size_t>(cell_points_, points.size() - first);
    add_cell(points.subspan(first, count));
  }
}

void SmallCloud::add_cell(std::span<Point> points) {
  order_by_splits(points, kBlockPoints);
  const QuantumBox box = quantum_box_of(points);
  cells_.push_back({static_cast<std::uint32_t>(points.size()), box});

  blocks_.resize(cells_.size() * blocks_per_cell());
  const std::size_t first_block = (cells_.size() - 1) * blocks_per_cell();
  for (std::size_t first = 0; first < points.size(); first += kBlockPoints) {
    const auto count = std::min<std::size_t>(kBlockPoints, points.size() - first);
    blocks_[first_block + first / kBlockPoints] =
        encode_block_box(box, quantum_box_of(points.subspan(first, count)));
  }

  sources_.resize(cells_.size() * cell_entries());
  const std::size_t first_entry = (cells_.size() - 1) * cell_entries();
  for (std::size_t i = 0; i < points.size(); ++i) sources_[first_entry + i] = points[i].source;

  auto& chunks = chunks_.emplace_back();
  std::vector<std::int32_t> values(cell_points_);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = points[std::min(i, points.size() - 1)].q[axis];
    }
    append_packed_chunk<std::int32_t>(values, chunks[axis]);
    chunks[axis].resize(chunks[axis].size() + kPagePadding);
  }
}

std::array<PackedChunk<std::int32_t>, 3> SmallCloud::coordinates(std::uint32_t cell) const {
  return {PackedChunk<std::int32_t>(packed(cell, 0), cell_points_),
          PackedChunk<std::int32_t>(packed(cell, 1), cell_points_),
          PackedChunk<std::int32_t>(packed(cell, 2), cell_points_)};
}

std::uint64_t SmallCloud::packed_bytes(std::uint32_t cell) const {
  return packed(cell, 0).size() + packed(cell, 1).size() + packed(cell, 2).size();
}

std::array<PackedChunk<std::int32_t>, 3> SmallCloud::read_packed(std::uint32_t cell,
                                                                 std::span<std::byte> to) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::span<const std::byte> bytes = packed(cell, axis);
    std::memcpy(to.data(), bytes.data(), bytes.size());
    chunks[axis] = {to.first(bytes.size()), cell_points_};
    to = to.subspan(bytes.size());
  }
  return chunks;
}

}  // namespace clearway
