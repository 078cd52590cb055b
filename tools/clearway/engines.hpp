#pragma once

#include <cstdint>
#include <string>

#include "core/answer.hpp"
#include "core/progress.hpp"
#include "core/question.hpp"
#include "io/store.hpp"

namespace clearway::tool {

struct EngineOptions {
  std::string engine = "auto";  ///< "auto", "sweep" or "kdtree"
  int threads = 0;              ///< 0: all cores
  double field_voxel = 0;       ///< metres; 0: chosen
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
};

/// How an answer was computed.
struct EngineReport {
  std::string engine;
  std::uint64_t searches = 0;  ///< pairs of pose and model point
  double plan_seconds = 0, field_seconds = 0, compute_seconds = 0;  ///< wall clock
  std::uint64_t needed_bytes = 0;  ///< memory that inputs and engine take at the most
};

/// Answers the question with the engine chosen. Throws UsageError where that engine cannot,
/// ResourceError before anything starts where memory_bytes is too little, InputError for a damaged
/// cell.
Answer run_engine(const Store& store, const Question& question, const EngineOptions& options,
                  Progress& progress, EngineReport& report);

}  // namespace clearway::tool
