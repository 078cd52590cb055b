#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/quantisation.hpp"

namespace clearway {

/// The integers whose positions lie in a closed box; none if there are no such integers. Exact,
/// because a position is monotone in its integers.
std::optional<QuantumBox> quanta_in(const Quantisation& quantisation, const Box& box);

/// Puts the lists of what is ignored in ascending order, without duplicates, so that equal
/// questions have equal lists.
void sort_ignored(QueryParameters& query);

/// Knows which points of a cloud a query leaves out of the search (docs/design/pipeline.md).
class IgnoredPoints {
 public:
  /// The points to be searched: all but the ignored ones, or only the ignored ones. kBoth: masks
  /// are those of the others, but also cells that have none of these are visited.
  enum class Search { kOthers, kIgnored, kBoth };

  /// cloud: must outlive this object; without classes, all its points have class 0.
  IgnoredPoints(const PackedCloud& cloud, const QueryParameters& query,
                Search search = Search::kOthers);

  /// Whether the query leaves anything out.
  bool any() const { return any_; }

  /// Whether none of the cell's points is to be searched, as far as boxes alone can show.
  bool skips(std::uint32_t cell) const {
    return search_ == Search::kOthers ? holds(cell) : search_ == Search::kIgnored && !touches(cell);
  }

  /// Whether a point of the cell may be ignored.
  bool touches(std::uint32_t cell) const;

  /// Whether a box holds the whole cell, so that none of its points is searched.
  bool holds(std::uint32_t cell) const;

  /// Fills the masks of a cell and returns how many of its points are not to be searched. searched:
  /// one word for each block of the cell, in which bit i is set if point i is to be searched.
  /// coordinates(): returns the cell's packed x, y and z; called only if they are needed. Thread
  /// safe. Throws InputError if the cell is damaged.
  template <typename Coordinates>
  std::uint32_t mask(std::uint32_t cell, std::span<std::uint64_t> searched,
                     const Coordinates& coordinates) const {
    set_all(cell, searched);
    if (by_class_) leave_out_classes(cell, searched);
    for (const QuantumBox& box : boxes_) {
      switch (place_of(box, cloud_.cells()[cell].box)) {
        case Place::kOutside:
          break;
        case Place::kInside:
          std::fill(searched.begin(), searched.end(), 0);
          break;
        case Place::kCut:
          leave_out_box(cell, box, coordinates(), searched);
      }
    }
    if (search_ == Search::kIgnored) invert(cell, searched);
    return cloud_.cells()[cell].count - count(searched);
  }

  static std::uint32_t count(std::span<const std::uint64_t> words) {
    std::uint32_t points = 0;
    for (const std::uint64_t word : words)
      points += static_cast<std::uint32_t>(std::popcount(word));
    return points;
  }

 private:
  enum class Place { kOutside, kInside, kCut };

  static Place place_of(const QuantumBox& ignored, const QuantumBox& points);
  void set_all(std::uint32_t cell, std::span<std::uint64_t> searched) const;
  void invert(std::uint32_t cell, std::span<std::uint64_t> searched) const;
  void leave_out_classes(std::uint32_t cell, std::span<std::uint64_t> searched) const;
  void leave_out_box(std::uint32_t cell, const QuantumBox& box,
                     const std::array<PackedChunk<std::int32_t>, 3>& coordinates,
                     std::span<std::uint64_t> searched) const;

  const PackedCloud& cloud_;
  const Search search_;
  bool any_, by_class_;
  std::array<std::uint8_t, 256> is_ignored_{};  ///< 1 for an ignored class
  std::vector<QuantumBox> boxes_;
};

/// What a query leaves out, such as "classes 2, 7-9 and 1 box"; "nothing" if it leaves nothing out.
std::string ignored_text(const QueryParameters& query);

/// What a query leaves out with the number of points, such as "1,234 points ignored (class 2)".
std::string ignored_text(const QueryParameters& query, const IgnoredPointCounts& counts);

/// The two corners of a box, such as "1 2 3 to 4 5 6".
std::string box_text(const Box& box);

/// All boxes, separated by semicolons; "none" if there are none.
std::string boxes_text(const std::vector<Box>& boxes);

}  // namespace clearway
