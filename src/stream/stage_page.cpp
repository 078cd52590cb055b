#include "stream/stage_page.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <vector>

#include "stream/paginate.hpp"

namespace clearway {
namespace {

/// Appends to a section of a page; the destructor fills what is left of the section with zeros.
class Section {
 public:
  Section(std::span<std::byte> page, std::uint64_t begin, std::uint64_t end)
      : left_(page.subspan(begin, end - begin)) {}
  ~Section() { std::fill(left_.begin(), left_.end(), std::byte{0}); }
  Section(const Section&) = delete;
  Section& operator=(const Section&) = delete;

  std::span<std::byte> take(std::uint64_t bytes) {
    const auto taken = left_.first(bytes);
    left_ = left_.subspan(bytes);
    return taken;
  }

  template <typename Value>
  void append(std::span<const Value> values) {
    if (!values.empty()) {
      std::memcpy(take(values.size_bytes()).data(), values.data(), values.size_bytes());
    }
  }

 private:
  std::span<std::byte> left_;
};

}  // namespace

PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page) {
  std::uint64_t none = 0;
  return stage_page(cloud, cells, page, IgnoredPoints(cloud, {}), none);
}

PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page, const IgnoredPoints& ignored,
                     std::uint64_t& ignored_points) {
  const PageShape shape = page_shape(cloud, cells, ignored.any());
  assert(shape.bytes() <= page.size());
  Section headers(page, 0, shape.nodes_at());
  Section nodes(page, shape.nodes_at(), shape.blocks_at());
  Section blocks(page, shape.blocks_at(), shape.masks_at());
  Section masks(page, shape.masks_at(), shape.payload_at());
  Section payload(page, shape.payload_at(), shape.bytes());
  std::uint32_t first_node = 0;
  std::vector<std::uint64_t> searched(shape.masked ? shape.blocks_per_cell : 0);
  for (const PlannedCell& planned : cells) {
    const Cell& cell = cloud.cells()[planned.cell];
    PageCell header{.cell = planned.cell,
                    .count = cell.count,
                    .first_node = first_node,
                    .node_count = static_cast<std::uint32_t>(planned.nodes.size()),
                    .box = cell.box,
                    .chunks = {}};
    first_node += header.node_count;
    const auto packed =
        cloud.read_packed(planned.cell, payload.take(cloud.packed_bytes(planned.cell)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      header.chunks[axis] = {static_cast<std::uint64_t>(packed[axis].payload() - page.data()),
                             packed[axis].minimum(), packed[axis].minbits()};
    }
    headers.append(std::span<const PageCell>(&header, 1));
    nodes.append(std::span(planned.nodes));
    blocks.append(cloud.blocks().subspan(std::size_t{planned.cell} * shape.blocks_per_cell,
                                         shape.blocks_per_cell));
    if (!shape.masked) continue;
    ignored_points += ignored.mask(planned.cell, searched, [&] { return packed; });
    masks.append(std::span<const std::uint64_t>(searched));
  }
  return shape;
}

}  // namespace clearway
