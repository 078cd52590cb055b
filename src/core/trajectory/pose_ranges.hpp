#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <ranges>
#include <vector>

#include "clearway/progress.hpp"

namespace clearway {

/// The poses `i` to `i + beyond` of each index i, as stretches of the path that are ascending and
/// apart from each other. indices: ascending. beyond: 0 for poses, 1 for the steps that start
/// there. index_of: makes an index of an element of `indices`.
template <std::ranges::range Indices, typename Projection = std::identity>
std::vector<PoseRange> pose_ranges(const Indices& indices, std::uint32_t beyond = 0,
                                   const Projection& index_of = {}) {
  std::vector<PoseRange> out;
  for (const auto& element : indices) {
    const auto first = static_cast<std::uint32_t>(std::invoke(index_of, element));
    if (out.empty() || first > out.back().last + 1) out.push_back({first, first});
    out.back().last = std::max(out.back().last, first + beyond);
  }
  return out;
}

/// The stretches of the path that these stretches cover together, ascending and apart from each
/// other. ranges: in any order; they may overlap.
inline std::vector<PoseRange> united_ranges(std::vector<PoseRange> ranges) {
  std::ranges::sort(ranges, {}, &PoseRange::first);
  std::vector<PoseRange> out;
  for (const PoseRange& range : ranges) {
    const bool is_apart = out.empty() || range.first > out.back().last + std::uint64_t{1};
    if (is_apart) out.push_back(range);
    out.back().last = std::max(out.back().last, range.last);
  }
  return out;
}

/// The poses of some stretches that are in none of the others.
inline std::vector<PoseRange> without(const std::vector<PoseRange>& ranges,
                                      const std::vector<PoseRange>& others) {
  std::vector<PoseRange> out;
  const std::vector<PoseRange> ascending = united_ranges(others);
  for (PoseRange rest : ranges) {
    bool any = true;
    for (const PoseRange& other : ascending) {
      if (other.last < rest.first) continue;
      if (other.first > rest.last) break;
      if (other.first > rest.first) out.push_back({rest.first, other.first - 1});
      any = other.last < rest.last;
      if (!any) break;
      rest.first = other.last + 1;
    }
    if (any) out.push_back(rest);
  }
  return out;
}

}  // namespace clearway
