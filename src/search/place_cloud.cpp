#include "search/place_cloud.hpp"

#include <algorithm>
#include <cstring>

namespace clearway {

PlaceCloud::PlaceCloud(std::span<const QuantumPoint> points, const Quantisation& quantisation)
    : point_count_(points.size()), quantisation_(quantisation) {
  std::vector<Point> all;
  all.reserve(points.size());
  for (const QuantumPoint& point : points) {
    all.push_back({{point.q[0], point.q[1], point.q[2]}, all.size()});
  }
  order(all, kCellPoints);
  for (std::size_t first = 0; first < all.size(); first += kCellPoints) {
    add_cell(std::span(all).subspan(first, std::min<std::size_t>(kCellPoints, all.size() - first)));
  }
  const TopNode top{0, static_cast<std::uint32_t>(cells_.size()), 0};
  tree_ = build_cell_tree(std::span(&top, cells_.empty() ? 0 : 1), cells_);
}

QuantumBox PlaceCloud::box_of(std::span<const Point> points) {
  QuantumBox box{};
  std::ranges::copy(points.front().q, box.lo);
  std::ranges::copy(points.front().q, box.hi);
  for (const Point& point : points) box.extend(point.q);
  return box;
}

/// Orders more than `unit` points so that each split of the store's rule divides them.
void PlaceCloud::order(std::span<Point> points, std::uint64_t unit) {
  if (points.size() <= unit) return;
  const QuantumBox box = box_of(points);
  const auto side = [&](int axis) { return std::int64_t{box.hi[axis]} - box.lo[axis]; };
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    if (side(k) > side(longest)) longest = k;
  }
  const std::uint64_t left = left_count(points.size(), unit);
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(left), points.end(),
                   [longest](const Point& a, const Point& b) {
                     return a.q[longest] != b.q[longest] ? a.q[longest] < b.q[longest]
                                                         : a.source < b.source;
                   });
  order(points.first(left), unit);
  order(points.subspan(left), unit);
}

void PlaceCloud::add_cell(std::span<Point> points) {
  order(points, kBlockPoints);
  const QuantumBox box = box_of(points);
  cells_.push_back({static_cast<std::uint32_t>(points.size()), box});
  blocks_.resize(cells_.size() * blocks_per_cell());
  const std::size_t first_block = (cells_.size() - 1) * blocks_per_cell();
  for (std::size_t first = 0; first < points.size(); first += kBlockPoints) {
    const auto count = std::min<std::size_t>(kBlockPoints, points.size() - first);
    blocks_[first_block + first / kBlockPoints] =
        encode_block_box(box, box_of(points.subspan(first, count)));
  }
  sources_.resize(cells_.size() * kCellPoints);
  const std::size_t first_entry = (cells_.size() - 1) * kCellPoints;
  for (std::size_t i = 0; i < points.size(); ++i) sources_[first_entry + i] = points[i].source;
  auto& chunks = chunks_.emplace_back();
  std::vector<std::int32_t> values(kCellPoints);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = points[std::min(i, points.size() - 1)].q[axis];
    }
    append_packed_chunk<std::int32_t>(values, chunks[axis]);
  }
}

std::array<PackedChunk<std::int32_t>, 3> PlaceCloud::coordinates(std::uint32_t cell) const {
  const auto& chunks = chunks_[cell];
  return {PackedChunk<std::int32_t>(chunks[0], kCellPoints),
          PackedChunk<std::int32_t>(chunks[1], kCellPoints),
          PackedChunk<std::int32_t>(chunks[2], kCellPoints)};
}

std::uint64_t PlaceCloud::packed_bytes(std::uint32_t cell) const {
  const auto& chunks = chunks_[cell];
  return chunks[0].size() + chunks[1].size() + chunks[2].size();
}

std::array<PackedChunk<std::int32_t>, 3> PlaceCloud::read_packed(std::uint32_t cell,
                                                                 std::span<std::byte> to) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<std::byte>& bytes = chunks_[cell][axis];
    std::memcpy(to.data(), bytes.data(), bytes.size());
    chunks[axis] = {to.first(bytes.size()), kCellPoints};
    to = to.subspan(bytes.size());
  }
  return chunks;
}

}  // namespace clearway
