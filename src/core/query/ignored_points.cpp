#include "core/query/ignored_points.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/cloud/packed_cloud.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

using ClassTable = std::array<std::uint8_t, 256>;

/// The least integer of [-2^31, 2^31] at which `holds` is true; 2^31 if there is none. `holds` must
/// be true for all integers above the first for which it is.
template <typename Holds>
std::int64_t first_where(const Holds& holds) {
  std::int64_t lo = std::numeric_limits<std::int32_t>::min();
  std::int64_t hi = std::int64_t{std::numeric_limits<std::int32_t>::max()} + 1;
  while (lo < hi) {
    const std::int64_t middle = lo + (hi - lo) / 2;
    if (holds(static_cast<std::int32_t>(middle))) {
      hi = middle;
    } else {
      lo = middle + 1;
    }
  }
  return lo;
}

/// The ignored ones of 64 values of kBits bits each: bit i is set if value i is ignored. table: 1
/// for each ignored value. Reads 8 bytes at a time, so up to 8 - kBits bytes beyond the values.
template <unsigned kBits>
std::uint64_t ignored_of_block(const std::byte* from, const ClassTable& table) {
  std::uint64_t ignored = 0;
  for (unsigned eight = 0; eight < kBlockPoints / 8; ++eight, from += kBits) {
    std::uint64_t word;
    std::memcpy(&word, from, sizeof word);
    const std::uint64_t values = __builtin_bswap64(word) >> (64 - 8 * kBits);
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const auto value =
          static_cast<std::uint8_t>(values >> (kBits * (7 - i)) & ((1U << kBits) - 1));
      bits |= std::uint64_t{table[value]} << i;
    }
    ignored |= bits << (8 * eight);
  }
  return ignored;
}

using OfBlock = std::uint64_t (*)(const std::byte*, const ClassTable&);
constexpr OfBlock kOfBlock[] = {nullptr,
                                ignored_of_block<1>,
                                ignored_of_block<2>,
                                ignored_of_block<3>,
                                ignored_of_block<4>,
                                ignored_of_block<5>,
                                ignored_of_block<6>,
                                ignored_of_block<7>,
                                ignored_of_block<8>};

}  // namespace

std::optional<QuantumBox> quanta_in(const Quantisation& quantisation, const Box& box) {
  QuantumBox out{};
  for (int k = 0; k < 3; ++k) {
    const std::int64_t lo =
        first_where([&](std::int32_t q) { return coordinate(quantisation, k, q) >= box.lo[k]; });
    const std::int64_t end =
        first_where([&](std::int32_t q) { return coordinate(quantisation, k, q) > box.hi[k]; });
    if (lo >= end) return std::nullopt;
    out.lo[k] = static_cast<std::int32_t>(lo);
    out.hi[k] = static_cast<std::int32_t>(end - 1);
  }
  return out;
}

void sort_ignored(QueryParameters& query) {
  for (Box& box : query.ignore_boxes) {
    for (int k = 0; k < 3; ++k) {  // turns -0 into 0
      box.lo[k] += 0.0;
      box.hi[k] += 0.0;
    }
  }
  const auto is_before = [](const Box& a, const Box& b) {
    const auto numbers = [](const Box& box) {
      return std::array{box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
    };
    return numbers(a) < numbers(b);
  };
  std::sort(query.ignore_classes.begin(), query.ignore_classes.end());
  std::sort(query.ignore_boxes.begin(), query.ignore_boxes.end(), is_before);
  const auto keep_one = [](auto& values) {
    values.erase(std::unique(values.begin(), values.end()), values.end());
  };
  keep_one(query.ignore_classes);
  keep_one(query.ignore_boxes);
}

IgnoredPoints::IgnoredPoints(const PackedCloud& cloud, const QueryParameters& query, Search search)
    : cloud_(cloud),
      search_(search),
      any_(query.ignores_points()),
      by_class_(!query.ignore_classes.empty()) {
  for (const std::uint8_t value : query.ignore_classes) is_ignored_[value] = 1;
  for (const Box& box : query.ignore_boxes) {
    if (const auto quanta = quanta_in(cloud.quantisation(), box)) boxes_.push_back(*quanta);
  }
}

IgnoredPoints::Place IgnoredPoints::place_of(const QuantumBox& ignored, const QuantumBox& points) {
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    if (points.hi[k] < ignored.lo[k] || points.lo[k] > ignored.hi[k]) return Place::kOutside;
    inside = inside && points.lo[k] >= ignored.lo[k] && points.hi[k] <= ignored.hi[k];
  }
  return inside ? Place::kInside : Place::kCut;
}

bool IgnoredPoints::touches(std::uint32_t cell) const {
  const QuantumBox& points = cloud_.cells()[cell].box;
  return by_class_ || std::any_of(boxes_.begin(), boxes_.end(), [&](const QuantumBox& box) {
           return place_of(box, points) != Place::kOutside;
         });
}

