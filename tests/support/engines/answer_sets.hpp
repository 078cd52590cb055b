#pragma once

#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/query/search_result.hpp"
#include "stream/answer_rows.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// The colliding points of a PackedCloud by entry, and their first poses if asked for. Entries of
/// different blocks may be marked at the same time.
class HitSet {
 public:
  HitSet(std::uint64_t entries, bool first_pose)
      : words_((entries + 63) / 64), poses_(first_pose ? entries : 0, kNoPose) {}

  void mark(std::uint64_t entry) { mark_word(entry / 64, std::uint64_t{1} << (entry % 64)); }
  void mark(std::uint64_t entry, std::uint32_t pose) {
    mark(entry);
    poses_[entry] = pose;
  }
  /// Marks the entries 64 * word + i of all set bits i.
  void mark_word(std::uint64_t word, std::uint64_t bits) { words_[word] |= bits; }

  bool contains(std::uint64_t entry) const { return (words_[entry / 64] >> (entry % 64) & 1) != 0; }
  std::uint64_t word(std::uint64_t index) const { return words_[index]; }
  std::uint32_t first_pose(std::uint64_t entry) const { return poses_[entry]; }
  std::uint64_t count() const {
    return std::accumulate(words_.begin(), words_.end(), std::uint64_t{0},
                           [](std::uint64_t sum, std::uint64_t word) {
                             return sum + static_cast<std::uint64_t>(std::popcount(word));
                           });
  }

 private:
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> poses_;
};

/// Clearances of a PackedCloud by entry; none if it is not below the distance asked for. Different
/// entries may be set at the same time.
class ClearanceSet {
 public:
  ClearanceSet() = default;
  explicit ClearanceSet(std::uint64_t entries) : clearances_(entries) {}

  void set(std::uint64_t entry, const Clearance& clearance) { clearances_[entry] = clearance; }
  Clearance at(std::uint64_t entry) const { return clearances_[entry]; }

 private:
  std::vector<Clearance> clearances_;
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
