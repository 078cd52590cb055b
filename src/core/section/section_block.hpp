#pragma once

#include <cstdint>

#include "core/page/page.hpp"
#include "core/section/section_ref.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/warp.hpp"

namespace clearway {

/// A page of a search for a section. The nodes of its cells are those of bins_in_reach().
struct SectionPage {
  SectionRef section;
  PageRef page;
  Quantisation quantisation;

  /// Number of blocks of points of the page, used or not.
  CLEARWAY_HD std::uint32_t block_count() const {
    return page.shape.cells * page.shape.blocks_per_cell;
  }
};

/// The search of a block of points by a warp: each lane has two points. The whole block is compared
/// with up to 32 bins at a time, one in each lane, and the points go down the trees of those bins
/// that are left. They go together: the warp always takes the first node at which any of its points
/// is, so that all lanes read the same node, earlier poses first.
template <typename Warp>
class SectionBlock {
 public:
  /// number: of the block in the page.
  CLEARWAY_HD SectionBlock(const SectionPage& page, std::uint32_t number)
      : page_(page),
        index_(number / page.page.shape.blocks_per_cell),
        block_(number % page.page.shape.blocks_per_cell),
        searched_(page.page.searched(index_, block_)) {}

  CLEARWAY_HD void search() {
    if (searched_ == 0) return;
    const PageCell& cell = page_.page.cell(index_);
    const std::uint32_t* const bins = page_.page.nodes(cell);
    const Box box = position_box(page_.quantisation,
                                 decode_block_box(cell.box, page_.page.blocks(index_)[block_]));
    bool is_read = false;
    for (std::uint32_t first = 0; first < cell.node_count; first += kWarpLanes) {
      std::uint32_t reached = Warp::ballot([&](std::uint32_t lane) {
        return first + lane < cell.node_count &&
               page_.section.may_block(page_.section.nodes[bins[first + lane]], box);
      });
      if (reached != 0 && !is_read) read(cell);
      is_read = is_read || reached != 0;
      for (; reached != 0; reached &= reached - 1) descend(bins[first + lowest_bit(reached)]);
    }
  }

 private:
  using Places = typename Warp::template PerLane<Vec3>;
  using Nodes = typename Warp::template PerLane<std::uint32_t>;

  CLEARWAY_HD void read(const PageCell& cell) {
    Warp::each([&](std::uint32_t lane) {
      read(cell, lane, low_[lane]);
      read(cell, lane + kWarpLanes, high_[lane]);
    });
  }
  CLEARWAY_HD void read(const PageCell& cell, std::uint32_t i, Vec3& point) const {
    if (!is_searched(i)) return;
    point = page_.page.position(page_.quantisation, cell, block_ * kBlockPoints + i);
  }

  /// Whether point `i` of the block counts.
  CLEARWAY_HD bool is_searched(std::uint32_t i) const { return (searched_ >> i & 1) != 0; }

  /// Takes all points down the tree of a bin.
  CLEARWAY_HD void descend(std::uint32_t root) {
    const std::uint32_t end = page_.section.nodes[root].end;
    Nodes low, high;  // the nodes at which the points go on
    Warp::each([&](std::uint32_t lane) {
      low[lane] = is_searched(lane) ? root : end;
      high[lane] = is_searched(lane + kWarpLanes) ? root : end;
    });
    for (std::uint32_t at = root; at < end;) {
      Nodes nearest;
      Warp::each([&](std::uint32_t lane) {
        if (low[lane] == at) low[lane] = page_.section.step(at, low_[lane]);
        if (high[lane] == at) high[lane] = page_.section.step(at, high_[lane]);
        nearest[lane] = low[lane] < high[lane] ? low[lane] : high[lane];
      });
      at = Warp::least(nearest);
    }
  }

  const SectionPage& page_;
  const std::uint32_t index_, block_;  ///< of the cell in the page, and of the block in the cell
  const std::uint64_t searched_;       ///< the points that count, as bits
  Places low_, high_;                  ///< points 0 to 31, and 32 to 63
};

}  // namespace clearway
