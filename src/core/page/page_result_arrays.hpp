#pragma once

#include "core/cloud/kd_order.hpp"
#include "core/page/page_engine.hpp"
#include "core/util/array_run.hpp"

namespace clearway {

/// The parts of a page's result beside the colliding points.
struct ResultParts {
  bool first_pose, clearance;
  bool profile = false;           ///< whether there are facts of a profile, as a device lists them
  std::uint64_t facts_ahead = 0;  ///< room for facts of a profile beyond one for each block
};

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

}  // namespace clearway