bool IgnoredPoints::holds(std::uint32_t cell) const {
  const QuantumBox& points = cloud_.cells()[cell].box;
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const QuantumBox& box) {
    return place_of(box, points) == Place::kInside;
  });
}

void IgnoredPoints::set_all(std::uint32_t cell, std::span<std::uint64_t> searched) const {
  const std::uint32_t count = cloud_.cells()[cell].count, whole = count / kBlockPoints;
  std::fill(searched.begin(), searched.end(), 0);
  std::fill_n(searched.begin(), whole, ~std::uint64_t{0});
  if (count % kBlockPoints != 0) {
    searched[whole] = ~std::uint64_t{0} >> (kBlockPoints - count % kBlockPoints);
  }
}

void IgnoredPoints::invert(std::uint32_t cell, std::span<std::uint64_t> searched) const {
  std::vector<std::uint64_t> all(searched.size());
  set_all(cell, all);
  for (std::size_t block = 0; block < searched.size(); ++block) {
    searched[block] = all[block] & ~searched[block];
  }
}

void IgnoredPoints::leave_out_classes(std::uint32_t cell, std::span<std::uint64_t> searched) const {
  if (!cloud_.has_classes()) {
    if (is_ignored_[0] != 0) std::fill(searched.begin(), searched.end(), 0);
    return;
  }
  const PackedChunk<std::uint8_t> classes = cloud_.classes(cell);
  const unsigned minbits = classes.minbits();
  if (minbits == 0) {
    if (is_ignored_[classes.minimum()] != 0) std::fill(searched.begin(), searched.end(), 0);
    return;
  }
  const std::uint8_t minimum = minbits == 8 ? std::uint8_t{0} : classes.minimum();
  ClassTable table{};  // indexed by the values that the chunk stores
  for (unsigned i = 0; i < 1U << minbits; ++i) {
    table[i] = is_ignored_[static_cast<std::uint8_t>(minimum + i)];
  }
  const std::uint64_t bytes =
      clearway::packed_bytes<std::uint8_t>(classes.size(), minbits) - kPackedHeaderBytes;
  for (std::uint32_t block = 0; block < searched.size(); ++block) {
    if (searched[block] == 0) break;  // after the last point
    const std::uint64_t at = std::uint64_t{block} * 8 * minbits;
    if (at + 8 * minbits + 8 <= bytes) {
      searched[block] &= ~kOfBlock[minbits](classes.payload() + at, table);
      continue;
    }
    const std::uint32_t first = block * kBlockPoints;
    for (std::uint64_t left = searched[block]; left != 0; left &= left - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
      if (is_ignored_[classes[first + i]] != 0) searched[block] &= ~(std::uint64_t{1} << i);
    }
  }
}

void IgnoredPoints::leave_out_box(std::uint32_t cell, const QuantumBox& box,
                                  const std::array<PackedChunk<std::int32_t>, 3>& coordinates,
                                  std::span<std::uint64_t> searched) const {
  const QuantumBox& all = cloud_.cells()[cell].box;
  const BlockBoxes blocks = cloud_.blocks(cell);
  for (std::uint32_t block = 0; block < searched.size(); ++block) {
    if (searched[block] == 0) continue;
    const Place place = place_of(box, decode_block_box(all, blocks[block]));
    if (place == Place::kOutside) continue;
    if (place == Place::kInside) {
      searched[block] = 0;
      continue;
    }
    const std::uint32_t first = block * kBlockPoints;
    for (std::uint64_t left = searched[block]; left != 0; left &= left - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        const std::int32_t q = coordinates[static_cast<std::size_t>(k)][first + i];
        inside = q >= box.lo[k] && q <= box.hi[k];
      }
      if (inside) searched[block] &= ~(std::uint64_t{1} << i);
    }
  }
}

std::string ignored_text(const QueryParameters& query) {
  std::string text;
  if (!query.ignore_classes.empty()) {
    text = query.ignore_classes.size() == 1 ? "class " : "classes ";
    bool first = true;
    for (const std::string& range : number_ranges(query.ignore_classes)) {
      text += (first ? "" : ", ") + range;
      first = false;
    }
  }
  if (!query.ignore_boxes.empty()) {
    text += (text.empty() ? "" : " and ") + counted(query.ignore_boxes.size(), "box", "boxes");
  }
  return text.empty() ? "nothing" : text;
}

std::string ignored_text(const QueryParameters& query, const IgnoredPointCounts& counts) {
  return counted(counts.points, "point") + " ignored (" + ignored_text(query) + ")";
}

std::string box_text(const Box& box) {
  const auto corner_text = [](const Vec3& corner) {
    return format_number(corner.x) + " " + format_number(corner.y) + " " + format_number(corner.z);
  };
  return corner_text(box.lo) + " to " + corner_text(box.hi);
}

std::string boxes_text(const std::vector<Box>& boxes) {
  std::string text;
  for (const Box& box : boxes) text += (text.empty() ? "" : "; ") + box_text(box);
  return text.empty() ? "none" : text;
}

}  // namespace clearway
