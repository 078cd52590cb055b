#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "core/query/search_result.hpp"
#include "stream/answer_rows.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// Clearances of a PackedCloud by entry, 12 bytes each; none if it is not below the distance asked
/// for. Different entries may be set at the same time.
class ClearanceSet {
 public:
  ClearanceSet() = default;
  explicit ClearanceSet(std::uint64_t entries) : squared_(entries), poses_(entries) {}

  void set(std::uint64_t entry, const Clearance& clearance) {
    squared_[entry] = std::bit_cast<std::uint64_t>(clearance.squared) ^ kNone;
    poses_[entry] = ~clearance.pose;
  }

  Clearance at(std::uint64_t entry) const {
    return {std::bit_cast<double>(squared_[entry] ^ kNone), ~poses_[entry]};
  }

  /// The entries 64 * index + i that have a clearance, as bits i.
  std::uint64_t word(std::uint64_t index) const {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 64; ++i) {
      bits |= std::uint64_t{squared_[64 * index + i] != 0} << i;
    }
    return bits;
  }

  std::uint64_t allocated_bytes() const {
    return squared_.allocated_bytes() + poses_.allocated_bytes();
  }

 private:
  /// Values are stored as differences from the one that means none, so that zeros mean none.
  static constexpr std::uint64_t kNone = std::bit_cast<std::uint64_t>(Clearance{}.squared);

  ZeroedArray<std::uint64_t> squared_;
  ZeroedArray<std::uint32_t> poses_;
};

/// The answer of an engine for every entry of a small cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< no entries unless asked for
  ProfileSet profile = {};  ///< no poses unless asked for
};

/// A result without points, with room for what the query asks for.
SearchResult empty_result(const PackedCloud& cloud, const Query& query);

/// Adds the answer of a page of these cells.
void add_page(const PackedCloud& cloud, std::span<const PlannedCell> cells, const PageResult& page,
              SearchResult& all);

/// The colliding points and clearances of rows.
SearchResult result_of(const AnswerRows& rows, const PackedCloud& cloud, ProfileSet profile);

/// Runs pages through engines and returns the answer.
SearchResult run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                       const Query& query, int threads, Progress& progress, StageTimes& times);

}  // namespace clearway
