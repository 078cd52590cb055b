#pragma once

#include <cstdint>
#include <vector>

#include "core/model_field.hpp"
#include "core/model_tree.hpp"
#include "core/motion_tree.hpp"
#include "core/page_engine.hpp"
#include "core/stopwatch.hpp"
#include "core/sweep_filter.hpp"
#include "io/store.hpp"

namespace clearway::tool {

/// The trees over model and poses that every plan of a question starts from.
struct QuestionTrees {
  explicit QuestionTrees(const Question& question, const Stopwatch& clock = {})
      : model(question.model),
        model_seconds(clock.seconds()),
        motion(question.poses, model.box(), question.between_poses),
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
  SearchPlan(const Store& store, const Question& question, const QuestionTrees& trees,
             const ModelFieldOptions& field_options, int threads, const Stopwatch& clock = {});
  SearchPlan(const SearchPlan&) = delete;
  SearchPlan& operator=(const SearchPlan&) = delete;

  std::uint64_t allocated_bytes() const;
  /// The smallest page that holds any planned cell, bytes.
  std::uint64_t least_page_bytes() const;
  /// Of the motion nodes of any planned cell.
  std::uint64_t most_poses() const;

  const Store& store;
  ModelField field;
  double field_seconds;
  SweepFilter filter;
  std::vector<PlannedCell> cells;
  double plan_seconds;
};

}  // namespace clearway::tool
