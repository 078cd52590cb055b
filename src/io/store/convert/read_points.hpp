#pragma once

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/input_files.hpp"
#include "io/store/convert/stage_clocks.hpp"

namespace clearway {

inline constexpr double kLeastQuantum = std::numeric_limits<std::int32_t>::min();
inline constexpr double kGreatestQuantum = std::numeric_limits<std::int32_t>::max();

/// The whole number of steps on an axis that is nearest to a coordinate.
inline double quantum_of(const Quantisation& quantisation, int axis, double at) {
  return std::nearbyint((at - quantisation.offset[axis]) / quantisation.scale[axis]);
}

/// The 32-bit integer that is nearest to a whole number.
inline std::int32_t nearest_int32(double whole) {
  return static_cast<std::int32_t>(std::clamp(whole, kLeastQuantum, kGreatestQuantum));
}

inline bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The position of point i of a batch from a reader with this info.
inline Vec3 point_of(const PointBatch& batch, const CloudInfo& info, std::size_t i) {
  if (!info.quantisation) return batch.positions[i];
  const auto& q = batch.quanta[i];
  return position(*info.quantisation, q[0], q[1], q[2]);
}

/// A batch in the pipeline. The first error in the order of the points is thrown when its batch's
/// turn comes, whichever thread met one first.
struct PassingBatch {
  RecordBatch records;
  QuantaBatch quanta;
  std::exception_ptr error;
};

/// One reading of the environment, from its current position to its end.
struct EnvironmentPass {
  EnvironmentSource& environment;
  int threads;
  FileHashes* files;  ///< hashes the files that are read in pieces, or is null
  StageClocks& clocks;
  const Progress& progress;
  bool failed = false;

  /// Takes the next batch, in order; returns false at the end.
  bool next(PassingBatch& batch);
  /// Reads a batch and calls `work` with it. Several threads may call it at once.
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
  void read(PassingBatch& batch) const;
  /// Hashes the bytes of the batch's piece. Called for the batches in order.
  void hash_file(PassingBatch& batch) const;
  /// Counts the batch, or throws its error. Called for the batches in order, after hash_file().
  void note(const PassingBatch& batch) const;
};

/// Reads batches and calls `work` with each, several threads at a time; then `in_order` with each
/// batch and the result of `work`, one by one in the order of the points; then `last` with the
/// result, several threads at a time. Throws Interrupted when the progress asks to stop.
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
    const auto running = pass.clocks.measure(Stage::kHash);
    in_order(batch->quanta, batch->made);
    return batch;
  });
  const auto ended = piece_of(scope, [&](const Batch& batch) { last(batch->made); });
  constexpr auto serial = tbb::filter_mode::serial_in_order;
  constexpr auto parallel = tbb::filter_mode::parallel;
  using Step = Handed<Batch>;
  scope.begin();
  tbb::parallel_pipeline(static_cast<std::size_t>(pass.threads),
                         tbb::make_filter<void, Step>(serial, next) &
                             tbb::make_filter<Step, Step>(parallel, converted) &
                             tbb::make_filter<Step, Step>(serial, hashed) &
                             tbb::make_filter<Step, Step>(serial, noted) &
                             tbb::make_filter<Step, void>(parallel, ended));
}

}  // namespace clearway
