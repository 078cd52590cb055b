#include "cpu/sweep_engine.hpp"

#include <algorithm>
#include <optional>

#include "core/clearance_search.hpp"
#include "core/hit_set.hpp"
#include "core/kd_order.hpp"
#include "core/predicate.hpp"

namespace clearway {
namespace {

/// The descent within one cell.
class CellSearch {
 public:
  CellSearch(const PackedCloud& cloud, const SweepFilter& filter, std::uint32_t cell)
      : cloud_(cloud),
        filter_(filter),
        cell_(cloud.cells()[cell]),
        blocks_(cloud.blocks().subspan(std::size_t{cell} * cloud.blocks_per_cell(),
                                       divide_up(cell_.count, kBlockPoints))),
        chunks_(cloud.coordinates(cell)) {
    answer_.cell = cell;
    answer_.hits.resize(cloud.blocks_per_cell());
    if (filter.ref().first_pose) answer_.first_poses.resize(cloud.cell_slots(), HitSet::kNever);
    if (filter.ref().clearance > 0) {
      answer_.clearances.resize(cloud.cell_slots());
      clearance_search_.emplace(filter);
    }
  }

  CellAnswer run(std::span<const std::uint32_t> nodes) {
    search_blocks(0, static_cast<std::uint32_t>(blocks_.size()), nodes, 0);
    return std::move(answer_);
  }

  const SweepStatistics& statistics() const { return statistics_; }

 private:
  QuantumBox box_of(std::uint32_t first, std::uint32_t count) const {
    QuantumBox box = decode_block_box(cell_.box, blocks_[first]);
    for (std::uint32_t i = first + 1; i < first + count; ++i) {
      box = united(box, decode_block_box(cell_.box, blocks_[i]));
    }
    return box;
  }

  void search_blocks(std::uint32_t first, std::uint32_t count, std::span<const std::uint32_t> nodes,
                     std::size_t depth) {
    if (depth == lists_.size()) lists_.emplace_back();
    std::vector<std::uint32_t> open = std::move(lists_[depth]);
    filter_.narrow(position_box(cloud_.quantisation(), box_of(first, count)), nodes, open,
                   statistics_);
    if (!open.empty()) {
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

  void search_points(std::uint32_t block, std::span<const std::uint32_t> nodes) {
    const std::uint32_t begin = block * kBlockPoints;
    const std::uint32_t count = std::min(kBlockPoints, cell_.count - begin);
    std::int32_t q[3][kBlockPoints];
    for (std::size_t k = 0; k < 3; ++k) chunks_[k].decode(begin, std::span(q[k], count));
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 e = position(cloud_.quantisation(), q[0][i], q[1][i], q[2][i]);
      const bool hit = clearance_search_ && filter_.ref().hits_follow_from_clearance()
                           ? search_clearance(e, begin + i, nodes)
                           : search_hit(e, begin + i, nodes);
      answer_.hits[block] |= std::uint64_t{hit} << i;
    }
  }

  /// Whether the point collides.
  bool search_hit(const Vec3& e, std::uint32_t index, std::span<const std::uint32_t> nodes) {
    const SweepRef& question = filter_.ref();
    bool hit = false;
    if (question.first_pose) {
      const std::uint32_t pose = filter_.first_pose(e, nodes, statistics_);
      answer_.first_poses[index] = pose;
      hit = pose != HitSet::kNever;
    } else {
      hit = filter_.touches(e, nodes, statistics_);
    }
    // No point is within a clearance of at most the radius that does not collide.
    if (clearance_search_ && (hit || question.clearance > question.radius)) {
      search_clearance(e, index, nodes);
    }
    return hit;
  }

  /// Whether its least d2 makes the point collide.
  bool search_clearance(const Vec3& e, std::uint32_t index, std::span<const std::uint32_t> nodes) {
    const Clearance clearance = clearance_search_->nearest(e, nodes, statistics_);
    answer_.clearances[index] = clearance;
    const double radius = filter_.ref().radius;
    return clearance.squared < rounded_product(radius, radius);
  }

  const PackedCloud& cloud_;
  const SweepFilter& filter_;
  const Cell& cell_;
  std::span<const BlockBox> blocks_;
  std::array<PackedChunk<std::int32_t>, 3> chunks_;
  std::vector<std::vector<std::uint32_t>> lists_;  ///< of open motion nodes, one a depth
  std::optional<ClearanceSearch> clearance_search_;
  CellAnswer answer_;
  SweepStatistics statistics_;
};

}  // namespace

CellAnswer SweepEngine::search(const PlannedCell& planned) {
  CellSearch search(cloud_, filter_, planned.cell);
  CellAnswer answer = search.run(planned.nodes);
  const std::lock_guard lock(mutex_);
  statistics_.add(search.statistics());
  return answer;
}

}  // namespace clearway
