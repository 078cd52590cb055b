#include "io/store/convert/pack_unit.hpp"

#include <algorithm>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/store/convert/quantum_bounds.hpp"
#include "io/store/convert/select_split.hpp"

namespace clearway {
namespace {

/// The points of a unit, both as loaded (in source order) and in k-d order.
class Unit {
 public:
  Unit(Distribution& distribution, std::size_t unit, const OriginTable* origins,
       UnitBuffers& buffers, StageClocks& clocks)
      : buffers_(buffers) {
    const auto running = clocks.measure(Stage::kLoad);
    loaded_ = distribution.take(unit);
    points_ = buffers.take();
    const std::span<const DistributedPoint> loaded = loaded_.span();
    for (std::size_t i = 0; i < loaded.size(); ++i) {
      const auto& q = loaded[i].q;
      points_[i] = {{q[0], q[1], q[2]}, static_cast<std::uint32_t>(i)};
    }
    if (origins != nullptr) origins_ = origins->numbers_of(loaded_.span());
  }

  ~Unit() { buffers_.give_back(std::move(points_)); }
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;

  std::uint64_t source(const BucketPoint& p) const {
    return loaded_.span()[p.index].source_index();
  }
  std::uint8_t point_class(const BucketPoint& p) const {
    return loaded_.span()[p.index].point_class();
  }
  bool has_origins() const { return !origins_.empty(); }
  std::uint32_t origin(const BucketPoint& p) const { return origins_[p.index]; }
  std::span<BucketPoint> points() { return {points_.get(), loaded_.span().size()}; }

 private:
  UnitBuffers& buffers_;
  UnitPoints loaded_;
  UnitBuffers::Buffer points_;
  std::vector<std::uint32_t> origins_;  // number of each loaded point's origin; empty without any
};

QuantumBox box_of(std::span<const BucketPoint> points) {
  QuantumBounds bounds;
  bounds.extend(points);
  return {{bounds.lo[0], bounds.lo[1], bounds.lo[2]}, {bounds.hi[0], bounds.hi[1], bounds.hi[2]}};
}

/// Finds the box of a cell and those of its blocks.
std::vector<BlockBox> find_boxes(std::span<const BucketPoint> points, Cell& cell) {
  std::vector<QuantumBox> boxes;
  boxes.reserve(divide_up(points.size(), kBlockPoints));
  for (std::size_t first = 0; first < points.size(); first += kBlockPoints) {
    boxes.push_back(
        box_of(points.subspan(first, std::min<std::size_t>(kBlockPoints, points.size() - first))));
  }
  QuantumBox all = boxes.front();
  for (const QuantumBox& box : boxes) all = all.united(box);
  cell = {static_cast<std::uint32_t>(points.size()), all};
  std::vector<BlockBox> blocks;
  blocks.reserve(boxes.size());
  for (const QuantumBox& box : boxes) blocks.push_back(encode_block_box(all, box));
  return blocks;
}

/// Packs a value of each point as the store keeps them. The padding repeats the value of the last
/// point.
template <typename ValueOf>
void pack_values(std::span<const BucketPoint> points, std::uint32_t cell_points, ValueOf value_of,
                 std::vector<std::byte>& out) {
  using Value = decltype(value_of(points.back()));
  std::vector<Value> values(cell_points, value_of(points.back()));
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = value_of(points[i]);
  append_packed_chunk<Value>(values, out);
}

PackedCell pack_cell(const Unit& unit, std::span<const BucketPoint> points,
                     std::uint32_t cell_points, bool has_classes) {
  PackedCell cell;
  const std::vector<BlockBox> blocks = find_boxes(points, cell.cell);
  const auto pack = [&](auto value_of, std::vector<std::byte>& out) {
    pack_values(points, cell_points, value_of, out);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pack([axis](const BucketPoint& p) { return p.q[axis]; }, cell.chunks[axis]);
  }
  pack([&](const BucketPoint& p) { return unit.source(p); }, cell.chunks[kSource]);
  if (has_classes) {
    pack([&](const BucketPoint& p) { return unit.point_class(p); }, cell.chunks[kClass]);
  }
  if (unit.has_origins()) {
    pack([&](const BucketPoint& p) { return unit.origin(p); }, cell.chunks[kOrigin]);
  }
  seal_cell(cell, blocks, cell_points);
  return cell;
}

/// Divides the points below a node by the planes of the tree, and appends its buckets.
void add_buckets(const Unit& unit, const SplitTree& tree, const Lattice& lattice,
                 std::uint32_t node, std::span<BucketPoint> points,
                 std::vector<std::span<BucketPoint>>& buckets) {
  const SplitNode& split = tree.nodes()[node];
  if (split.right == 0) {
    buckets.push_back(points);
    return;
  }
  const auto middle =
      std::stable_partition(points.begin(), points.end(), [&](const BucketPoint& p) {
        const LatticePoint at = lattice({p.q[0], p.q[1], p.q[2]}, unit.source(p));
        return at[static_cast<std::size_t>(split.axis)] < split.plane;
      });
  const auto left = static_cast<std::size_t>(middle - points.begin());
  add_buckets(unit, tree, lattice, node + 1, points.first(left), buckets);
  add_buckets(unit, tree, lattice, split.right, points.subspan(left), buckets);
}

}  // namespace

struct OrderedUnit::State {
  StageClocks& clocks;
  Unit unit;
  std::uint32_t cell_points;
  bool has_classes;
  std::vector<std::span<const BucketPoint>> cells;
  std::size_t next = 0;
};

OrderedUnit::OrderedUnit(Distribution& distribution, std::size_t unit, const SplitTree& tree,
                         const Lattice& lattice, const StoreMetadata& metadata,
                         const OriginTable* origins, UnitBuffers& buffers, StageClocks& clocks)
    : state_(new State{clocks,
                       {distribution, unit, origins, buffers, clocks},
                       metadata.cell_points,
                       metadata.classes.has_value(),
                       {}}) {
  const std::uint32_t cell_points = metadata.cell_points;
  Unit& loaded = state_->unit;
  UnitBuffers::Buffer scratch = buffers.take();
  std::vector<std::span<BucketPoint>> buckets;
  add_buckets(loaded, tree, lattice, tree.units()[unit], loaded.points(), buckets);
  for (const std::span<BucketPoint> bucket : buckets) {
    const auto first = static_cast<std::size_t>(bucket.data() - loaded.points().data());
    order_bucket(bucket, {scratch.get() + first, bucket.size()}, cell_points,
                 metadata.quantisation.scale, clocks);
    for (std::size_t at = 0; at < bucket.size(); at += cell_points) {
      state_->cells.emplace_back(
          bucket.subspan(at, std::min<std::size_t>(cell_points, bucket.size() - at)));
    }
  }
  buffers.give_back(std::move(scratch));
}

OrderedUnit::~OrderedUnit() = default;

std::size_t OrderedUnit::cells_left() const { return state_->cells.size() - state_->next; }

std::vector<PackedCell> OrderedUnit::pack_next() {
  State& state = *state_;
  const std::size_t most = std::max<std::size_t>(1, kBucketPoints / state.cell_points);
  const std::size_t first = state.next;
  std::vector<PackedCell> packed(std::min(most, cells_left()));
  for_each_parallel(packed.size(), [&](std::size_t i) {
    const auto running = state.clocks.measure(Stage::kPack);
    packed[i] = pack_cell(state.unit, state.cells[first + i], state.cell_points, state.has_classes);
  });
  state.next += packed.size();
  return packed;
}

}  // namespace clearway
