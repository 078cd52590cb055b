#include "clearway/kdtree_run.hpp"

#include <algorithm>

#include "clearway/memory_budget.hpp"
#include "core/stopwatch.hpp"
#include "cpu/kdtree_engine.hpp"
#include "stream/write_answer.hpp"

namespace clearway::tool {

Answer run_kdtree_engine(const Store& store, const Question& question, const EngineOptions& options,
                         AnswerJournal& journal, Progress& progress, EngineReport& report) {
  const std::uint64_t kept = program_bytes(options.threads) + input_bytes(store, question) +
                             AnswerJournal::most_bytes(store, question, options.threads);
  report.needed_bytes = kept + std::max(kdtree_memory_bytes(store, question, options.threads),
                                        answer_bytes(store, question) + least_write_bytes());
  check_memory(report.needed_bytes, options.memory_bytes);
  report.write_bytes = options.memory_bytes - kept - answer_bytes(store, question);
  const Stopwatch compute;
  HitSet hits =
      run_kdtree(store, question, {.threads = options.threads, .journal = &journal}, progress);
  report.stages.compute = report.stages.total = compute.seconds();
  return {std::move(hits), ClearanceSet()};
}

}  // namespace clearway::tool
