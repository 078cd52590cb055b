#include "support/page_stage.hpp"

#include <algorithm>
#include <cstring>
#include <deque>
#include <utility>

namespace clearway {
namespace {

std::array<std::vector<std::byte>, 3> packed_again(const PackedCloud& cloud, std::uint32_t cell) {
  std::array<std::vector<std::byte>, 3> chunks;
  const auto packed = cloud.coordinates(cell);
  std::vector<std::int32_t> values(cloud.cell_points());
  for (std::size_t k = 0; k < 3; ++k) {
    packed[k].decode(0, values);
    append_packed_chunk<std::int32_t>(values, chunks[k]);
  }
  return chunks;
}

void collect(const PackedCloud& cloud, std::span<const PlannedCell> cells, const PageAnswer& answer,
             HitSet& all) {
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::uint64_t word = std::uint64_t{cells[c].cell} * cloud.blocks_per_cell();
    for (std::uint32_t b = 0; b < cloud.blocks_per_cell(); ++b) {
      all.mark_word(word + b, answer.hits[c * cloud.blocks_per_cell() + b]);
    }
    for (std::uint32_t i = 0; i < cloud.cell_slots() && all.has_first_pose(); ++i) {
      const std::uint32_t pose = answer.first_poses[c * cloud.cell_slots() + i];
      if (pose != HitSet::kNever) all.mark(word * kBlockPoints + i, pose);
    }
  }
}

}  // namespace

PageShape shape_of(const PackedCloud& cloud, std::span<const PlannedCell> cells) {
  PageShape shape{.cells = static_cast<std::uint32_t>(cells.size()),
                  .blocks_per_cell = cloud.blocks_per_cell()};
  for (const PlannedCell& cell : cells) {
    shape.nodes += static_cast<std::uint32_t>(cell.nodes.size());
    for (const auto& chunk : packed_again(cloud, cell.cell)) {
      shape.payload_bytes += chunk.size() - kPackedHeaderBytes;
    }
  }
  return shape;
}

PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> bytes) {
  const PageShape shape = shape_of(cloud, cells);
  std::memset(bytes.data(), 0, shape.bytes());
  std::uint64_t payload = shape.payload_at();
  std::uint32_t node = 0;
  for (std::uint32_t c = 0; c < shape.cells; ++c) {
    const Cell& cell = cloud.cells()[cells[c].cell];
    PageCell stored{.cell = cells[c].cell,
                    .count = cell.count,
                    .first_node = node,
                    .node_count = static_cast<std::uint32_t>(cells[c].nodes.size()),
                    .box = cell.box,
                    .chunks = {}};
    std::memcpy(bytes.data() + shape.nodes_at() + 4 * std::uint64_t{node}, cells[c].nodes.data(),
                4 * cells[c].nodes.size());
    node += stored.node_count;
    std::memcpy(bytes.data() + shape.blocks_at() +
                    std::uint64_t{c} * shape.blocks_per_cell * sizeof(BlockBox),
                &cloud.blocks()[std::size_t{cells[c].cell} * shape.blocks_per_cell],
                shape.blocks_per_cell * sizeof(BlockBox));
    const auto chunks = packed_again(cloud, cells[c].cell);
    for (int k = 0; k < 3; ++k) {
      const PackedChunk<std::int32_t> chunk(chunks[k], cloud.cell_points());
      stored.chunks[k] = {payload, chunk.minimum(), chunk.minbits()};
      const std::size_t size = chunks[k].size() - kPackedHeaderBytes;
      std::memcpy(bytes.data() + payload, chunks[k].data() + kPackedHeaderBytes, size);
      payload += size;
    }
    std::memcpy(bytes.data() + c * sizeof(PageCell), &stored, sizeof(stored));
  }
  return shape;
}

HitSet run_page_engine(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::size_t cells_a_page, bool first_pose, PageEngine& engine) {
  HitSet all(cloud.slot_count(), first_pose);
  std::deque<std::pair<std::uint32_t, std::span<const PlannedCell>>> in_flight;
  const auto finish_oldest = [&] {
    const auto [slot, page] = in_flight.front();
    in_flight.pop_front();
    collect(cloud, page, engine.finish(slot), all);
    return slot;
  };
  std::uint32_t next = 0;
  for (std::size_t first = 0; first < cells.size(); first += cells_a_page) {
    const auto page = cells.subspan(first, std::min(cells_a_page, cells.size() - first));
    const std::uint32_t slot = next < engine.slots() ? next++ : finish_oldest();
    engine.start(slot, stage_page(cloud, page, engine.page(slot)));
    in_flight.emplace_back(slot, page);
  }
  while (!in_flight.empty()) finish_oldest();
  return all;
}

}  // namespace clearway
