#pragma once

#include "core/cloud/kd_order.hpp"
#include "core/page/page_engine.hpp"
#include "core/util/array_run.hpp"

namespace clearway {

/// What a query asks for beside the colliding points.
struct ResultParts {
  bool first_pose, clearance;
  bool profile = false;           ///< as a device lists it
  std::uint64_t facts_ahead = 0;  ///< of it that there is room for beside one a block
};

/// The arrays of a PageResult of so many blocks in a run of bytes; those not asked for are empty.
struct PageResultArrays {
  PageResultArrays(ArrayRun& run, std::uint64_t blocks, const ResultParts& parts)
      : hits(run.add<std::uint64_t>(blocks)),
        clearances(run.add<Clearance>(parts.clearance ? blocks * kBlockPoints : 0)),
        first_poses(run.add<std::uint32_t>(parts.first_pose ? blocks * kBlockPoints : 0)),
        facts(run.add<ProfileFact>(parts.profile ? blocks + parts.facts_ahead : 0)),
        fact_counts(run.add<ProfileCounts>(parts.profile ? 1 : 0)) {}

  /// What was found in the first `blocks` of them, in the run at `begin`.
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
