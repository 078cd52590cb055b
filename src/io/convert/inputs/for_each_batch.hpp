#pragma once

#include <tbb/parallel_pipeline.h>

#include <exception>
#include <memory>
#include <utility>

#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/inputs/file_hashes.hpp"
#include "io/convert/stage_clocks.hpp"

namespace clearway {

/// One reading of the environment, from where it stands to its end.
struct EnvironmentPass {
  EnvironmentSource& environment;
  int threads;
  FileHashes* files;  ///< hashes the files that are read in pieces; null: not
  StageClocks& clocks;
  const Progress& progress;
};

/// What becomes of a batch, stage by stage. The first error in the order of the points is thrown
/// where its turn comes, whichever thread was first to meet one.
template <typename Made>
struct PassingBatch {
  RecordBatch records;
  QuantaBatch quanta;
  Made made{};
  std::exception_ptr error;
};

/// Reads batches and calls `work` with each, several threads at a time; then `in_order` with each
/// and what was made of it, one by one in the order of the points; then `last` with what was made,
/// several threads at a time. Throws Interrupted when the progress asks to stop.
template <typename Made, typename Work, typename InOrder, typename Last>
void for_each_batch(const EnvironmentPass& pass, Work work, InOrder in_order, Last last) {
  using Passing = PassingBatch<Made>;
  using Batch = std::shared_ptr<Passing>;
  const ParallelScope scope;
  const SerialStage input, bytes, order;
  bool ended = false;
  const auto next = piece_of(scope, input, [&](tbb::flow_control& flow) {
    auto batch = std::make_shared<Passing>();
    try {
      throw_if_stopped(pass.progress);
      const auto running = pass.clocks.measure(Stage::kRead);
      ended = ended || !pass.environment.next(batch->records);
    } catch (...) {
      batch->error = std::current_exception();
    }
    if (ended) flow.stop();
    ended = ended || batch->error;
    return batch;
  });
  const auto worked = piece_of(scope, [&](const Batch& batch) {
    try {
      if (!batch->error) {
        {
          const auto running = pass.clocks.measure(Stage::kRead);
          pass.environment.convert(batch->records, batch->quanta, pass.files != nullptr);
        }
        batch->made = work(batch->quanta);
      }
    } catch (...) {
      batch->error = std::current_exception();
    }
    return batch;
  });
  const auto hashed = piece_of(scope, bytes, [&](const Batch& batch) {
    if (pass.files == nullptr || batch->error) return batch;
    const auto running = pass.clocks.measure(Stage::kHash);
    pass.files->add(batch->quanta.file, std::exchange(batch->quanta.bytes, {}));
    return batch;
  });
  const auto ordered = piece_of(scope, order, [&](const Batch& batch) {
    if (batch->error) std::rethrow_exception(batch->error);
    const auto running = pass.clocks.measure(Stage::kHash);
    pass.environment.note(batch->quanta);
    in_order(std::as_const(batch->quanta), batch->made);
    return batch;
  });
  const auto ended_batch = piece_of(scope, [&](const Batch& batch) { last(batch->made); });
  constexpr auto serial = tbb::filter_mode::serial_in_order;
  constexpr auto parallel = tbb::filter_mode::parallel;
  using Step = Handed<Batch>;
  scope.begin();
  tbb::parallel_pipeline(2 * static_cast<std::size_t>(pass.threads),
                         tbb::make_filter<void, Step>(serial, next) &
                             tbb::make_filter<Step, Step>(parallel, worked) &
                             tbb::make_filter<Step, Step>(serial, hashed) &
                             tbb::make_filter<Step, Step>(serial, ordered) &
                             tbb::make_filter<Step, void>(parallel, ended_batch));
}

}  // namespace clearway
