#pragma once

#include <cstdint>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/sweep/model_field.hpp"
#include "core/sweep/model_tree.hpp"
#include "core/sweep/motion_tree.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "core/util/stopwatch.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// The trees over model and poses that every plan of a query starts from.
struct QueryTrees {
  explicit QueryTrees(const Query& query, const Stopwatch& clock = {})
      : model(query.model),
        model_seconds(clock.seconds()),
        motion(query.poses, model.box(), query.between_poses),
        motion_seconds(clock.seconds() - model_seconds) {}

  std::uint64_t allocated_bytes() const {
    return model.allocated_bytes() + motion.allocated_bytes();
  }

  ModelTree model;
  double model_seconds;  ///< wall clock
  MotionTree motion;
  double motion_seconds;
};

/// What engines that work on pages need to know before cells are read: the model field, the filter
/// over it and the planned cells. It stays where it is, for its parts know each other.
struct SearchPlan {
  /// All arguments but the last outlive it; clock: started now.
  SearchPlan(const StoreReader& store, const Query& query, const QueryTrees& trees,
             const ModelFieldOptions& field_options, int threads, const Stopwatch& clock = {});
  SearchPlan(const SearchPlan&) = delete;
  SearchPlan& operator=(const SearchPlan&) = delete;

  std::uint64_t allocated_bytes() const;
  /// The smallest page that holds any planned cell, bytes.
  std::uint64_t least_page_bytes() const;
  /// Of the motion nodes of any planned cell.
  std::uint64_t most_poses() const;

  const StoreReader& store;
  ModelField field;
  double field_seconds;
  SweepFilter filter;
  std::vector<PlannedCell> cells;
  double plan_seconds;
};

}  // namespace clearway
