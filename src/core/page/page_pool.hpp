#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/util/array_run.hpp"

namespace clearway {

/// The parts of a page's result besides the colliding points.
struct ResultParts {
  bool first_pose, clearance;
  bool profile = false;           ///< whether there are facts of a profile, as a device lists them
  std::uint64_t facts_ahead = 0;  ///< room for facts of a profile beyond one for each block
};
inline constexpr ResultParts kNoParts{.first_pose = false, .clearance = false};

/// The arrays of a PageResult for a number of blocks in a run of bytes. Arrays not asked for are
/// empty.
struct PageResultArrays {
  PageResultArrays(ArrayRun& run, std::uint64_t blocks, const ResultParts& parts)
      : hits(run.add<std::uint64_t>(blocks)),
        clearances(run.add<Clearance>(parts.clearance ? blocks * kBlockPoints : 0)),
        first_poses(run.add<std::uint32_t>(parts.first_pose ? blocks * kBlockPoints : 0)),
        facts(run.add<ProfileFact>(parts.profile ? blocks + parts.facts_ahead : 0)),
        fact_counts(run.add<ProfileCounts>(parts.profile ? 1 : 0)) {}

  /// The result in the first `blocks` blocks of the arrays, whose run begins at `begin`.
  PageResult in(const std::byte* begin, std::size_t blocks) const {
    const auto first = [](auto values, std::size_t count) {
      return values.empty() ? values : values.first(count);
    };
    return {.hits = first(hits.in(begin), blocks),
            .first_poses = first(first_poses.in(begin), blocks * kBlockPoints),
            .clearances = first(clearances.in(begin), blocks * kBlockPoints)};
  }

  ArrayPlace<std::uint64_t> hits;
  ArrayPlace<Clearance> clearances;
  ArrayPlace<std::uint32_t> first_poses;
  ArrayPlace<ProfileFact> facts;
  ArrayPlace<ProfileCounts> fact_counts;
};

/// The number of pages that an engine holds at a time, and the limits of their sizes.
struct SlotLayout {
  std::uint32_t slots = 1;
  std::uint64_t page_bytes = 0;  ///< size of a page, rounded up to kPageAlignment
  std::uint32_t cells = 1;       ///< greatest number of cells of a page
  /// Size of a page without coordinates, which lie in the page of another engine; 0: not known
  std::uint64_t header_bytes = 0;
};

/// Host memory for the pages and answers of a fixed number of slots, allocated at once.
class PagePool {
 public:
  PagePool(const PackedCloud& cloud, const Query& query, const SlotLayout& layout);

  const SlotLayout& layout() const { return layout_; }
  std::span<std::byte> page(std::uint32_t slot);

  /// Memory for the answers of a slot's page, as PageResult describes them, for its largest number
  /// of cells. First poses and clearances are empty unless asked for.
  std::span<std::uint64_t> hits(std::uint32_t slot);
  std::span<std::uint32_t> first_poses(std::uint32_t slot);
  std::span<Clearance> clearances(std::uint32_t slot);

  /// The answers in a slot, for a page of `cells` cells.
  PageResult result(std::uint32_t slot, std::uint32_t cells);

  /// Memory of one slot, bytes.
  static std::uint64_t slot_bytes(const PackedCloud& cloud, const Query& query,
                                  const SlotLayout& layout);

 private:
  /// The arrays of one slot. A result's bytes are a multiple of 8, so that the results of all slots
  /// are aligned.
  struct Arrays {
    Arrays(const PackedCloud& cloud, const Query& query, const SlotLayout& layout);
    std::uint64_t page_bytes;
    ArrayRun run;
    PageResultArrays result;
  };

  std::byte* result_at(std::uint32_t slot) { return results_.get() + slot * arrays_.run.bytes(); }

  SlotLayout layout_;
  std::uint32_t blocks_per_cell_;
  Arrays arrays_;
  std::unique_ptr<std::byte[]> pages_, results_;
};

}  // namespace clearway
