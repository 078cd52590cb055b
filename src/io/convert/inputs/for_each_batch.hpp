#pragma once

#include <tbb/parallel_pipeline.h>

#include <exception>
#include <memory>

#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/inputs/file_hashes.hpp"
#include "io/convert/stage_clocks.hpp"

namespace clearway {

/// A batch on its way. The first error in the order of the points is thrown where its turn comes,
/// whichever thread was first to meet one.
struct PassingBatch {
  RecordBatch records;
  QuantaBatch quanta;
  std::exception_ptr error;
};

/// One reading of the environment, from where it stands to its end.
class EnvironmentPass {
 public:
  /// files: hashes the files that are read in pieces; null: nobody does.
  EnvironmentPass(EnvironmentSource& environment, int threads, FileHashes* files,
                  StageClocks& clocks, const Progress& progress)
      : environment_(environment),
        threads_(threads),
        files_(files),
        clocks_(clocks),
        progress_(progress) {}

  StageClocks& clocks() const { return clocks_; }
  std::size_t batches_in_flight() const { return 2 * static_cast<std::size_t>(threads_); }

  /// In order: false at the end.
  bool next(PassingBatch& batch);
  /// Several threads at once: calls `work` with the batch once it is there.
  template <typename Work>
  void convert(PassingBatch& batch, Work work) const {
    try {
      if (batch.error) return;
      read(batch);
      work(batch.quanta);
    } catch (...) {
      batch.error = std::current_exception();
    }
  }
  /// In order.
  void hash_file(PassingBatch& batch) const;
  /// In order, later: throws the batch's error.
  void note(const PassingBatch& batch) const;

 private:
  void read(PassingBatch& batch) const;

  EnvironmentSource& environment_;
  int threads_;
  FileHashes* files_;
  StageClocks& clocks_;
  const Progress& progress_;
  bool failed_ = false;
};

/// Reads batches and calls `work` with each, several threads at a time; then `in_order` with each
/// and what was made of it, one by one in the order of the points; then `last` with what was made,
/// several threads at a time. Throws Interrupted when the progress asks to stop.
template <typename Made, typename Work, typename InOrder, typename Last>
void for_each_batch(EnvironmentPass pass, Work work, InOrder in_order, Last last) {
  struct Passing : PassingBatch {
    Made made{};
  };
  using Batch = std::shared_ptr<Passing>;
  const ParallelScope scope;
  const SerialStage input, bytes, order;
  const auto next = piece_of(scope, input, [&](tbb::flow_control& flow) {
    auto batch = std::make_shared<Passing>();
    if (!pass.next(*batch)) flow.stop();
    return batch;
  });
  const auto converted = piece_of(scope, [&](const Batch& batch) {
    pass.convert(*batch, [&](const QuantaBatch& quanta) { batch->made = work(quanta); });
    return batch;
  });
  const auto hashed = piece_of(scope, bytes, [&](const Batch& batch) {
    pass.hash_file(*batch);
    return batch;
  });
  const auto noted = piece_of(scope, order, [&](const Batch& batch) {
    pass.note(*batch);
    const auto running = pass.clocks().measure(Stage::kHash);
    in_order(batch->quanta, batch->made);
    return batch;
  });
  const auto ended = piece_of(scope, [&](const Batch& batch) { last(batch->made); });
  constexpr auto serial = tbb::filter_mode::serial_in_order;
  constexpr auto parallel = tbb::filter_mode::parallel;
  using Step = Handed<Batch>;
  scope.begin();
  tbb::parallel_pipeline(pass.batches_in_flight(),
                         tbb::make_filter<void, Step>(serial, next) &
                             tbb::make_filter<Step, Step>(parallel, converted) &
                             tbb::make_filter<Step, Step>(serial, hashed) &
                             tbb::make_filter<Step, Step>(serial, noted) &
                             tbb::make_filter<Step, void>(parallel, ended));
}

}  // namespace clearway
