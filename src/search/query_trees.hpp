#pragma once

#include <cstdint>

#include "clearway/query.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/trajectory/motion_tree.hpp"
#include "core/util/stopwatch.hpp"

namespace clearway {

/// The trees over model and poses that every plan of a query starts from.
struct QueryTrees {
  /// The query outlives it; clock: started now.
  explicit QueryTrees(const Query& query, int threads = 1, const Stopwatch& clock = {})
      : model(query.model, threads),
        model_seconds(clock.seconds()),
        motion(query.poses, model.box(), query.between_poses, threads),
        motion_seconds(clock.seconds() - model_seconds) {}

  std::uint64_t allocated_bytes() const {
    return model.allocated_bytes() + motion.allocated_bytes();
  }

  ModelTree model;
  double model_seconds;  ///< wall clock
  MotionTree motion;
  double motion_seconds;
};

}  // namespace clearway
