#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/query/search_result.hpp"
#include "stream/answer_rows.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// The colliding points of a PackedCloud by entry, and their first poses if asked for. Different
/// entries may be marked at the same time.
class HitSet {
 public:
  HitSet(std::uint64_t entries, bool first_pose)
      : hits_(entries), poses_(first_pose ? entries : 0, kNoPose) {}

  void mark(std::uint64_t entry) { hits_[entry] = 1; }
  void mark(std::uint64_t entry, std::uint32_t pose) { poses_[entry] = pose; }

  bool contains(std::uint64_t entry) const { return hits_[entry] != 0; }
  std::uint32_t first_pose(std::uint64_t entry) const { return poses_[entry]; }
  std::uint64_t count() const {
    return static_cast<std::uint64_t>(std::ranges::count(hits_, std::uint8_t{1}));
  }

 private:
  std::vector<std::uint8_t> hits_;
  std::vector<std::uint32_t> poses_;
};

/// The answer of an engine for every entry of a small cloud.
struct SearchResult {
  HitSet hits;
  /// None where a clearance is not below the distance asked for; empty unless asked for
  std::vector<Clearance> clearances;
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
